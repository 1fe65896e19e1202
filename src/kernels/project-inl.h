// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Brings nodes and leaves of one tree, and points, to the frame and unit in which a kernel compares them. In order:
// points, bounding volumes, the search direction, pairs of leaves.
//
// Float64 finds where a center lies relative to the local origin it is compared at. From there on float32 resolves
// everything that matters, however far the models are from the world's origin. All errors on the way are added to the
// bounds here, so that comparisons need not care. Plain loops over four numbers become one instruction each.

#if defined(LIMBER_SIMD_PROJECT_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_PROJECT_INL_H
#undef LIMBER_SIMD_PROJECT_INL_H
#else
#define LIMBER_SIMD_PROJECT_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/error_bounds.h"
#include "base/rounding.h"
#include "kernels/leaf_support-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// A node in the frame and unit of the node it is compared with, relative to that node's origin. It is enlarged by
/// rounding errors, and by how far vertices of both models may have moved since their trees were fitted (Tree::slack).
struct ProjectedNode {
  alignas(16) float center[4];
  alignas(16) float half[4];  // half extents of a box along the axes of that frame
  float own_half[3];          // half extents along the axes of the node's own frame
  alignas(16) float normal[4];
  float radius, low, high;
};

/// The search direction for the children of one node and a projected node. A child is pruned if its support along
/// `direction`, from the node's origin, is at most `pruned_support`: then the gap is at least the prune distance, all
/// errors included.
struct ProjectedDirection {
  const float* direction;
  float pruned_support;
  float prune_distance;  // in units
};

/// Two leaves in the frame of a, relative to the center of a, scaled so that all numbers are about 1 or less.
///
/// The support of a triangle is how far it extends from its leaf's center along the search direction, towards the other
/// leaf. A pair of triangles is pruned if the sum of both supports is at most `pruned_support`: then their gap is at
/// least the prune distance, all errors included. Other gaps do not include `error`, and are compared with
/// prune_distance + error.
struct ProjectedLeaves {
  float step_a, step_b;  // lengths of one quantization step
  float offset[4];       // from the center of a to that of b
  float error;           // upper bound of how much rounding and quantization can change a gap
  float prune_distance;
  float pruned_support;
  double scale;  // factor from lengths to scaled ones
};

/// The center of a slot in the frame that `transform` leads to, relative to `origin`, as lengths; then a 0.
LIMBER_KERNEL void project_center(const bvh::Node& node, std::uint32_t slot, const FrameTransform& transform,
                                  const Vec3& origin, double* projected) {
  const double x = node.origin.x + transform.other_unit * static_cast<double>(node.bounds.center_x[slot]);
  const double y = node.origin.y + transform.other_unit * static_cast<double>(node.bounds.center_y[slot]);
  const double z = node.origin.z + transform.other_unit * static_cast<double>(node.bounds.center_z[slot]);
  const auto& columns = transform.from_other;
  // Number by number: processors wait when a vector is read where single numbers have just been written.
  const auto along = [&](int j) { return columns[0][j] * x + columns[1][j] * y + columns[2][j] * z + columns[3][j]; };
  projected[0] = along(0) - origin.x, projected[1] = along(1) - origin.y, projected[2] = along(2) - origin.z;
  projected[3] = 0;
}

/// A query point relative to `origin` + `center`, times `scale`: in the units in which a kernel compares.
struct LocalPoint {
  alignas(16) float position[4];
  double size = 0;  // sum of the absolute coordinates before they are rounded to float32

  LIMBER_KERNEL LocalPoint(const double (&point)[4], const Vec3& origin, const Vec3& center, double scale) {
    const double from[4] = {origin.x, origin.y, origin.z, 0}, then_from[4] = {center.x, center.y, center.z, 0};
    for (int j = 0; j < 4; ++j) {
      const double units = ((point[j] - from[j]) - then_from[j]) * scale;
      size += std::abs(units);
      position[j] = static_cast<float>(units);
    }
  }
  /// What rounding errors are proportional to: the sum of the absolute coordinates and the radius of the node or leaf
  /// that the point is compared with.
  LIMBER_KERNEL float magnitude(float radius) const {
    return std::abs(position[0]) + std::abs(position[1]) + std::abs(position[2]) + radius;
  }
};

