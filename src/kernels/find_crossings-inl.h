// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_crossings, a pair of triangles in each lane.
//
// Only pairs about which rounding can change nothing are answered, see is_certain(); what is computed for the others
// means nothing. The point and its weights are to the bit those of geometry::closest_features().

#if defined(LIMBER_SIMD_FIND_CROSSINGS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_CROSSINGS_INL_H
#undef LIMBER_SIMD_FIND_CROSSINGS_INL_H
#else
#define LIMBER_SIMD_FIND_CROSSINGS_INL_H
#endif

#include <cstddef>
#include <cstdint>
#include <limits>

#include "kernels/triangle_lanes-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// geometry::Face, in lanes.
struct FaceLanes {
  TriangleLanes t;
  Quad3 edge[3], inward[3], normal;

  LIMBER_KERNEL explicit FaceLanes(const TriangleLanes& triangle) : t(triangle) {
    for (std::size_t k = 0; k < 3; ++k) edge[k] = t.corner[k == 2 ? 0 : k + 1] - t.corner[k];
    normal = cross(edge[0], edge[1]);
    for (std::size_t k = 0; k < 3; ++k) inward[k] = cross(normal, edge[k]);
  }
  /// Twice the area between the foot of p and edge k, times the length of the normal, as geometry::Face::areas().
  LIMBER_KERNEL Quad area(std::size_t k, const Quad3& p) const { return dot(inward[k], p - t.corner[k]); }
  LIMBER_KERNEL QuadMask has_foot(const Quad3& p) const {
    const Quad w0 = area(1, p), w1 = area(2, p), w2 = area(0, p), zero = number(0);
    return (w0 >= zero) & (w1 >= zero) & (w2 >= zero) & (w0 + w1 + w2 > zero);
  }
  /// The weights of the foot of p, computed step by step as geometry::Face::foot_weights() does.
  LIMBER_KERNEL Quad3 foot_weights(const Quad3& p) const {
    const Quad smallest = number(std::numeric_limits<double>::min()), zero = number(0), one = number(1);
    const Quad3 to_p = p - t.corner[0], to_v1 = edge[0], to_v2 = edge[2] * number(-1);
    const Quad per_height = one / max(dot(inward[0], to_v2), smallest);
    const Quad per_length_sq = one / max(length_sq(to_v1), smallest);
    const Quad w2 = min(max(zero, dot(inward[0], to_p) * per_height), one);
    const Quad3 off = to_p - to_v2 * w2;
    const auto clamped = [&](Quad weight) { return min(max(zero, weight), one - w2); };
    const Quad rough = clamped(dot(to_v1, off) * per_length_sq);
    const Quad w1 = clamped(rough + dot(to_v1, off - to_v1 * rough) * per_length_sq);
    return {one - w2 - w1, w1, w2};
  }
};
LIMBER_KERNEL FaceLanes select(QuadMask which, const FaceLanes& a, const FaceLanes& b) {
  FaceLanes chosen = a;
  chosen.t = select(which, a.t, b.t);
  for (std::size_t k = 0; k < 3; ++k) {
    chosen.edge[k] = select(which, a.edge[k], b.edge[k]);
    chosen.inward[k] = select(which, a.inward[k], b.inward[k]);
  }
  chosen.normal = select(which, a.normal, b.normal);
  return chosen;
}

/// The point with the given weights, computed step by step as geometry::point_at() does.
LIMBER_KERNEL Quad3 point_at(const TriangleLanes& t, const Quad3& w) {
  const Quad3 &v0 = t.corner[0], &v1 = t.corner[1], &v2 = t.corner[2];
  const auto from = [](const Quad3& k, Quad w_i, const Quad3& i, Quad w_j, const Quad3& j) {
    return k + ((i - k) * w_i + (j - k) * w_j);
  };
  const QuadMask x_y = w.x >= w.y, x_z = w.x >= w.z, y_z = w.y >= w.z;
  const auto of = [&](const auto& k0, const auto& k1, const auto& k2) {
    return select(x_y, select(x_z, k0, k2), select(y_z, k1, k2));
  };
  return from(of(v0, v1, v2), of(w.y, w.z, w.x), of(v1, v2, v0), of(w.z, w.x, w.y), of(v2, v0, v1));
}

/// Where an edge of one triangle of a pair, the owner, crosses the other, the target.
struct CrossingLanes {
  Quad of_a;                        ///< 1 where the owner is a, -1 where it is b, 0 where no crossing was found
  Quad edge, parameter;             ///< of the owner
  Quad start, end;                  ///< heights of the edge's ends over the target, times the length of its normal
  Quad3 point, opposite_of_edge{};  ///< the crossing, and the owner's corner that the edge does not have

