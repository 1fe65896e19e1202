// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "limber/math.h"

/// Poses as seven numbers tx,ty,tz,qw,qx,qy,qz: a translation in the mesh's length unit and a quaternion, which is
/// normalised.
namespace limber::program {

inline constexpr const char* pose_format = "tx,ty,tz,qw,qx,qy,qz";

/// Limits of files of poses, in bytes.
inline constexpr std::uint64_t max_pose_file_bytes = std::uint64_t{1} << 28U;
inline constexpr std::size_t max_pose_line_bytes = 4096;

/// Errors   One line without the place; the code says little.
Result<Transform> parsed_pose(std::string_view text);

/// One pose per row. Blank lines and those that start with # are skipped, and a first row of names alone is a header.
///
/// Errors   One line that names the line, counted from 1, but not the file.
/// Cost     One line is in memory at a time, besides the poses.
Result<std::vector<Transform>> parsed_poses(std::istream& rows);

/// The same from a regular file.
///
/// Errors   BadInput naming the file and, where there is one, the line.
std::vector<Transform> read_poses(const std::string& path);

}  // namespace limber::program
