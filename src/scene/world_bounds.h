// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/access.h"
#include "base/error_bounds.h"
#include "base/rounding.h"
#include "limber/geometry.h"
#include "limber/model.h"
#include "model/model_impl.h"

/// Where a placed model is at most, and how close two of them can be at least.
namespace limber::scene {

/// Tells the states of a committed model apart: every commit, rebuild or reset that changes its bounds changes this.
struct ModelState {
  std::uint64_t build_id = 0;
  double displacement = 0, slack = 0;
  friend bool operator==(const ModelState&, const ModelState&) = default;
};

/// Pre: the model has not been moved from.
inline ModelState state_of(const Model& model) {
  const bvh::Tree& tree = Access::impl(model).tree;
  return {tree.build_id, tree.displacement, tree.slack};
}

/// The bounds of a model in its own frame: a box and a sphere about one center.
struct LocalBounds {
  Vec3 center, half;
  double radius = 0;
  double magnitude = 0;  ///< at least the size of a coordinate and twice the radius together
};

/// Pre: the model is committed.
/// Cost     O(1), about a microsecond: unlike that of Model::bounding_sphere(), the sphere is nearly as small as the
///          center allows.
LocalBounds local_bounds(const Body& body);

/// The bounds of a placed model: it lies in the box and in the sphere. Both have room for the rounding of placed
/// vertices, and for that of distances as far as that depends on the models' sizes and places.
struct WorldBounds {
  Box box;
  Sphere sphere;
};

inline WorldBounds world_bounds(const LocalBounds& local, const Transform& pose) {
  const Mat3& r = pose.rotation;
  const Vec3 t = abs(pose.translation);
  const double error =
      base::scene_bounds_error * (t.x + t.y + t.z + local.magnitude) + std::numeric_limits<double>::min();
  const double radius = local.radius * (1 + base::rigidity_error) + error;
  const auto extent = [&](const Vec3& row) { return std::min(dot(abs(row), local.half) + error, radius); };
  const Vec3 center = pose(local.center), half{extent(r.row0), extent(r.row1), extent(r.row2)};
  return {{center - half, center + half}, {center, radius}};
}

/// A margin with room for the rounding of distances that is in proportion to them.
inline double margin_with_error(double margin) {
  return std::min(margin * (1 + base::scene_distance_error), std::numeric_limits<double>::max());
}

/// The distance of two intervals, 0 if they meet.
inline double gap(double low_a, double high_a, double low_b, double high_b) {
  return std::max({0.0, low_b - high_a, low_a - high_b});
}
inline Vec3 gaps(const Box& a, const Box& b) {
  return {gap(a.low.x, a.high.x, b.low.x, b.high.x), gap(a.low.y, a.high.y, b.low.y, b.high.y),
          gap(a.low.z, a.high.z, b.low.z, b.high.z)};
}

}  // namespace limber::scene
