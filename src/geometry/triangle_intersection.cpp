// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [GuigueDevillers2003]: signs of orient3d and orient2d decide everything. Where no corner is in the plane of
//           the other triangle, two volumes tell whether the intervals in which the triangles cut the common line of
//           their planes overlap.
// Differs   Otherwise it asks whether an edge of one triangle meets the other: two closed triangles share a point
//           exactly when that is so. The question has a plain answer for every rank (triangle, segment, point), so
//           degenerate input needs no promise and no epsilon. The nine volumes spanned by pairs of edges serve both
//           directions and are computed when first asked for.
#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "geometry/plane_sides.h"
#include "geometry/primitives.h"

namespace limber {
namespace {

using geometry::faithful_axis;
using geometry::lexicographically_less;
using geometry::next_corner;

bool opposite(int sign_a, int sign_b) { return sign_a * sign_b < 0; }

/// Closed segments on one line: their lexicographic intervals overlap.
bool collinear_segments_meet(const Segment& s, const Segment& t) {
  const auto [s_low, s_high] = std::minmax(s.p0, s.p1, lexicographically_less);
  const auto [t_low, t_high] = std::minmax(t.p0, t.p1, lexicographically_less);
  return !lexicographically_less(s_high, t_low) && !lexicographically_less(t_high, s_low);
}

/// Closed segments in one plane, of which `axis` is a faithful projection.
bool coplanar_segments_meet(const Segment& s, const Segment& t, std::size_t axis) {
  const int s_t0 = geometry::orient2d(s.p0, s.p1, t.p0, axis), s_t1 = geometry::orient2d(s.p0, s.p1, t.p1, axis);
  if (s_t0 * s_t1 > 0) return false;
  const int t_s0 = geometry::orient2d(t.p0, t.p1, s.p0, axis), t_s1 = geometry::orient2d(t.p0, t.p1, s.p1, axis);
  if (t_s0 * t_s1 > 0) return false;
  if (s_t0 == 0 && s_t1 == 0 && t_s0 == 0 && t_s1 == 0) return collinear_segments_meet(s, t);
  return true;
}

/// Any two closed segments in space.
bool segments_meet(const Segment& s, const Segment& t) {
  if (geometry::orient3d(s.p0, s.p1, t.p0, t.p1) != 0) return false;
  std::optional<std::size_t> axis = faithful_axis(s.p0, s.p1, t.p0);
  if (!axis) axis = faithful_axis(s.p0, s.p1, t.p1);
  if (!axis) axis = faithful_axis(t.p0, t.p1, s.p0);  // s may be a point
  return axis ? coplanar_segments_meet(s, t, *axis) : collinear_segments_meet(s, t);
}

/// A segment and a triangle of which the segment lies in the plane, or which is itself degenerate.
bool flat_segment_meets(const Segment& s, const Triangle& t) {
  const std::optional<std::size_t> axis = faithful_axis(t.v0, t.v1, t.v2);
  if (!axis) {  // the hull of collinear corners reaches from the lexicographically first to the last
    const auto [low, high] = std::minmax({t.v0, t.v1, t.v2}, lexicographically_less);
    return segments_meet(s, {low, high});
  }
  const int turn = geometry::orient2d(t.v0, t.v1, t.v2, *axis);
  bool inside = true;
  for (std::size_t i = 0; i < 3; ++i) {
    if (coplanar_segments_meet(s, {t[i], t[next_corner[i]]}, *axis)) return true;
    inside = inside && geometry::orient2d(t[i], t[next_corner[i]], s.p0, *axis) == turn;
  }
  return inside;
}

/// The signs that decide whether two triangles meet.
class SideTests {
 public:
  SideTests(const Triangle& a, const Triangle& b) : a_(a), b_(b) {}

  /// Whether some corner or edge of a reaches the plane of b, and the other way round; nothing meets otherwise.
  bool planes_are_reached() {
    const geometry::PlaneSides of_b(b_.v0, b_.v1, b_.v2);
    for (std::size_t i = 0; i < 3; ++i) side_of_b_[i] = of_b.of(a_[i]);
    if (strictly_on_one_side(side_of_b_)) return false;
    const geometry::PlaneSides of_a(a_.v0, a_.v1, a_.v2);
    for (std::size_t i = 0; i < 3; ++i) side_of_a_[i] = of_a.of(b_[i]);
    return !strictly_on_one_side(side_of_a_);
  }

  /// Whether no corner is in the plane of the other triangle. Then intervals_overlap() is the answer.
  bool are_in_general_position() const { return none_is_zero(side_of_a_) && none_is_zero(side_of_b_); }

