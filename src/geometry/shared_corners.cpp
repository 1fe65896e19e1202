// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Decides exactly whether two triangles that share a corner or an edge meet anywhere else. First a filter looks for a
// plane through the shared corner or edge that separates the rest of them. In smooth meshes such a plane is nearly
// perpendicular to both triangles: inner products find it reliably, while volumes of four nearly coplanar corners are
// mere rounding. The few other pairs are decided by exact signs of volumes and, where one is 0, of areas.
//
// Source   Proofs: docs/algorithms/intersection.md, "Triangles that share corners".
#include "geometry/shared_corners.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/check.h"
#include "geometry/primitives.h"

namespace limber {
namespace {

// With u = 2^-53, an inner product x . y of rounded differences is off by 5 u |x| |y|: 2 u for the differences, 3 u for
// a product and two additions. In (e x p) . (e x q) = (e.e) (p.q) - (e.p) (e.q) each of two products is off by 11 u
// (5 + 5 + 1), and the difference by 2 u more: 24 u |e|^2 |p| |q| in all, so by 12 u |e|^2 (|p|^2 + |q|^2). The rest is
// room.
constexpr double edge_filter_error = 16 * 0x1p-53;
// Let x be one of p1, p2, q1, q2 and S the sum of their squares. In x . p1 + x . p2 - x . q1 - x . q2 the products
// |x| |y| <= (|x|^2 + |y|^2) / 2 are together at most 2.5 S; 5 u each, and 2 u for two levels of sums, make 17.5 u S.
constexpr double corner_filter_error = 32 * 0x1p-53;
// A product that underflows is off by 2^-1075. In (e x p) . (e x q) a dozen such errors are multiplied by squares below
// 2^404, because coordinates are at most 2^200 in size: below 2^-667 in all. In the corner filter, of sums of inner
// products, nothing multiplies them, so 2^-1000 is ample.
constexpr double edge_filter_underflow = 0x1p-660, corner_filter_underflow = 0x1p-1000;

/// Whether p and q, which start where the edge vector e does, are certainly on different sides, strictly, of the plane
/// that contains e and is perpendicular to the plane of e and p: (e x p) . (e x q) < 0.
inline bool edge_plane_separates(const Vec3& e, const Vec3& p, const Vec3& q) {
  const double ee = dot(e, e), bound = edge_filter_error * (ee * (dot(p, p) + dot(q, q))) + edge_filter_underflow;
  return ee * dot(p, q) - dot(e, p) * dot(e, q) + bound < 0;
}

/// Whether a plane through the shared corner proves that two triangles meet only there. Their other corners, relative
/// to the shared one, are p1, p2 and q1, q2. False proves nothing.
bool are_separated_at_corner(const Vec3& p1, const Vec3& p2, const Vec3& q1, const Vec3& q2) {
  // The plane perpendicular to m = p1 + p2 - q1 - q2 separates if each p . m and each -q . m is positive.
  const double p11 = dot(p1, p1), p12 = dot(p1, p2), p22 = dot(p2, p2);
  const double q11 = dot(q1, q1), q12 = dot(q1, q2), q22 = dot(q2, q2);
  const double p1q1 = dot(p1, q1), p1q2 = dot(p1, q2), p2q1 = dot(p2, q1), p2q2 = dot(p2, q2);
  const double least_p_m = std::min(p11 + p12 - (p1q1 + p1q2), p12 + p22 - (p2q1 + p2q2));
  const double least_minus_q_m = std::min(q11 + q12 - (p1q1 + p2q1), q12 + q22 - (p1q2 + p2q2));
  const double rounding = corner_filter_error * (p11 + p22 + (q11 + q22)) + corner_filter_underflow;
  if (std::min(least_p_m, least_minus_q_m) > rounding) return true;
  // The plane through an edge of one triangle, perpendicular to it, contains no other point of that triangle. It
  // separates if both corners of the other triangle are strictly on the other side.
  return (edge_plane_separates(p1, p2, q1) && edge_plane_separates(p1, p2, q2)) ||
         (edge_plane_separates(p2, p1, q1) && edge_plane_separates(p2, p1, q2)) ||
         (edge_plane_separates(q1, q2, p1) && edge_plane_separates(q1, q2, p2)) ||
         (edge_plane_separates(q2, q1, p1) && edge_plane_separates(q2, q1, p2));
}

/// A triangle as the union of segments from a corner v to a far side that does not contain v: the opposite edge (x, y).
/// A degenerate triangle with v on that edge is two segments from v, and its far sides are their ends, x and y.
///
/// Two triangles with corner v share another point if and only if a far side of one meets the other: a shared point can
/// be moved away from v, straight on, until it leaves one of them, at a far side.
struct FarSides {
  std::array<Segment, 2> side;
  std::size_t count = 0;
  void add(const Vec3& p0, const Vec3& p1) { side[count++] = {p0, p1}; }
};

/// Pre      x and y are the other corners of a triangle with corner v.
FarSides far_sides(const Vec3& v, const Vec3& x, const Vec3& y) {
  using geometry::lexicographically_less;
  const auto [low, high] = std::minmax(x, y, lexicographically_less);
  const bool may_be_on_edge = !lexicographically_less(v, low) && !lexicographically_less(high, v);
  FarSides far;
  if (!may_be_on_edge || !geometry::are_collinear(v, x, y)) {
    far.add(x, y);
  } else {
    if (x != v) far.add(x, x);
    if (y != v) far.add(y, y);
  }
  return far;
}

/// Whether a far side of one triangle meets the other triangle; v is the corner that both share.
bool far_side_meets(const FarSides& of_one, const Vec3& v, const FarSides& of_other) {
  for (std::size_t i = 0; i < of_one.count; ++i) {
    for (std::size_t j = 0; j < of_other.count; ++j) {
      const Triangle part{v, of_other.side[j].p0, of_other.side[j].p1};
      if (geometry::intersects(of_one.side[i], part)) return true;
    }
  }
  return false;
}

/// Whether triangles (v, a1, a2) and (v, b1, b2) share any point but v, by signs alone.
///
/// A plane through v proves that they do not, in two cases: all of one triangle but v is strictly on one side, and none
/// of the other is; or the plane contains an edge of each, and the triangles are on different sides. Six planes contain
/// two of the four edges at v: that of a, that of b, and four of (v, ai, bj). Four volumes tell the sides of corners.
bool meet_beyond_corner_exactly(const Vec3& v, const Vec3& a1, const Vec3& a2, const Vec3& b1, const Vec3& b2) {
  const int side_b1 = geometry::orient3d(v, a1, a2, b1), side_b2 = geometry::orient3d(v, a1, a2, b2);
  if (side_b1 * side_b2 > 0) return false;  // the plane of a: b1 and b2 are on one side
  const int side_a1 = geometry::orient3d(v, b1, b2, a1), side_a2 = geometry::orient3d(v, b1, b2, a2);
  if (side_a1 * side_a2 > 0) return false;  // the plane of b: a1 and a2 are on one side
  // The planes of (v, ai, bj): the other two corners are on different sides. Their volumes are the four above, negated
  // once for each exchange of two corners.
  if (-side_b1 * side_a1 < 0) return false;   // (v, a1, b1): a2 and b2
  if (-side_b2 * -side_a1 < 0) return false;  // (v, a1, b2): a2 and b1
  if (side_b1 * side_a2 < 0) return false;    // (v, a2, b1): a1 and b2
  if (side_b2 * -side_a2 < 0) return false;   // (v, a2, b2): a1 and b1
  // If no volume is 0, a plane that separates the triangles can be turned about v until it contains two of the edges
  // and still separates. None of the six does, so they meet.
  if (side_b1 != 0 && side_b2 != 0 && side_a1 != 0 && side_a2 != 0) return true;
  const FarSides far_a = far_sides(v, a1, a2), far_b = far_sides(v, b1, b2);
  return far_side_meets(far_a, v, far_b) || far_side_meets(far_b, v, far_a);
}

/// Whether triangles (v, w, a) and (v, w, b) share any point off the edge vw, by signs alone.
bool meet_beyond_edge_exactly(const Vec3& v, const Vec3& w, const Vec3& a, const Vec3& b) {
  using geometry::lexicographically_less;
  if (v == w) return meet_beyond_corner_exactly(v, v, a, v, b);  // the edge is a point, the triangles are segments
  if (geometry::orient3d(v, w, a, b) != 0) return false;         // different planes meet in the line vw only
  // In one plane: are a and b strictly on one side of the line vw? faithful_axis() gives an
  // axis to drop so that v, w and a do not become collinear; there is none if and only if a is on the line.
  if (const std::optional<std::size_t> axis = geometry::faithful_axis(v, w, a)) {
    return geometry::orient2d(v, w, a, *axis) * geometry::orient2d(v, w, b, *axis) > 0;
  }
  if (!geometry::are_collinear(v, w, b)) return false;  // the line vw has only the segment vw in common with (v, w, b)
  // Both triangles are on the line: they overlap off vw if and only if a and b are beyond one end of it.
  const auto [low, high] = std::minmax(v, w, lexicographically_less);
  return (lexicographically_less(a, low) && lexicographically_less(b, low)) ||
         (lexicographically_less(high, a) && lexicographically_less(high, b));
}

/// meets_elsewhere() in general, for triangles that share vertices: all three, or some that one of them names twice.
bool meets_elsewhere_in_general(const Triangle& a, const std::array<VertexId, 3>& ids_a, const Triangle& b,
                                const std::array<VertexId, 3>& ids_b) {
  std::array<std::size_t, 3> at_a{}, at_b{};  // for each shared vertex the first corner of a, and of b, that names it
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const bool is_repeated = std::find(ids_a.begin(), ids_a.begin() + i, ids_a[i]) != ids_a.begin() + i;
    const auto found = std::find(ids_b.begin(), ids_b.end(), ids_a[i]);
    if (is_repeated || found == ids_b.end()) continue;
    at_a[count] = i, at_b[count] = static_cast<std::size_t>(found - ids_b.begin());
    ++count;
  }
  LIMBER_ASSERT(count > 0);
  if (count == 1) return geometry::meet_beyond_shared_corner(a, at_a[0], b, at_b[0]);
  if (count == 3) return false;  // both are the same set of points
  const auto third = [](const std::array<std::size_t, 3>& at) { return 3 - at[0] - at[1]; };  // 0 + 1 + 2 = 3
  return geometry::meet_beyond_shared_edge(a, third(at_a), b, third(at_b));
}

}  // namespace

