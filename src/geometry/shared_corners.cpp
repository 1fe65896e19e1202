// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Source   docs/algorithms/intersection.md, "Triangles that share corners", has the proofs.
//
// A plane through what is shared proves nearly all pairs apart elsewhere. In smooth and flat meshes such a plane stands
// across the triangles, so inner products of edges find it, where volumes are lost in rounding. The few other pairs are
// decided by signs of volumes, and of areas where these are 0.
#include "geometry/shared_corners.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "base/check.h"
#include "geometry/collinear.h"
#include "geometry/primitives.h"

namespace limber {
namespace {

// With u = 2^-53, the value of (e x p) . (e x q) that is computed from rounded differences is off by at most
// 25 u |e|^2 |p| |q|: 8 u for the differences, 7 u for each of two products of inner products, 2 u for the subtraction.
// |p| |q| is at most the mean of the squares, so 12.5 u |e|^2 (|p|^2 + |q|^2).
constexpr double across_bound = 16 * 0x1p-53;
// The same for a sum of four inner products, as a part of the sum of the squares of their vectors: 12.5 u for the inner
// products, of which one vector is in all, and 5 u for three additions.
constexpr double side_bound = 32 * 0x1p-53;
// Products that underflow are off by 2^-1075 each. Times the square of a difference, below 2^404, that is 2^-671 each.
constexpr double across_underflow = 0x1p-660;
constexpr double side_underflow = 0x1p-1000;

/// Whether p and q point to different sides of the line along e, for certain: (e x p) . (e x q) < 0.
///
/// Then the plane along e that is perpendicular to the plane of e and p separates p and q strictly. The inner products
/// are given: of e with itself, p and q, of p with q, and the sum of those of p and of q with themselves.
bool point_apart(double ee, double ep, double eq, double pq, double pp_plus_qq) {
  return ee * pq - ep * eq + (across_bound * (ee * pp_plus_qq) + across_underflow) < 0;
}

/// Whether a plane through the common corner separates two triangles strictly, for certain, but for that corner; p and
/// q are the other corners of the two, relative to the common one.
bool are_separated_at_corner(const Vec3& p1, const Vec3& p2, const Vec3& q1, const Vec3& q2) {
  const double p11 = dot(p1, p1), p12 = dot(p1, p2), p22 = dot(p2, p2);
  const double q11 = dot(q1, q1), q12 = dot(q1, q2), q22 = dot(q2, q2);
  const double p1q1 = dot(p1, q1), p1q2 = dot(p1, q2), p2q1 = dot(p2, q1), p2q2 = dot(p2, q2);
  // The plane across the sum of the p minus that of the q.
  const double least_of_p = std::min(p11 + p12 - (p1q1 + p1q2), p12 + p22 - (p2q1 + p2q2));
  const double least_of_q = std::min(q11 + q12 - (p1q1 + p2q1), q12 + q22 - (p1q2 + p2q2));
  if (std::min(least_of_p, least_of_q) > side_bound * (p11 + p22 + (q11 + q22)) + side_underflow) return true;
  // The planes along an edge across its triangle.
  return (point_apart(p11, p12, p1q1, p2q1, p22 + q11) && point_apart(p11, p12, p1q2, p2q2, p22 + q22)) ||
         (point_apart(p22, p12, p2q1, p1q1, p11 + q11) && point_apart(p22, p12, p2q2, p1q2, p11 + q22)) ||
         (point_apart(q11, q12, p1q1, p1q2, q22 + p11) && point_apart(q11, q12, p2q1, p2q2, q22 + p22)) ||
         (point_apart(q22, q12, p1q2, p1q1, q11 + p11) && point_apart(q22, q12, p2q2, p2q1, q11 + p22));
}

/// The parts of a triangle that are stars about a corner of it, each by its far side: a segment without that corner.
/// Every point of a part is on a segment from the corner to the far side.
struct FarSides {
  std::array<Segment, 2> side;
  std::size_t count = 0;
  void add(const Vec3& p0, const Vec3& p1) { side[count++] = {p0, p1}; }
};

/// Pre      x and y are the other corners of a triangle with corner v.
FarSides far_sides(const Vec3& v, const Vec3& x, const Vec3& y) {
  using geometry::lexicographically_less;
  const bool is_between = lexicographically_less(x, y) ? !lexicographically_less(v, x) && !lexicographically_less(y, v)
                                                       : !lexicographically_less(v, y) && !lexicographically_less(x, v);
  FarSides far;
  if (!is_between || geometry::faithful_axis(v, x, y)) {
    far.add(x, y);
  } else {
    if (x != v) far.add(x, x);
    if (y != v) far.add(y, y);
  }
  return far;
}

/// The far sides of the first meet the stars of the second triangle.
bool far_sides_meet(const FarSides& of, const Vec3& v, const FarSides& other) {
  for (std::size_t i = 0; i < of.count; ++i) {
    for (std::size_t j = 0; j < other.count; ++j) {
      if (geometry::intersects(of.side[i], Triangle{v, other.side[j].p0, other.side[j].p1})) return true;
    }
  }
  return false;
}

/// As meet_beyond_shared_corner(), for triangles (v, a1, a2) and (v, b1, b2), decided by signs.
bool meet_beyond_corner_exactly(const Vec3& v, const Vec3& a1, const Vec3& a2, const Vec3& b1, const Vec3& b2) {
  // Volumes of three of the four edges at v. They are the sides that b1 and b2 have of the plane of a, and the reverse,
  // and also the sides that the other edges have of a plane along an edge of each.
  const int b1_of_a = geometry::orient3d(v, a1, a2, b1), b2_of_a = geometry::orient3d(v, a1, a2, b2);
  if (b1_of_a * b2_of_a > 0) return false;
  const int a1_of_b = geometry::orient3d(v, b1, b2, a1), a2_of_b = geometry::orient3d(v, b1, b2, a2);
  if (a1_of_b * a2_of_b > 0) return false;
  if (b1_of_a * a1_of_b > 0 || b1_of_a * a2_of_b < 0 || b2_of_a * a1_of_b < 0 || b2_of_a * a2_of_b > 0) return false;
  if (b1_of_a != 0 && b2_of_a != 0 && a1_of_b != 0 && a2_of_b != 0) return true;
  const FarSides far_a = far_sides(v, a1, a2), far_b = far_sides(v, b1, b2);
  return far_sides_meet(far_a, v, far_b) || far_sides_meet(far_b, v, far_a);
}

/// As meet_beyond_shared_edge(), for triangles (v, w, a) and (v, w, b), decided by signs.
bool meet_beyond_edge_exactly(const Vec3& v, const Vec3& w, const Vec3& a, const Vec3& b) {
  using geometry::lexicographically_less;
  if (v == w) return meet_beyond_corner_exactly(v, v, a, v, b);
  if (geometry::orient3d(v, w, a, b) != 0) return false;
  if (const std::optional<std::size_t> axis = geometry::faithful_axis(v, w, a)) {
    return geometry::orient2d(v, w, a, *axis) * geometry::orient2d(v, w, b, *axis) > 0;
  }
  if (geometry::faithful_axis(v, w, b)) return false;
  const auto [low, high] = std::minmax(v, w, lexicographically_less);
  return (lexicographically_less(a, low) && lexicographically_less(b, low)) ||
         (lexicographically_less(high, a) && lexicographically_less(high, b));
}

/// As meets_elsewhere(), where a triangle may name a vertex more than once.
bool meet_with_repeated_ids(const Triangle& a, const std::array<VertexId, 3>& ids_a, const Triangle& b,
                            const std::array<VertexId, 3>& ids_b) {
  std::array<std::size_t, 3> at_a{}, at_b{};  // where the two name the ids that they share
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto* const found = std::find(ids_b.begin(), ids_b.end(), ids_a[i]);
    if (found == ids_b.end() || std::find(ids_a.begin(), ids_a.begin() + i, ids_a[i]) != ids_a.begin() + i) continue;
    at_a[count] = i, at_b[count] = static_cast<std::size_t>(found - ids_b.begin());
    ++count;
  }
  LIMBER_ASSERT(count > 0);
  if (count == 1) return geometry::meet_beyond_shared_corner(a, at_a[0], b, at_b[0]);
  return count == 2 && geometry::meet_beyond_shared_edge(a, 3 - at_a[0] - at_a[1], b, 3 - at_b[0] - at_b[1]);
}

}  // namespace