  /// Pre: planes_are_reached(), are_in_general_position().
  bool intervals_overlap() const {
    // The corner that is alone on its side, and the other two in the order in which the other triangle's lone corner is
    // above this one.
    const std::size_t lone_a = lone(side_of_b_), lone_b = lone(side_of_a_);
    const bool turns_a = side_of_a_[lone_b] < 0, turns_b = side_of_b_[lone_a] < 0;
    const Vec3 &p = a_[lone_a], &p1 = a_[after_if(lone_a, turns_a)], &p2 = a_[after_if(lone_a, !turns_a)];
    const Vec3 &q = b_[lone_b], &q1 = b_[after_if(lone_b, turns_b)], &q2 = b_[after_if(lone_b, !turns_b)];
    return geometry::orient3d(p, p1, q, q1) <= 0 && geometry::orient3d(p, p2, q2, q) <= 0;
  }

  bool edge_of_a_meets_b(std::size_t i) {
    return edge_meets(
        side_of_b_[i], side_of_b_[next_corner[i]], [&](std::size_t j) { return volume(i, j); }, a_, i, b_);
  }
  bool edge_of_b_meets_a(std::size_t j) {
    return edge_meets(
        side_of_a_[j], side_of_a_[next_corner[j]], [&](std::size_t i) { return volume(i, j); }, b_, j, a_);
  }

 private:
  static bool strictly_on_one_side(const std::array<int, 3>& sides) {
    return sides[0] != 0 && sides[0] == sides[1] && sides[1] == sides[2];
  }

  static bool none_is_zero(const std::array<int, 3>& sides) { return sides[0] * sides[1] * sides[2] != 0; }
  /// The corner on the one side, if two are on the other.
  static std::size_t lone(const std::array<int, 3>& sides) {
    return sides[0] == sides[1] ? 2 : sides[0] == sides[2] ? 1 : 0;
  }
  /// The corner after another, or the one before it.
  static std::size_t after_if(std::size_t corner, bool turns) {
    return geometry::next_corner[turns ? geometry::next_corner[corner] : corner];
  }

  template <typename Volume>
  static bool edge_meets(int side0, int side1, const Volume& volume_at, const Triangle& owner, std::size_t edge,
                         const Triangle& target) {
    if (side0 * side1 > 0) return false;
    if (side0 == 0 && side1 == 0) return flat_segment_meets({owner[edge], owner[next_corner[edge]]}, target);
    // The edge's line crosses the plane in one point, inside unless it passes two of the target's edges on different
    // sides.
    const int first = volume_at(0), second = volume_at(1);
    if (opposite(first, second)) return false;
    const int third = volume_at(2);
    return !opposite(first, third) && !opposite(second, third);
  }

  /// Sign of the volume spanned by edge i of a and edge j of b.
  int volume(std::size_t i, std::size_t j) {
    int& known = volumes_[i][j];
    if (known == unknown) known = geometry::orient3d(a_[i], a_[next_corner[i]], b_[j], b_[next_corner[j]]);
    return known;
  }

  static constexpr int unknown = 2;
  const Triangle& a_;
  const Triangle& b_;
  std::array<int, 3> side_of_a_{}, side_of_b_{};
  std::array<std::array<int, 3>, 3> volumes_{
      {{unknown, unknown, unknown}, {unknown, unknown, unknown}, {unknown, unknown, unknown}}};
};

bool boxes_are_apart(const Vec3& low_a, const Vec3& high_a, const Vec3& low_b, const Vec3& high_b) {
  return low_a.x > high_b.x || low_a.y > high_b.y || low_a.z > high_b.z || low_b.x > high_a.x || low_b.y > high_a.y ||
         low_b.z > high_a.z;
}

Vec3 low(const Triangle& t) { return min(t.v0, min(t.v1, t.v2)); }
Vec3 high(const Triangle& t) { return max(t.v0, max(t.v1, t.v2)); }

}  // namespace

bool geometry::intersects(const Triangle& a, const Triangle& b) {
  if (boxes_are_apart(low(a), high(a), low(b), high(b))) return false;
  SideTests tests(a, b);
  if (!tests.planes_are_reached()) return false;
  if (tests.are_in_general_position()) return tests.intervals_overlap();
  for (std::size_t i = 0; i < 3; ++i) {
    if (tests.edge_of_a_meets_b(i) || tests.edge_of_b_meets_a(i)) return true;
  }
  return false;
}

bool geometry::intersects(const Segment& segment, const Triangle& triangle) {
  return geometry::intersects(Triangle{segment.p0, segment.p1, segment.p1}, triangle);
}

}  // namespace limber
