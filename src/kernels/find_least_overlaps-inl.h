// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_least_overlaps, a pair of triangles in each lane.
//
// Based on  the separating axes of two triangles, [Ericson2005] 5.2.1, as in src/geometry/triangle_contact.cpp.
// Differs   Overlaps are compared by their squares times squares of lengths, without roots and quotients. That, and
//           normals from one pair of edges, is enough for triangles of ordinary size and shape; what is computed for
//           others means nothing.

#if defined(LIMBER_SIMD_FIND_LEAST_OVERLAPS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_LEAST_OVERLAPS_INL_H
#undef LIMBER_SIMD_FIND_LEAST_OVERLAPS_INL_H
#else
#define LIMBER_SIMD_FIND_LEAST_OVERLAPS_INL_H
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

/// The directions of a triangle's edges and its normal, and their squared lengths.
struct AxesLanes {
  Quad3 edge[3], normal;
  Quad edge_sq[3];

  /// From corners as given: relative to another triangle's corner, a small one could lose its shape.
  LIMBER_KERNEL explicit AxesLanes(const TriangleLanes& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      edge[k] = t.corner[k == 2 ? 0 : k + 1] - t.corner[k];
      edge_sq[k] = length_sq(edge[k]);
    }
    normal = perpendicular(edge[0], edge_sq[0], edge[1], edge_sq[1]);
  }
  /// Whether products of edges neither overflow nor vanish, and the normal has most of its digits.
  LIMBER_KERNEL QuadMask are_ordinary(Quad extent) const {
    const Quad least = min(min(edge_sq[0], edge_sq[1]), edge_sq[2]);
    return (least > extent * extent * number(0x1p-60)) &
           (length_sq(normal) > edge_sq[0] * edge_sq[1] * number(0x1p-20));
  }
  LIMBER_KERNEL Quad longest_sq() const { return max(max(edge_sq[0], edge_sq[1]), edge_sq[2]); }
  /// A vector perpendicular to both; src/geometry/triangle_contact.cpp says how near.
  LIMBER_KERNEL static Quad3 perpendicular(const Quad3& e, Quad e_sq, const Quad3& f, Quad f_sq) {
    const Quad3 n = cross(e, f);
    return select(length_sq(n) < e_sq * f_sq * number(0x1p-4), n - e * (dot(n, e) / e_sq), n);
  }
};
LIMBER_KERNEL AxesLanes select(QuadMask which, const AxesLanes& a, const AxesLanes& b) {
  AxesLanes chosen = a;
  for (std::size_t k = 0; k < 3; ++k) {
    chosen.edge[k] = select(which, a.edge[k], b.edge[k]);
    chosen.edge_sq[k] = select(which, a.edge_sq[k], b.edge_sq[k]);
  }
  chosen.normal = select(which, a.normal, b.normal);
  return chosen;
}

/// The axis along which two triangles that intersect overlap least, from the first to the second.
struct LeastOverlapLanes {
  const TriangleLanes &first, &second;
  Quad overlap_sq = number(std::numeric_limits<double>::infinity()), axis_sq = number(1);  ///< the overlap times |axis|
  Quad3 axis{number(0), number(0), number(0)};

  LIMBER_KERNEL void consider(const Quad3& candidate) {
    const Quad p0 = dot(candidate, first.corner[0]), p1 = dot(candidate, first.corner[1]);
    const Quad p2 = dot(candidate, first.corner[2]), q0 = dot(candidate, second.corner[0]);
    const Quad q1 = dot(candidate, second.corner[1]), q2 = dot(candidate, second.corner[2]);
    const Quad ahead = max(max(p0, p1), p2) - min(min(q0, q1), q2);
    const Quad back = max(max(q0, q1), q2) - min(min(p0, p1), p2);
    const Quad overlap = max(min(ahead, back), number(0));  // below 0 is rounding
    const Quad sq = overlap * overlap, candidate_sq = length_sq(candidate);
    const QuadMask is_less = (sq * axis_sq < overlap_sq * candidate_sq) & (candidate_sq > number(0));
    overlap_sq = select(is_less, sq, overlap_sq), axis_sq = select(is_less, candidate_sq, axis_sq);
    axis = select(is_less, candidate * select(back < ahead, number(-1), number(1)), axis);
  }
};

/// At least the overlap along the normal n from the first to the second, in exact arithmetic.
///
/// With u = 2^-53 and S the largest sum of |n_k p_k|: a coordinate p_k is off by u of itself, a dot product by 3 u S
/// more, so the overlap by 8 u S. Rounding the overlap, and n . n, which is 1 up to 8 u, add relative errors.
LIMBER_KERNEL Quad depth_along(const Quad3& n, const TriangleLanes& first, const TriangleLanes& second) {
  Quad high = number(-std::numeric_limits<double>::infinity()), low = high * number(-1), sum = number(0);
  for (std::size_t k = 0; k < 3; ++k) {
    high = max(high, dot(n, first.corner[k])), low = min(low, dot(n, second.corner[k]));
    sum = max(sum, max(dot(abs3(n), abs3(first.corner[k])), dot(abs3(n), abs3(second.corner[k]))));
  }
  return max(number(0), (high - low) + sum * number(9 * 0x1p-53)) * number(1 + 0x1p-49);
}