  /// Takes the first edge of the owner that seems to cross the target, if there is one. So the owner to be asked first
  /// comes last.
  LIMBER_KERNEL void look_at(const FaceLanes& owner, const FaceLanes& target, double is_a) {
    Quad height[3];
    for (std::size_t k = 0; k < 3; ++k) height[k] = dot(owner.t.corner[k] - target.t.corner[0], target.normal);
    for (std::size_t k = 3; k-- > 0;) {
      const std::size_t next = k == 2 ? 0 : k + 1, last = k == 0 ? 2 : k - 1;
      const Quad s = height[k], e = height[next];
      const QuadMask crosses_plane = (min(s, e) < number(0)) & (max(s, e) >= number(0));
      const Quad at = s / (s - e);
      const Quad3 p = owner.t.corner[k] + owner.edge[k] * at;
      const QuadMask is_new = crosses_plane & target.has_foot(p);
      of_a = select(is_new, number(is_a), of_a);
      edge = select(is_new, number(static_cast<double>(k)), edge);
      parameter = select(is_new, at, parameter);
      start = select(is_new, s, start), end = select(is_new, e, end);
      point = select(is_new, p, point);
      opposite_of_edge = select(is_new, owner.t.corner[last], opposite_of_edge);
    }
  }
};

/// Whether rounding can change nothing about a crossing: it is far from the edge's ends, and from the edges of the
/// target, a millionth of the extent. Then it is the point that is shared there, and no smaller features touch there.
///
/// With u = 2^-53, E the extent, and an angle of the face of at least 7 degrees, heights over the plane and over the
/// edges are off by less than 2^-44 E. The crossing edge then passes the edges of the face at more than 2^-42 E, since
/// it is at most 4 E long. Rounded corners are off by 2 u E, and moving corners by less than half of these distances
/// changes nothing: no end gets to the face, and the edge gets to no edge of the face.
LIMBER_KERNEL QuadMask is_certain(const CrossingLanes& c, const FaceLanes& target, const Quad3& weights, Quad extent) {
  const Quad far = extent * number(0x1p-20), far_sq = far * far;
  const Quad normal_sq = length_sq(target.normal), tolerance = extent * number(shared_point_tolerance);
  QuadMask certain = length_sq(c.point - point_at(target.t, weights)) <= tolerance * tolerance;
  certain = certain & (normal_sq > length_sq(target.edge[0]) * length_sq(target.edge[1]) * number(0x1p-6));
  for (std::size_t k = 0; k < 3; ++k) {
    const Quad area = target.area(k, c.point);
    certain = certain & (area * area > far_sq * length_sq(target.inward[k]));
  }
  certain = certain & (c.start * c.start > far_sq * normal_sq) & (c.end * c.end > far_sq * normal_sq);
  return certain & (largest_abs(c.opposite_of_edge - c.point) > far);
}

LIMBER_KERNEL void find_crossings(const TrianglePairs& pairs, Crossings& found) {
  found.are_certain = found.are_of_a = 0;
  for (std::uint32_t i = 0; i < TrianglePairs::room; i += Quad::lanes) {
    const TriangleLanes a = TriangleLanes::load(pairs.a, i), b = TriangleLanes::load(pairs.b, i);
    const Quad3 origin = a.corner[0];
    const FaceLanes local_a(a.from(origin)), local_b(b.from(origin));
    const Quad zero = number(0), extent = largest_coordinate(local_a.t, local_b.t);
    CrossingLanes crossing{zero, zero, zero, zero, zero, {zero, zero, zero}, {zero, zero, zero}};
    crossing.look_at(local_b, local_a, -1), crossing.look_at(local_a, local_b, 1);
    const QuadMask is_of_a = crossing.of_a > zero;
    const FaceLanes target = select(is_of_a, local_b, local_a);
    const Quad3 weights = target.foot_weights(crossing.point);
    store(origin + crossing.point, found.point + i), store(weights, found.weights_in_face + i);
    crossing.edge.store(found.edge + i), crossing.parameter.store(found.parameter + i);
    const QuadMask certain =
        (abs(crossing.of_a) > zero) & is_ordinary(extent) & is_certain(crossing, target, weights, extent);
    found.are_certain |= bits(certain) << i;
    found.are_of_a |= bits(is_of_a) << i;
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
