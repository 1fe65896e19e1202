// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What kernels share that compare volumes and triangles: how far these extend, and the frame and unit of comparisons.

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
#include "layout/node.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// Corner `k` of the triangles in the slots `i` and following, in quantization steps.
LIMBER_KERNEL Packet3 corners(const bvh::QuantizedTriangles& t, int k, std::uint32_t i) {
  return {Packet::from_int16(t.corner[3 * k] + i), Packet::from_int16(t.corner[3 * k + 1] + i),
          Packet::from_int16(t.corner[3 * k + 2] + i)};
}

/// The farthest of the corners of each triangle in direction n, in quantization steps.
LIMBER_KERNEL Packet farthest_corners(const bvh::QuantizedTriangles& leaf, std::uint32_t i, const Packet3& n) {
  return max(max(dot(n, corners(leaf, 0, i)), dot(n, corners(leaf, 1, i))), dot(n, corners(leaf, 2, i)));
}

/// The support of all triangles of a leaf along `normal`, in quantization steps.
LIMBER_KERNEL float leaf_support(const bvh::QuantizedTriangles& leaf, const float* normal) {
  const Packet3 n = broadcast(normal);
  Packet farthest = farthest_corners(leaf, 0, n);
  for (std::uint32_t i = Packet::lanes; i < width; i += Packet::lanes) {
    farthest = max(farthest, farthest_corners(leaf, i, n));
  }
  return largest(farthest);
}

// Brings nodes and leaves of one tree, and points, to the frame and unit in which a kernel compares them. In order:
// points, bounding volumes, the search direction, pairs of leaves.
//
// Float64 finds where a center lies relative to the local origin it is compared at. From there on float32 resolves
// everything that matters, however far the models are from the world's origin. All errors on the way are added to the
// bounds here, so that comparisons need not care. Plain loops over four numbers become one instruction each.

/// A node in the frame and unit of the node it is compared with, relative to that node's origin. It is enlarged by
/// rounding errors, and by how far vertices of both models may have moved since their trees were fitted (Tree::slack).
struct ProjectedNode {
  alignas(16) float center[4];
  alignas(16) float half[4];  // half extents of a box along the axes of that frame
  float own_half[3];          // half extents along the axes of the node's own frame
  alignas(16) float normal[4];
  float radius, low, high;
  float error;  // by which it is enlarged
};

/// The search direction for the children of one node and a projected node. A child is pruned if its support along
/// `direction`, from the node's origin, is at most `pruned_support`: then the gap is at least the prune distance, all
/// errors included.
struct ProjectedDirection {
  const float* direction;
  float pruned_support;
  float prune_distance;  // in units
  float other_extent;    // Support::extent of the projected node, towards the children
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
    return {{}, {all, all, all}, {all, all, all}, {1, 0, 0}, all, -all, all, all};
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
  p.error = error;
  return p;
}

/// How far the content of a volume reaches along a direction.
struct Support {
  float upper;   // an upper bound: the support of the volume
  float extent;  // `upper`, less half of a lower bound: large where opening the node may gain much; need not be exact
};

/// The support of a slot along a direction of its own frame, from its center, in its own units: of the quantized
/// corners of a leaf; otherwise of the sphere cut by the slab, or of the box (docs/algorithms/bounds.md). Box and slab
/// touch their content. So it reaches at least as far as the lowest point of the volume on one of their faces does.
LIMBER_KERNEL Support support(const SlotRef& other, const float* direction) {
  const bvh::ChildBounds& n = other.node->bounds;
  const std::uint32_t k = other.slot;
  const float radius = n.radius[k];
  if (other.triangles != nullptr) {
    const float step = radius * (1 / bvh::max_quantized);
    return {leaf_support(*other.triangles, direction) * step + static_cast<float>(base::quantization_error) * step +
                radius * base::projection_error,
            0};
  }
  const float x = n.normal_x[k], y = n.normal_y[k], z = n.normal_z[k];
  const float cosine = direction[0] * x + direction[1] * y + direction[2] * z, cosine_abs = std::abs(cosine);
  const float height = cosine > 0 ? n.high[k] : -n.low[k];
  const float u = y * direction[2] - z * direction[1], v = z * direction[0] - x * direction[2],
              w = x * direction[1] - y * direction[0];
  const float sine = std::sqrt(u * u + v * v + w * w);
  const float at_height = height * cosine_abs, at_rim = rim_radius(radius, height) * sine;
  const float sphere = radius * cosine_abs > height ? at_height + at_rim : radius;
  const float along_x = std::abs(direction[0]) * n.half_x[k], along_y = std::abs(direction[1]) * n.half_y[k],
              along_z = std::abs(direction[2]) * n.half_z[k];
  const float box = along_x + along_y + along_z, upper = std::min(sphere, box);
  const float touched = std::max(at_height - at_rim, 2 * std::max({along_x, along_y, along_z}) - box);
  return {upper + radius * base::projection_error, upper - 0.5F * touched};
}