/// 1 where a comes first in the lexicographic order of corners, or both are equal, and -1 elsewhere.
LIMBER_KERNEL Quad order_of(const TriangleLanes& a, const TriangleLanes& b) {
  Quad order = number(1);
  const auto compare = [&](Quad x, Quad y) { order = select(x < y, number(1), select(x > y, number(-1), order)); };
  for (std::size_t k = 3; k-- > 0;) {
    const Quad3 &p = a.corner[k], &q = b.corner[k];
    compare(p.z, q.z), compare(p.y, q.y), compare(p.x, q.x);
  }
  return order;
}

/// reach() of src/geometry/triangle_contact.cpp, with a normal of any length.
LIMBER_KERNEL Quad reach(const Quad3& n, const TriangleLanes& plane, const TriangleLanes& other, Quad shallow_sq) {
  const Triple<Quad> at_plane{dot(n, plane.corner[0]), dot(n, plane.corner[1]), dot(n, plane.corner[2])};
  const Triple<Quad> at{dot(n, other.corner[0]), dot(n, other.corner[1]), dot(n, other.corner[2])};
  const Quad behind = max(max(at_plane.x, at_plane.y), at_plane.z) - min(min(at.x, at.y), at.z);
  const Quad part = behind * max(behind, number(0)) / (length_sq(n) * shallow_sq);
  const Quad clamped = min(max(part, number(0x1p-80)), number(1));
  return clamped * clamped;
}

/// out_of_a() of src/geometry/triangle_contact.cpp; 0 where there is no such direction.
LIMBER_KERNEL Quad3 out_of_a(const Quad3& normal_a, const Quad3& normal_b, Quad has_outside_a, Quad has_outside_b,
                             Quad weight_a, Quad weight_b) {
  const Quad zero = number(0), a_sq = length_sq(normal_a), b_sq = length_sq(normal_b), along = dot(normal_a, normal_b);
  const QuadMask oriented_a = has_outside_a > zero, oriented_b = has_outside_b > zero;
  const QuadMask are_both = oriented_a & oriented_b;
  const QuadMask look_alike = (along > zero) & (along * along > a_sq * b_sq * number(0.75));
  const Quad3 n_a = normal_a * (number(1) / sqrt(a_sq)), n_b = normal_b * (number(1) / sqrt(b_sq));
  const Quad cosine = dot(n_a, n_b);
  const Quad of_both_a = max(weight_a, cosine * weight_b), of_both_b = max(weight_b, cosine * weight_a);
  const Quad of_a = select(are_both, of_both_a, select(oriented_a, number(1), cosine * number(-1)));
  const Quad of_b = select(are_both, of_both_b * number(-1), select(oriented_b, number(-1), cosine));
  const Quad is_way = select(are_both & look_alike, zero, max(has_outside_a, has_outside_b));
  return (n_a * of_a + n_b * of_b) * is_way;
}

LIMBER_KERNEL void find_least_overlaps(const TrianglePairs& pairs, LeastOverlaps& found) {
  found.are_ordinary = found.are_outward = 0;
  for (std::uint32_t i = 0; i < TrianglePairs::room; i += Quad::lanes) {
    const TriangleLanes a = TriangleLanes::load(pairs.a, i), b = TriangleLanes::load(pairs.b, i);
    // In an order that does not depend on which is a, so that swapping them negates the normal to the bit.
    const Quad order = order_of(a, b), zero = number(0);
    const QuadMask in_order = order > zero;
    const Quad3 origin = select(in_order, a.corner[0], b.corner[0]);
    const TriangleLanes first = select(in_order, a, b).from(origin), second = select(in_order, b, a).from(origin);
    const AxesLanes axes_a(a), axes_b(b);
    const AxesLanes axes_first = select(in_order, axes_a, axes_b), axes_second = select(in_order, axes_b, axes_a);
    LeastOverlapLanes least{first, second};
    least.consider(axes_first.normal), least.consider(axes_second.normal);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        least.consider(AxesLanes::perpendicular(axes_first.edge[k], axes_first.edge_sq[k], axes_second.edge[j],
                                                axes_second.edge_sq[j]));
      }
    }
    const Quad3 normal = least.axis * (number(1) / sqrt(least.axis_sq));
    depth_along(normal, first, second).store(found.depth + i);
    const Quad shallow_sq = min(axes_a.longest_sq(), axes_b.longest_sq()) * number(shallow_part_sq);
    const Quad of_second = reach(axes_first.normal, first, second, shallow_sq);
    const Quad of_first = reach(axes_second.normal, second, first, shallow_sq);
    const Quad3 way =
        out_of_a(axes_a.normal, axes_b.normal, Quad::load(pairs.has_outside_a + i), Quad::load(pairs.has_outside_b + i),
                 select(in_order, of_first, of_second), select(in_order, of_second, of_first));
    const Quad way_sq = length_sq(way);
    const QuadMask is_outward = way_sq > zero;
    store(select(is_outward, way * (number(1) / sqrt(way_sq)), normal * order), found.normal + i);
    found.are_outward |= bits(is_outward) << i;
    const Quad extent = largest_coordinate(first, second);
    found.are_ordinary |= bits(is_ordinary(extent) & axes_a.are_ordinary(extent) & axes_b.are_ordinary(extent)) << i;
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
