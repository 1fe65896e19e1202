// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "limber/math.h"

/// Poses as seven numbers tx,ty,tz,qw,qx,qy,qz: a translation in the mesh's length unit and a quaternion, which is
/// normalised.
namespace limber::program {

inline constexpr const char* pose_format = "tx,ty,tz,qw,qx,qy,qz";

/// Errors   One line without the place; the code says little.
Result<Transform> parsed_pose(std::string_view text);

/// One pose per row. Blank lines and those that start with # are skipped, and a first row without any number is a
/// header.
///
/// Errors   BadInput naming the file and the line, counted from 1.
std::vector<Transform> read_poses(const std::string& path);

}  // namespace limber::program
