// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point/placed_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/access.h"
#include "base/error_bounds.h"
#include "base/rounding.h"
#include "bvh/tree.h"
#include "geometry/local_frame.h"
#include "geometry/rigid.h"
#include "geometry/winding.h"
#include "limber/distance.h"
#include "model/model_impl.h"

namespace limber::point {
namespace {

// From that many radii on, float32 tells triangles apart by their heights better than by their distances.
constexpr double far_radii = 1024;
// Its square is a normal number.
constexpr double smallest_far_distance = 0x1p-450;

void store(const Vec3& v, double (&to)[3]) {
  for (std::size_t k = 0; k < 3; ++k) to[k] = v[k];
}

}  // namespace

PlacedModel::PlacedModel(const Placed& placed)
    : PlacedModel(require_ready(placed, "limber", "the model of a query").tree, Access::impl(placed.model()).mesh,
                  placed.pose) {}

PlacedModel::PlacedModel(const bvh::Tree& tree, const MeshView& mesh, const Transform& pose)
    : tree_(&tree),
      mesh_(mesh),
      pose_(pose),
      to_frame_(geometry::inverse_of(pose.rotation)),
      magnitude_(bvh::magnitude(tree, pose)),
      center_(bvh::slot_center(tree, bvh::root_slot)),
      far_distance_(std::max(far_radii * bvh::root_radius(tree), smallest_far_distance)) {
  LIMBER_ASSERT(geometry::is_rigid(pose));
}

simd::QueryPoint PlacedModel::in_frame(const Vec3& point) const {
  simd::QueryPoint in;
  const Vec3 local = in_model(point);
  for (std::size_t k = 0; k < 3; ++k) in.position[k] = local[k];
  in.position[3] = 0;
  in.unit = tree_->unit, in.per_unit = 1 / tree_->unit;
  const double from_origin = std::abs(point.x) + std::abs(point.y) + std::abs(point.z);
  in.error = base::placement_error * (magnitude_ + from_origin) + tree_->slack;
  in.error_units = base::float_up(base::or_infinite(in.error * in.per_unit)) + base::smallest_error_units;
  const Vec3 up = point - pose_(center_);
  const double distance = geometry::safe_length(up);
  in.is_far = distance > far_distance_;
  if (in.is_far) {
    const Vec3 world_direction = up * (1 / distance), direction = transpose(pose_.rotation) * world_direction;
    store(direction, in.direction), store(center_, in.base);
    in.height = dot(world_direction, point - pose_.translation) - dot(direction, center_);
    for (std::size_t k = 0; k < 3; ++k) in.direction32[k] = static_cast<float>(direction[k]);
  }
  return in;
}

Vec3 PlacedModel::half_box() const {
  const bvh::ChildBounds& n = tree_->nodes[0].bounds;
  const Vec3 half = tree_->unit * Vec3{n.half_x[0], n.half_y[0], n.half_z[0]};
  const Mat3& r = pose_.rotation;
  return Vec3{dot(abs(r.row0), half), dot(abs(r.row1), half), dot(abs(r.row2), half)} * (1 + base::root_error);
}

AxisRay PlacedModel::ray(const Vec3& point, const simd::QueryPoint& in, std::size_t axis, bool is_upward) const {
  AxisRay ray{point, axis, is_upward, {}};
  const Vec3 rows[3] = {pose_.rotation.row0, pose_.rotation.row1, pose_.rotation.row2};
  simd::QueryRay& r = ray.in_frame;
  std::copy(in.position, in.position + 4, r.origin);
  r.unit = in.unit, r.per_unit = in.per_unit, r.error = in.error, r.error_units = in.error_units;
  const auto store_float = [](const Vec3& v, float(&to)[3]) {
    for (std::size_t k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
  };
  store_float(is_upward ? rows[axis] : -rows[axis], r.forward);
  store_float(rows[(axis + 1) % 3], r.left), store_float(rows[(axis + 2) % 3], r.up);
  return ray;
}

std::optional<AxisRay> PlacedModel::ray_from(const Vec3& point) const {
  const simd::QueryPoint in = in_frame(point);
  const Vec3 half = half_box(), to_center = pose_(center_) - point;
  std::size_t best_axis = 0;
  bool best_is_upward = true;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const double support = half[k] + in.error;
    if (std::abs(to_center[k]) > support) return std::nullopt;
    for (const bool is_upward : {true, false}) {
      const double left = support + (is_upward ? to_center[k] : -to_center[k]);
      if (left < least) least = left, best_axis = k, best_is_upward = is_upward;
    }
  }
  return ray(point, in, best_axis, best_is_upward);
}

std::optional<AxisRay> PlacedModel::ray_along(const Vec3& point, double off, std::size_t axis, bool is_upward) const {
  LIMBER_ASSERT(axis < 3 && off >= 0);
  simd::QueryPoint in = in_frame(point);
  in.error += off;
  in.error_units = base::float_up(base::or_infinite(in.error * in.per_unit)) + base::smallest_error_units;
  const Vec3 half = half_box(), to_center = pose_(center_) - point;
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(to_center[k]) > half[k] + in.error) return std::nullopt;
  }
  return ray(point, in, axis, is_upward);
}

Surrounding surrounding_of(const PlacedModel& model, const Vec3& point, QueryStats& stats) {
  Surrounding surrounding;
  ++stats.node_tests;
  const std::optional<AxisRay> ray = model.ray_from(point);
  if (!ray) return surrounding;
  const bool is_off = visit_crossed(model, *ray, stats, [&](const Triangle& triangle) {
    if (geometry::lies_on(point, triangle)) return false;
    surrounding.winding_number += geometry::winding_along(point, triangle, ray->axis, ray->is_upward);
    return true;
  });
  if (!is_off) return {.is_on = true};
  return surrounding;
}

}  // namespace limber::point