bool geometry::meet_beyond_shared_corner(const Triangle& a, std::size_t corner_a, const Triangle& b,
                                         std::size_t corner_b) {
  LIMBER_ASSERT(corner_a < 3 && corner_b < 3);
  const Vec3& v = a[corner_a];
  LIMBER_ASSERT(v == b[corner_b]);
  const Vec3 &a1 = a[after[corner_a]], &a2 = a[after[after[corner_a]]];
  const Vec3 &b1 = b[after[corner_b]], &b2 = b[after[after[corner_b]]];
  return !are_separated_at_corner(a1 - v, a2 - v, b1 - v, b2 - v) && meet_beyond_corner_exactly(v, a1, a2, b1, b2);
}

bool geometry::meet_beyond_shared_edge(const Triangle& a, std::size_t apex_a, const Triangle& b, std::size_t apex_b) {
  LIMBER_ASSERT(apex_a < 3 && apex_b < 3);
  const Vec3 &v = a[after[apex_a]], &w = a[after[after[apex_a]]];
  LIMBER_ASSERT((v == b[after[apex_b]] && w == b[after[after[apex_b]]]) ||
                (w == b[after[apex_b]] && v == b[after[after[apex_b]]]));
  const Vec3 e = w - v, p = a[apex_a] - v, q = b[apex_b] - v;
  const double pp_plus_qq = length_sq(p) + length_sq(q);
  return !point_apart(length_sq(e), dot(e, p), dot(e, q), dot(p, q), pp_plus_qq) &&
         meet_beyond_edge_exactly(v, w, a[apex_a], b[apex_b]);
}

bool geometry::meets_elsewhere(const Triangle& a, const std::array<VertexId, 3>& ids_a, const Triangle& b,
                               const std::array<VertexId, 3>& ids_b) {
  unsigned shared_a = 0, shared_b = 0;  // bit i: the other triangle has the vertex of corner i too
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const unsigned same = ids_a[i] == ids_b[j] ? 1 : 0;
      shared_a |= same << i, shared_b |= same << j;
    }
  }
  if (shared_a == 0) return geometry::intersects(a, b);
  // The corner that is shared alone, or that is not while the others are; 3 stands for all other sets of corners.
  constexpr std::array<std::uint8_t, 8> shared_alone{3, 0, 1, 3, 2, 3, 3, 3}, not_shared{3, 3, 3, 2, 3, 1, 0, 3};
  if (not_shared[shared_a] < 3 && not_shared[shared_b] < 3) {
    return meet_beyond_shared_edge(a, not_shared[shared_a], b, not_shared[shared_b]);
  }
  if (shared_alone[shared_a] < 3 && shared_alone[shared_b] < 3) {
    return meet_beyond_shared_corner(a, shared_alone[shared_a], b, shared_alone[shared_b]);
  }
  return meet_with_repeated_ids(a, ids_a, b, ids_b);
}

}  // namespace limber
