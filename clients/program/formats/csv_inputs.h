// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "limber/math.h"

/// Poses, points, pairs of models and parts as users write them. A pose is seven numbers tx,ty,tz,qw,qx,qy,qz: a
/// translation in the mesh's length unit and a quaternion, which is normalised.
///
/// Errors   BadInput of whatever reads a file, naming it and, where there are some, line and column.
namespace limber::program {

inline constexpr const char* pose_format = "tx,ty,tz,qw,qx,qy,qz";

/// Errors   One line without the place; the code says little.
Result<Transform> parsed_pose(std::string_view text);

/// The poses of a CSV file, one per row.
std::vector<Transform> read_poses(const std::string& path);

/// The points of a CSV file, one per row, whose columns are x, y and z. Numbers that are not finite or above
/// `max_coordinate` in size are refused.
std::vector<Vec3> read_points(const std::string& path);

/// One row of a file of pairs.
struct PairRow {
  std::string model_a, model_b;  ///< as on the command line
  Transform pose_a, pose_b;      ///< world_from_model
  std::size_t line = 0;          ///< where it stands in the file, counted from 1
};

/// The pairs of a CSV file with a header: model_a and model_b, and for each model, where they are wanted, pose_a_tx,
/// pose_a_ty, pose_a_tz, pose_a_qw, pose_a_qx, pose_a_qy, pose_a_qz. Numbers that are left out are those of the
/// identity, but a quaternion is whole.
std::vector<PairRow> read_pairs(const std::string& path);

/// One row of a file of parts.
struct PartRow {
  std::string name;      ///< empty where the file has none
  std::string model;     ///< as on the command line
  Transform pose;        ///< world_from_model
  std::size_t line = 0;  ///< where it stands in the file, counted from 1
};

/// The parts of a CSV file with a header: model, and where they are wanted name and pose_tx, pose_ty, pose_tz, pose_qw,
/// pose_qx, pose_qy, pose_qz, as in a file of pairs.
std::vector<PartRow> read_parts(const std::string& path);

}  // namespace limber::program
