// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <vector>

#include "limber/math.h"

/// Poses as Python writes them: None; a 4 x 4 matrix; (rotation, translation) with a 3 x 3 matrix; (quaternion,
/// translation) with w, x, y, z.
namespace limber::python {

/// One pose.
///
/// Throws   nb::value_error if it has none of these forms, or for what the functions of limber/math.h refuse.
Transform pose_from(nanobind::handle object, const char* name);

/// Many poses: the same forms with another axis before the others, or one pose for all.
class PoseList {
 public:
  /// Throws   As pose_from(), naming the index.
  PoseList(nanobind::handle object, const char* name);

  bool is_one_for_all() const { return is_one_for_all_; }
  /// Pre: not is_one_for_all().
  std::size_t size() const { return poses_.size(); }
  const Transform& operator[](std::size_t i) const { return poses_[is_one_for_all_ ? 0 : i]; }
  const std::vector<Transform>& poses() const { return poses_; }

 private:
  std::vector<Transform> poses_;
  bool is_one_for_all_ = true;
};

}  // namespace limber::python