/// The matrix with these columns times (x, y, z).
LIMBER_KERNEL void multiply(const float (&columns)[3][4], float x, float y, float z, float* out) {
  for (int j = 0; j < 4; ++j) out[j] = columns[0][j] * x + columns[1][j] * y + columns[2][j] * z;
}

LIMBER_KERNEL double dot3(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The radius of the circle in which a sphere is cut by a plane at some height over its center; 0 if it is not cut.
LIMBER_KERNEL float rim_radius(float radius, float height) {
  return std::sqrt(std::max(0.0F, radius * radius - height * height));
}

/// Projects a slot, for comparison with the children of `node`. `center` is that of project_center(), with the origin
/// of `node`.
LIMBER_KERNEL ProjectedNode project_node(const bvh::Node& node, const SlotRef& other, const FrameTransform& transform,
                                         const double* center) {
  const bvh::ChildBounds& n = other.node->bounds;
  const std::uint32_t k = other.slot;
  double units[3];
  for (int j = 0; j < 3; ++j) units[j] = center[j] * transform.per_unit;
  const float radius = n.radius[k] * transform.ratio;
  // "Not less than" is true also where radius or error are infinite, or not a number: 0 times an infinite ratio.
  const double size = static_cast<double>(radius) + static_cast<double>(transform.error_units);
  if (!(std::abs(units[0]) + std::abs(units[1]) + std::abs(units[2]) + size < base::max_units)) {
    constexpr auto everywhere = static_cast<float>(4 * base::max_units);  // overlaps all that is smaller than max_units
    const float all = everywhere;
    return {{}, {all, all, all}, {all, all, all}, {1, 0, 0}, all, -all, all};
  }
  ProjectedNode p;
  for (int j = 0; j < 3; ++j) p.center[j] = static_cast<float>(units[j]);
  p.center[3] = 0;
  multiply(transform.rotation, n.normal_x[k], n.normal_y[k], n.normal_z[k], p.normal);
  multiply(transform.rotation_abs, n.half_x[k], n.half_y[k], n.half_z[k], p.half);
  const float magnitude = std::abs(p.center[0]) + std::abs(p.center[1]) + std::abs(p.center[2]);
  const float error = (magnitude + node.radius + radius) * base::projection_error + transform.error_units;
  for (float& half : p.half) half = std::min(half * transform.ratio, radius) + error;
  const auto own_half = [&](float half) { return std::min(half * transform.ratio, radius) + error; };
  p.own_half[0] = own_half(n.half_x[k]), p.own_half[1] = own_half(n.half_y[k]), p.own_half[2] = own_half(n.half_z[k]);
  p.radius = radius + error;
  p.low = n.low[k] * transform.ratio - error;
  p.high = n.high[k] * transform.ratio + error;
  return p;
}

/// Upper bound of the support of a slot along a direction of its own frame, from its center, in its own units: of the
/// quantized corners of a leaf; otherwise of the sphere cut by the slab, or of the box (docs/algorithms/bounds.md).
LIMBER_KERNEL float support(const SlotRef& other, const float* direction) {
  const bvh::ChildBounds& n = other.node->bounds;
  const std::uint32_t k = other.slot;
  const float radius = n.radius[k];
  if (other.triangles != nullptr) {
    const float step = radius * (1 / bvh::max_quantized);
    return leaf_support(*other.triangles, direction) * step + static_cast<float>(base::quantization_error) * step +
           radius * base::projection_error;
  }
  const float x = n.normal_x[k], y = n.normal_y[k], z = n.normal_z[k];
  const float cosine = direction[0] * x + direction[1] * y + direction[2] * z, cosine_abs = std::abs(cosine);
  const float height = cosine > 0 ? n.high[k] : -n.low[k];
  const float u = y * direction[2] - z * direction[1], v = z * direction[0] - x * direction[2],
              w = x * direction[1] - y * direction[0];
  const float sine = std::sqrt(u * u + v * v + w * w);
  const float sphere = radius * cosine_abs > height ? height * cosine_abs + rim_radius(radius, height) * sine : radius;
  const float box = std::abs(direction[0]) * n.half_x[k] + std::abs(direction[1]) * n.half_y[k] +
                    std::abs(direction[2]) * n.half_z[k];
  return std::min(sphere, box) + radius * base::projection_error;
}

/// The search direction for the children of `node` and a slot. `center` as for project_node(). Pre: there is one.
LIMBER_KERNEL ProjectedDirection project_direction(const bvh::Node& node, const SlotRef& other,
                                                   const FrameTransform& transform, const PruneLimits& pruning,
                                                   const double* center) {
  const double other_support = static_cast<double>(support(other, pruning.other_direction32)) * transform.other_unit;
  const double room = dot3(pruning.direction, center) - other_support - pruning.distance - transform.error;
  const double units = std::clamp(room * transform.per_unit, -base::max_units, base::max_units);
  return {pruning.direction32, base::float_down(units) - node.radius * base::projection_error,
          base::float_up(std::min(pruning.distance * transform.per_unit, base::max_units))};
}

/// The power of two by which a size becomes 1 or more, but below 2: with e the biased exponent of the size, the one
/// with the biased exponent 2046 - e, as 1 has 1023. Pre: 2^-1000 < size < 2^1000.
LIMBER_KERNEL double scale_to_one(double size) {
  return std::bit_cast<double>((std::uint64_t{2046} - (std::bit_cast<std::uint64_t>(size) >> 52)) << 52);
}

/// `is_self` says that both are leaves of one tree: then no transform is needed.
template <bool is_self>
LIMBER_KERNEL ProjectedLeaves project_leaves(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                             const PruneLimits& pruning) {
  constexpr double smallest_size = 0x1p-900, largest_size = 0x1p900;
  const bvh::ChildBounds &na = a.node->bounds, &nb = b.node->bounds;
  const Vec3 center_a =
      a.node->origin + transform.unit * Vec3{na.center_x[a.slot], na.center_y[a.slot], na.center_z[a.slot]};
  alignas(32) double offset[4];
  if (is_self) {
    const Vec3 center_b =
        b.node->origin + transform.unit * Vec3{nb.center_x[b.slot], nb.center_y[b.slot], nb.center_z[b.slot]};
    offset[0] = center_b.x - center_a.x, offset[1] = center_b.y - center_a.y, offset[2] = center_b.z - center_a.z;
    offset[3] = 0;
  } else {
    project_center(*b.node, b.slot, transform, center_a, offset);
  }
  const double radius_a = transform.unit * static_cast<double>(na.radius[a.slot]);
  const double radius_b = transform.other_unit * static_cast<double>(nb.radius[b.slot]);
  const double size =
      std::abs(offset[0]) + std::abs(offset[1]) + std::abs(offset[2]) + radius_a + radius_b + transform.error;
  ProjectedLeaves p;
  const double scale = scale_to_one(std::clamp(size, smallest_size, largest_size));
  p.scale = scale;
  const double steps_of_radius = scale * (1 / static_cast<double>(bvh::max_quantized));  // a division would take longer
  const double step_a = radius_a * steps_of_radius, step_b = radius_b * steps_of_radius;
  p.step_a = static_cast<float>(step_a), p.step_b = static_cast<float>(step_b);
  for (int j = 0; j < 4; ++j) p.offset[j] = static_cast<float>(offset[j] * scale);
  const double steps = base::quantization_error * (step_a + step_b);
  p.error = base::float_up(steps + transform.error * scale) + base::leaf_pair_error;
  p.prune_distance = base::float_up(std::min(pruning.distance * scale, base::max_units));
  p.pruned_support = 0;
  if (pruning.has_direction) {
    const double rounding = (radius_a + radius_b) * static_cast<double>(base::projection_error);
    const double room =
        (dot3(pruning.direction, offset) - pruning.distance - transform.error - rounding) * scale - steps;
    p.pruned_support = base::float_down(std::clamp(room, -base::max_units, base::max_units));
  }
  return p;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
