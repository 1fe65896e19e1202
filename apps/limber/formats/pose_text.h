// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "limber/math.h"

/// Poses as seven numbers tx,ty,tz,qw,qx,qy,qz: a translation in the mesh's length unit and a quaternion, which is
/// normalised.
namespace limber::program {

inline constexpr const char* pose_format = "tx,ty,tz,qw,qx,qy,qz";
inline constexpr std::array<std::string_view, 7> pose_numbers = {"tx", "ty", "tz", "qw", "qx", "qy", "qz"};

/// Errors   One line without the place; the code says little.
Result<Transform> parsed_pose(std::string_view text);

/// The pose of seven numbers in the order of `pose_numbers`. Errors as transform_from_quaternion().
Result<Transform> pose_of(const std::array<double, 7>& numbers);

/// The poses of a CSV file, one per row. A first row of names alone is a header: it names the columns, in any order,
/// and others may stand between them. Without a header a row has the seven numbers alone.
///
/// Errors   BadInput naming the file and, where there are some, line and column.
std::vector<Transform> read_poses(const std::string& path);

}  // namespace limber::program
