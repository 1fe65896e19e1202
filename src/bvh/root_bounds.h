// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "base/error_bounds.h"
#include "bvh/tree.h"
#include "geometry/local_frame.h"

/// Bounds of a whole model, by the root slot of its tree.
namespace limber::bvh {

inline double sum_of_coordinates(const Vec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// Radius of a sphere around the model, about the center of its root slot.
inline double root_radius(const Tree& tree) {
  return tree.unit * static_cast<double>(tree.nodes[0].bounds.radius[0]) + tree.slack;
}

/// A lower bound of the distance of a point from a model, by the box or the slab of its root slot. The point is
/// relative to that slot's center, in the model's frame.
inline double root_gap(const Tree& tree, const Vec3& point) {
  const ChildBounds& n = tree.nodes[0].bounds;
  const Vec3 out = max(abs(point) - tree.unit * Vec3{n.half_x[0], n.half_y[0], n.half_z[0]}, Vec3{});
  const double height = dot(Vec3{n.normal_x[0], n.normal_y[0], n.normal_z[0]}, point);
  const double above = height - tree.unit * static_cast<double>(n.high[0]);
  const double below = tree.unit * static_cast<double>(n.low[0]) - height;
  return std::max({geometry::safe_length(out), above, below}) - tree.slack;
}

/// An upper bound of the distance of any point of the placed model from the world's origin.
inline double magnitude(const Tree& tree, const Transform& pose) {
  // A model that has moved far may be many radii away from the origin of its header node.
  const double from_origin = tree.unit * static_cast<double>(tree.nodes[0].radius) + tree.slack;
  return sum_of_coordinates(pose.translation) +
         (sum_of_coordinates(tree.nodes[0].origin) + std::max(2 * root_radius(tree), from_origin)) * base::magnitude_up;
}

}  // namespace limber::bvh