bool geometry::meet_beyond_shared_corner(const Triangle& a, std::size_t corner_a, const Triangle& b,
                                         std::size_t corner_b) {
  LIMBER_ASSERT(corner_a < 3 && corner_b < 3);
  const Vec3& v = a[corner_a];
  LIMBER_ASSERT(v == b[corner_b]);
  const Vec3 &a1 = a[next_corner[corner_a]], &a2 = a[next_corner[next_corner[corner_a]]];
  const Vec3 &b1 = b[next_corner[corner_b]], &b2 = b[next_corner[next_corner[corner_b]]];
  return !are_separated_at_corner(a1 - v, a2 - v, b1 - v, b2 - v) && meet_beyond_corner_exactly(v, a1, a2, b1, b2);
}

bool geometry::meet_beyond_shared_edge(const Triangle& a, std::size_t apex_a, const Triangle& b, std::size_t apex_b) {
  LIMBER_ASSERT(apex_a < 3 && apex_b < 3);
  const Vec3 &v = a[next_corner[apex_a]], &w = a[next_corner[next_corner[apex_a]]];
  LIMBER_ASSERT((v == b[next_corner[apex_b]] && w == b[next_corner[next_corner[apex_b]]]) ||
                (w == b[next_corner[apex_b]] && v == b[next_corner[next_corner[apex_b]]]));
  return !edge_plane_separates(w - v, a[apex_a] - v, b[apex_b] - v) &&
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
  // only_corner[mask] is the corner whose bit is the only one set; 3 if none or several are set. The apex is the corner
  // that is not shared.
  constexpr std::array<std::uint8_t, 8> only_corner{3, 0, 1, 3, 2, 3, 3, 3};
  const std::size_t apex_a = only_corner[7 & ~shared_a], apex_b = only_corner[7 & ~shared_b];
  if (apex_a < 3 && apex_b < 3) return meet_beyond_shared_edge(a, apex_a, b, apex_b);
  const std::size_t corner_a = only_corner[shared_a], corner_b = only_corner[shared_b];
  if (corner_a < 3 && corner_b < 3) return meet_beyond_shared_corner(a, corner_a, b, corner_b);
  return meets_elsewhere_in_general(a, ids_a, b, ids_b);
}

}  // namespace limber