/// The search direction for the children of `node` and a slot. `center` as for project_node(). Pre: there is one.
LIMBER_KERNEL ProjectedDirection project_direction(const bvh::Node& node, const SlotRef& other,
                                                   const FrameTransform& transform, const PruneLimits& pruning,
                                                   const double* center) {
  const Support towards_children = support(other, pruning.other_direction32);
  const double other_support = static_cast<double>(towards_children.upper) * transform.other_unit;
  const double room = dot3(pruning.direction, center) - other_support - pruning.distance - transform.error;
  const double units = std::clamp(room * transform.per_unit, -base::max_units, base::max_units);
  return {pruning.direction32, base::float_down(units) - node.radius * base::projection_error,
          base::float_up(std::min(pruning.distance * transform.per_unit, base::max_units)),
          towards_children.extent * transform.ratio};
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

// A child volume as a sphere cut by a slab, next to a node of the other tree.

/// The centers, half sizes of boxes and slab normals of the children `i` and following.
LIMBER_KERNEL Packet3 centers(const bvh::ChildBounds& n, std::uint32_t i) {
  return {Packet::load(n.center_x + i), Packet::load(n.center_y + i), Packet::load(n.center_z + i)};
}
LIMBER_KERNEL Packet3 half_sizes(const bvh::ChildBounds& n, std::uint32_t i) {
  return {Packet::load(n.half_x + i), Packet::load(n.half_y + i), Packet::load(n.half_z + i)};
}
LIMBER_KERNEL Packet3 normals(const bvh::ChildBounds& n, std::uint32_t i) {
  return {Packet::load(n.normal_x + i), Packet::load(n.normal_y + i), Packet::load(n.normal_z + i)};
}

/// A plane of a slab that cuts a sphere: its height over the sphere's center along the slab's outward normal, negative
/// where the slab does not contain the center, and the radius of the circle in which it cuts the sphere.
struct Cap {
  Packet height, rim;
};

LIMBER_KERNEL Cap cap(Packet radius, Packet height) {
  return {height, sqrt(max(radius * radius - height * height, zero()))};
}
LIMBER_KERNEL Cap select(Mask which, const Cap& a, const Cap& b) {
  return {select(which, a.height, b.height), select(which, a.rim, b.rim)};
}

/// The support of a sphere, less what lies beyond a cut, in a direction at an angle to the cut's outward normal: that
/// of the sphere where its farthest point remains, that of the rim otherwise. Pre: cosine >= 0.
LIMBER_KERNEL Packet support(Packet radius, const Cap& c, Packet cosine, Packet sine) {
  return select(radius * cosine <= c.height, radius, c.height * cosine + c.rim * sine);
}

/// Squared length of a vector with these components, negative ones counting as none.
LIMBER_KERNEL Packet gap_sq(Packet along, Packet across) {
  const Packet u = max(along, zero()), v = max(across, zero());
  return u * u + v * v;
}

/// Squared length of a vector with these components, negative ones counting as none.
LIMBER_KERNEL Packet length_of_gaps_sq(const Packet3& gaps) {
  const Packet3 g{max(gaps.x, zero()), max(gaps.y, zero()), max(gaps.z, zero())};
  return dot(g, g);
}

/// Children `i` and following of a node, and a projected node.
struct NodePairs {
  Packet3 center, half, normal;
  Packet3 d;  // from the children's centers to that of the projected node
  Packet radius, distance, d_sq;
  Packet radius_sum, sphere_gap;  // of both
  Cap upper, lower;
};

LIMBER_KERNEL NodePairs pair_up(const bvh::ChildBounds& children, std::uint32_t i, const ProjectedNode& other) {
  const bvh::ChildBounds& n = children;
  NodePairs p;
  p.center = centers(n, i);
  p.half = half_sizes(n, i);
  p.normal = normals(n, i);
  p.radius = Packet::load(n.radius + i);
  p.upper = cap(p.radius, Packet::load(n.high + i));
  p.lower = cap(p.radius, zero() - Packet::load(n.low + i));
  p.d = broadcast(other.center) - p.center;
  p.d_sq = dot(p.d, p.d);
  p.distance = sqrt(p.d_sq);
  p.radius_sum = p.radius + Packet::set(other.radius);
  p.sphere_gap = p.distance - p.radius_sum;
  return p;
}

LIMBER_KERNEL Packet box_support(const Packet3& half, const Packet3& direction) {
  return abs(direction.x) * half.x + abs(direction.y) * half.y + abs(direction.z) * half.z;
}

// The closest points of triangles to a point, nearly.

// Replaces smaller divisors: lengths and squares, in quantization steps or in units.
inline constexpr float shortest_divisor = 0x1p-60F;

/// Triangles (a, b, c) of a packet of slots, relative to a point.
struct PointTriangles {
  Packet3 to_corner;       // from the point to a
  Packet3 edge_b, edge_c;  // from a to b, and from a to c
};

/// A point of each triangle near the closest one, relative to the query point. Rounding may make it a worse point, but
/// it stays on the triangle: weights of b and c are never negative; together they are at most 1 (or 1 + 2^-23, by
/// rounding).
LIMBER_KERNEL Packet3 nearly_closest(const PointTriangles& t) {
  const Packet one = Packet::set(1), least = Packet::set(shortest_divisor);
  const auto clamped = [&](Packet x) { return min(max(x, zero()), one); };
  const Packet bb = dot(t.edge_b, t.edge_b), bc = dot(t.edge_b, t.edge_c), cc = dot(t.edge_c, t.edge_c);
  const Packet along_b = zero() - dot(t.to_corner, t.edge_b), along_c = zero() - dot(t.to_corner, t.edge_c);
  // The closest points of the edges ab and ac, and of bc, which is called the third edge. The point of weights v, w is
  // x = a + v edge_b + w edge_c. With p the query point, change = (|x - p|^2 - |a - p|^2) / 2 is enough to compare
  // points, and free of the cancellation of large squares. It is v (bb v / 2 + w bc - along_b) + w (cc w / 2 -
  // along_c), and negative where x is nearer than a.
  const Packet half = Packet::set(0.5F);
  const Packet at_b = clamped(along_b / max(bb, least)), at_c = clamped(along_c / max(cc, least));
  const Packet third_sq = bb - bc - bc + cc;
  const Packet third_c = clamped((along_c - along_b + bb - bc) / max(third_sq, least));
  const Packet third_b = one - third_c;
  const Packet change_b = at_b * (at_b * half * bb - along_b), change_c = at_c * (at_c * half * cc - along_c);
  const Packet change_third =
      third_b * (third_b * half * bb + third_c * bc - along_b) + third_c * (third_c * half * cc - along_c);
  const Mask c_is_nearer = change_c < change_b;
  Packet weight_b = select(c_is_nearer, zero(), at_b), weight_c = select(c_is_nearer, at_c, zero());
  const Mask third_is_nearest = change_third < min(change_b, change_c);
  weight_b = select(third_is_nearest, third_b, weight_b), weight_c = select(third_is_nearest, third_c, weight_c);
  // The foot of the point, if it is inside of the triangle: its weights are proportional to the areas opposite corners.
  const Packet area_b = cc * along_b - bc * along_c, area_c = bb * along_c - bc * along_b;
  const Packet area = bb * cc - bc * bc, area_a = area - area_b - area_c;
  const Mask is_inside = (area_a > zero()) & (area_b > zero()) & (area_c > zero());
  const Packet per_area = one / max(area_a + area_b + area_c, least);
  weight_b = select(is_inside, area_b * per_area, weight_b), weight_c = select(is_inside, area_c * per_area, weight_c);
  return t.to_corner + t.edge_b * weight_b + t.edge_c * weight_c;
}

/// The gap between the point and each triangle along a direction, times the length of `direction`. Negative if the
/// point's height along the direction is within the interval of the corners' heights.
LIMBER_KERNEL Packet gap_times_length(const PointTriangles& t, const Packet3& direction) {
  const Packet height = dot(t.to_corner, direction);
  const Packet b = dot(t.edge_b, direction), c = dot(t.edge_c, direction);
  return max(height + min(min(b, c), zero()), zero() - height - max(max(b, c), zero()));
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
