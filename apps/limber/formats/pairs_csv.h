// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "limber/math.h"

namespace limber::program {

/// One row of a file of pairs.
struct PairRow {
  std::string model_a, model_b;  ///< as on the command line
  Transform pose_a, pose_b;      ///< world_from_model
  std::size_t line = 0;          ///< where it stands in the file, counted from 1
};

/// Reads a CSV file whose header names the columns, in any order: model_a and model_b, and for each model, where they
/// are wanted, pose_a_tx, pose_a_ty, pose_a_tz, pose_a_qw, pose_a_qx, pose_a_qy, pose_a_qz. Numbers that are left out
/// are those of the identity, but a quaternion is whole.
///
/// Errors   BadInput naming the file and, where there are some, line and column.
std::vector<PairRow> read_pairs(const std::string& path);

}  // namespace limber::program
