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

#include "kernels/compare_triangles-inl.h"
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

// Kernels::find_least_overlaps, a pair of triangles in each lane.
//
// Based on  the separating axes of two triangles, [Ericson2005] 5.2.1, as in src/geometry/triangle_contact.cpp.
// Differs   Overlaps are compared by their squares times squares of lengths, without roots and quotients. That, and
//           normals from one pair of edges, is enough for triangles of ordinary size and shape; what is computed for
//           others means nothing.

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

/// weight_of_reach() of src/geometry/triangle_contact.cpp, with a normal of any length.
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
