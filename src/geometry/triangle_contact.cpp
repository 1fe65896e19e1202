// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The contact of two triangles: closest features, a normal from a to b, and how deep they are in each other.
//
// 1. features_and_direction() finds the closest features; of pairs that cross beyond doubt the kernel find_crossings().
// 2. Apart: the normal is that of a plane that keeps them apart, across the line of the closest points. If rounding
//    turns it, normal_of_a_small_gap() finds the direction along which the triangles leave the largest gap.
// 3. Intersecting: separate() finds the axis along which they overlap least, and that overlap, the depth. The kernel
//    find_least_overlaps() does so for ordinary triangles, LeastOverlap for all others.
// 4. Where faces have an outside, intersecting ones get the normal out_of_a(), between that of a and the negative of
//    that of b. For others side_of() says how the normal lies to the outsides.
// The kernels (src/kernels/find_crossings-inl.h) do 3 and 4 by the same formulas: a change is one of both.
//
// Based on  the separating axes of two triangles, [Ericson2005] 5.2.1: two face normals and nine cross products of
//           edges. The least overlap along them is the shortest motion that parts the two.
// Differs   Every axis is a candidate, however badly conditioned: a wrong one costs some depth, never the promise.
//           docs/algorithms/triangle_distance.md says more. Triangles are put in an order that does not depend on which
//           is a, so that swapping them negates the normal to the bit.
#include "geometry/triangle_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/check.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "simd/kernels.h"

namespace limber {
namespace {

using geometry::near_unit;
using geometry::next_corner;

// A cross product of edges of a smaller sine than 2^-30 has lost half of its digits.
constexpr double least_sine_sq = 0x1p-60;

/// The direction of a vector, of length 1. It divides: the inverse in unit() rounds once more. Pre: as near_unit().
Vec3 normalized(const Vec3& v) {
  const Vec3 w = near_unit(v);
  const double w_length = length(w);
  return {w.x / w_length, w.y / w_length, w.z / w_length};
}

/// The edges of a triangle, each near unit length, or 0. They come from the coordinates as given: relative to another
/// triangle's corner, a small one could lose its shape.
std::array<Vec3, 3> directions_of_edges(const Triangle& t) {
  std::array<Vec3, 3> result;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = t[next_corner[i]] - t[i];
    if (max_abs(edge) > 0) result[i] = near_unit(edge);
  }
  return result;
}

/// The part of v that is perpendicular to e, which is near unit length.
Vec3 across(const Vec3& v, const Vec3& e) { return v - e * (dot(v, e) / length_sq(e)); }

/// A vector perpendicular to both e and f up to rounding, each near unit length or 0; 0 if they are parallel.
///
/// The cross product of two nearly parallel vectors of sine s is off by the roundoff over s, as a part of its length.
/// What is off along e is taken out. The rest is across e and thus nearly across f: along f it is off by s times that.
Vec3 common_perpendicular(const Vec3& e, const Vec3& f) {
  constexpr double accurate_sq = 0x1p-4;  // then the sine is above 1 / 48, as both lengths are below 2 sqrt(3)
  const Vec3 n = cross(e, f);
  const double n_sq = length_sq(n);
  return n_sq < accurate_sq && n_sq > 0 ? across(n, e) : n;
}

/// A normal of a triangle from the pair of edges that gives the most accurate one.
Vec3 normal_of(const std::array<Vec3, 3>& edge) {
  Vec3 best;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 n = common_perpendicular(edge[i], edge[next_corner[i]]);
    if (max_abs(n) > max_abs(best)) best = n;
  }
  return best;
}

/// Whether a comes first in the order of two triangles: lexicographic, by corners.
bool comes_first(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (a[i] != b[i]) return geometry::lexicographically_less(a[i], b[i]);
  }
  return true;
}

/// Two triangles in their order, as given, and moved near the origin.
struct OrderedPair {
  bool is_a_first;
  const Triangle &given_first, &given_second;
  geometry::LocalFrame frame;
  Triangle first, second;

  OrderedPair(const Triangle& a, const Triangle& b)
      : is_a_first(comes_first(a, b)),
        given_first(is_a_first ? a : b),
        given_second(is_a_first ? b : a),
        frame(given_first.v0, {given_first.v1, given_first.v2, given_second.v0, given_second.v1, given_second.v2}),
        first(frame.to_local(given_first)),
        second(frame.to_local(given_second)) {}

  /// A direction from a to b, given from the first to the second.
  Vec3 from_a_to_b(const Vec3& direction) const { return is_a_first ? direction : -direction; }

  /// At least the overlap along the normal n from the first to the second, in exact arithmetic.
  ///
  /// With u = 2^-53 and S the largest sum of |n_k p_k|: a coordinate p_k is off by u of itself, a dot product by 3 u S
  /// more, so the overlap by 8 u S; 9 makes up for the rounding of S. Rounding the overlap, and n . n, which is 1 up to
  /// 8 u, add relative errors: together less than 2^-49 = 16 u.
  double depth(const Vec3& n) const {
    double high = -std::numeric_limits<double>::infinity(), low = -high, sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      high = std::max(high, dot(n, first[i]));
      low = std::min(low, dot(n, second[i]));
      sum = std::max({sum, dot(abs(n), abs(first[i])), dot(abs(n), abs(second[i]))});
    }
    return frame.length_from_local(std::max(0.0, (high - low) + 9 * 0x1p-53 * sum) * (1 + 0x1p-49));
  }
};

/// A triangle near the origin, and the directions of its edges and its normal, each near unit length, or 0.
struct Axes {
  Triangle corner;
  std::array<Vec3, 3> edge;
  Vec3 normal;

  Axes(const Triangle& local, const Triangle& as_given)
      : corner(local), edge(directions_of_edges(as_given)), normal(normal_of(edge)) {}
};

/// The axis along which two triangles overlap least: moving the second along it by that much parts them. Of equal ones
/// the first that was considered.
///
/// Of triangles that are apart the least overlap is minus the largest gap. If they `intersect`, a negative overlap is
/// rounding, and counts as 0.
class LeastOverlap {
 public:
  LeastOverlap(const OrderedPair& pair, bool intersect)
      : first_(pair.first, pair.given_first), second_(pair.second, pair.given_second), intersect_(intersect) {
    consider(first_.normal);
    consider(second_.normal);
    for (const Vec3& e : first_.edge) {
      for (const Vec3& f : second_.edge) consider(common_perpendicular(e, f));
    }
    if (!is_well_conditioned_) consider_across_longest_edge();
  }

  /// Takes the line from corner i of the first triangle to corner j of the second, or the part of it across an edge at
  /// one of them, if the triangles overlap less along it; but nothing with a coordinate above `longest`. Both are as
  /// given, not local: directions are the line times a power of two.
  ///
  /// With the axes above these are all that can be between the closest points of triangles that are apart.
  void consider_corners(const Vec3& line, std::size_t i, std::size_t j, double longest) {
    if (max_abs(line) == 0) return;
    const Vec3 direction = near_unit(line);
    const double line_size = max_abs(line), scaled_longest = longest * max_abs(direction);
    const auto is_too_long = [&](const Vec3& part) { return max_abs(part) * line_size > scaled_longest; };
    if (!is_too_long(direction)) consider(direction);
    constexpr std::array<std::size_t, 3> before{2, 0, 1};
    for (const Vec3* edge : {&first_.edge[before[i]], &first_.edge[i], &second_.edge[before[j]], &second_.edge[j]}) {
      if (max_abs(*edge) == 0) continue;
      const Vec3 part = across(direction, *edge);
      if (max_abs(part) == 0 || is_too_long(part)) continue;
      consider(across(near_unit(part), *edge));  // again: rounding has left something along the edge
    }
  }

  Vec3 normal() const { return normalized(axis_); }

 private:
  void consider_across_longest_edge() {
    Vec3 longest;
    for (const Triangle* t : {&first_.corner, &second_.corner}) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 edge = (*t)[next_corner[i]] - (*t)[i];
        if (max_abs(edge) > max_abs(longest)) longest = edge;
      }
    }
    if (max_abs(longest) == 0) longest = {1, 0, 0};
    longest = near_unit(longest);
    // A perpendicular without the rounding of perpendicular_to(): any length will do.
    const Vec3 size = abs(longest);
    const Vec3 sideways = size.x <= size.y && size.x <= size.z ? Vec3{0, longest.z, -longest.y}
                          : size.y <= size.z                   ? Vec3{-longest.z, 0, longest.x}
                                                               : Vec3{longest.y, -longest.x, 0};
    consider(sideways);
    consider(cross(longest, sideways));
  }

  /// Takes the axis if the triangles overlap less along it than along those before; an axis of 0 is none.
  void consider(Vec3 axis) {
    constexpr double unscaled_sq = 0x1p-200;  // a choice: in shorter axes products of coordinates may lose digits
    double axis_sq = length_sq(axis);
    if (axis_sq > least_sine_sq) is_well_conditioned_ = true;
    if (!(axis_sq > unscaled_sq)) {
      if (max_abs(axis) == 0) return;
      axis = near_unit(axis);
      axis_sq = length_sq(axis);
    }
    const Triangle &p = first_.corner, &q = second_.corner;
    const double p0 = dot(axis, p.v0), p1 = dot(axis, p.v1), p2 = dot(axis, p.v2);
    const double q0 = dot(axis, q.v0), q1 = dot(axis, q.v1), q2 = dot(axis, q.v2);
    const double ahead = std::max(std::max(p0, p1), p2) - std::min(std::min(q0, q1), q2);
    const double back = std::max(std::max(q0, q1), q2) - std::min(std::min(p0, p1), p2);
    double overlap = std::min(ahead, back);
    if (intersect_) overlap = std::max(overlap, 0.0);
    overlap /= std::sqrt(axis_sq);
    if (overlap < least_) least_ = overlap, axis_ = back < ahead ? -axis : axis;
  }

  Axes first_, second_;
  bool intersect_, is_well_conditioned_ = false;
  double least_ = std::numeric_limits<double>::infinity();
  Vec3 axis_;
};

/// A normal on the outside of a triangle, of any length; 0 if the triangle is so thin that rounding could turn it.
Vec3 outside_of(const Triangle& t) {
  const Vec3 e = t.v1 - t.v0, f = t.v2 - t.v0, n = cross(e, f);
  const double n_sq = length_sq(n), edges_sq = length_sq(e) * length_sq(f);
  // Nearly always the first two edges are good enough: their sine is above 2^-10, so that rounding takes a fifth of the
  // digits, and products of two such squares neither overflow nor vanish.
  constexpr double good_sine_sq = 0x1p-20, smallest_sq = 0x1p-400, largest_sq = 0x1p400;
  if (n_sq > good_sine_sq * edges_sq && edges_sq > smallest_sq && n_sq < largest_sq) return n;
  const Vec3 careful = normal_of(directions_of_edges(t));
  return length_sq(careful) > least_sine_sq ? careful : Vec3{};
}

/// A vector of length 1, or 0 for 0. Pre: its square neither overflows nor vanishes.
Vec3 unit_or_none(const Vec3& v) {
  LIMBER_ASSERT(max_abs(v) < 0x1p500);
  const double v_sq = length_sq(v);
  return v_sq > 0 ? v * (1 / std::sqrt(v_sq)) : Vec3{};
}

/// (r / s)^4, at most 1: r is how far a triangle reaches behind the plane of another one of unit normal n, s the root
/// of `shallow_sq`, from which on a reach is not shallow. It is never 0, so that two can be compared: 2^-160 is for
/// 2^-40 of s, which is rounding.
double weight_of_reach(const Triangle& reaching, const Triangle& plane, const Vec3& n, double shallow_sq) {
  const double behind = std::max({dot(n, plane.v0), dot(n, plane.v1), dot(n, plane.v2)}) -
                        std::min({dot(n, reaching.v0), dot(n, reaching.v1), dot(n, reaching.v2)});
  const double part_sq = std::clamp(behind * std::max(behind, 0.0) / shallow_sq, 0x1p-80, 1.0);
  return part_sq * part_sq;
}

/// A direction from a to b that is out of a and into b; 0 if there is none.
///
/// The normal of a counts by how far a reaches behind b, that of b by how far b reaches behind a. So a crate that dips
/// into a floor is pushed along the floor's normal: the floor is far behind the crate's side, the crate hardly behind
/// the floor. Each counts at least so much that the direction does not lead back through its own face. A face without
/// an outside turns to the other as far as it faces it, so that nothing jumps where they are at right angles.
Vec3 out_of_a(const Triangle& a, const Triangle& b, OrientedFaces oriented, const OrderedPair& pair) {
  const Vec3 outside_a = outside_of(a), outside_b = outside_of(b);
  const double along = dot(outside_a, outside_b);
  // Faces that look the same way within 30 degrees: the difference of their normals lies along both of them, and parts
  // them no sooner than a whole triangle has gone by.
  constexpr double cosine_sq = 0.75;
  // The product of the squares comes first, so that swapping the triangles changes no bit.
  const bool look_alike = along > 0 && along * along > cosine_sq * (length_sq(outside_a) * length_sq(outside_b));
  if (oriented == OrientedFaces::both && look_alike) return {};
  const Vec3 n_a = unit_or_none(outside_a), n_b = unit_or_none(outside_b);
  if (oriented == OrientedFaces::of_a) return n_a + dot(n_a, n_b) * n_b;
  if (oriented == OrientedFaces::of_b) return -(n_b + dot(n_a, n_b) * n_a);
  if (max_abs(n_a) == 0 || max_abs(n_b) == 0) return n_a - n_b;
  const Triangle& local_a = pair.is_a_first ? pair.first : pair.second;
  const Triangle& local_b = pair.is_a_first ? pair.second : pair.first;
  const auto longest_edge_sq = [](const Triangle& t) {
    return std::max({length_sq(t.v1 - t.v0), length_sq(t.v2 - t.v1), length_sq(t.v0 - t.v2)});
  };
  constexpr double not_zero = 0x1p-1000;  // as squares of tiny edges vanish
  const double size_sq = std::max(std::min(longest_edge_sq(local_a), longest_edge_sq(local_b)), not_zero);
  const double a_behind_b = weight_of_reach(local_a, local_b, n_b, simd::shallow_part_sq * size_sq);
  const double b_behind_a = weight_of_reach(local_b, local_a, n_a, simd::shallow_part_sq * size_sq);
  const double cosine = dot(n_a, n_b);
  return std::max(a_behind_b, cosine * b_behind_a) * n_a - std::max(b_behind_a, cosine * a_behind_b) * n_b;
}

/// How the normal from a to b, which are apart, lies to their outsides.
NormalSide side_of(const Vec3& normal, const Triangle& a, const Triangle& b, OrientedFaces oriented) {
  if (oriented == OrientedFaces::none) return NormalSide::unknown;
  const Vec3 outside_a = oriented == OrientedFaces::of_b ? Vec3{} : outside_of(a);
  const Vec3 inside_b = oriented == OrientedFaces::of_a ? Vec3{} : -outside_of(b);
  const double outside_a_sq = length_sq(outside_a), inside_b_sq = length_sq(inside_b);
  if (outside_a_sq + inside_b_sq == 0) return NormalSide::unknown;
  // Squares with a sign, and no branches: between neighbors on one surface nothing could predict them.
  constexpr double rounding = 0x1p-20;  // sine of the angle by which rounding may turn a normal out of a face; a choice
  const double ahead_of_a = dot(normal, outside_a), ahead_of_b = dot(normal, inside_b);
  const bool is_behind_a = ahead_of_a * std::abs(ahead_of_a) < -rounding * rounding * outside_a_sq;
  const bool is_behind_b = ahead_of_b * std::abs(ahead_of_b) < -rounding * rounding * inside_b_sq;
  return (static_cast<int>(is_behind_a) | static_cast<int>(is_behind_b)) != 0 ? NormalSide::inward
                                                                              : NormalSide::outward;
}

/// Whether a triangle has corners on both sides of the plane of another, but for rounding.
bool seems_to_straddle(const Triangle& t, const Triangle& plane) {
  const Vec3 normal = cross(plane.v1 - plane.v0, plane.v2 - plane.v0);
  const double h0 = dot(normal, t.v0 - plane.v0), h1 = dot(normal, t.v1 - plane.v0), h2 = dot(normal, t.v2 - plane.v0);
  return std::min(std::min(h0, h1), h2) < 0 && std::max(std::max(h0, h1), h2) > 0;
}

/// Sets the normal, side and depth of triangles that intersect.
void separate(const Triangle& a, const Triangle& b, OrientedFaces oriented, TriangleContact& contact) {
  const OrderedPair pair(a, b);
  const Vec3 normal = LeastOverlap(pair, true).normal();
  contact.normal = pair.from_a_to_b(normal);
  contact.depth = pair.depth(normal);
  LIMBER_ASSERT(contact.depth >= 0);
  if (oriented == OrientedFaces::none) return;
  const Vec3 outward = out_of_a(a, b, oriented, pair);
  if (max_abs(outward) == 0) return;
  // The depth stays the least overlap, which is along another direction (limber/geometry.h).
  contact.normal = normalized(outward);
  contact.normal_side = NormalSide::outward;
}

/// The normal of triangles that are so close that rounding turns the line of the closest points: the direction along
/// which they leave the largest gap.
Vec3 normal_of_a_small_gap(const Triangle& a, const Triangle& b, double distance) {
  constexpr double rounding = 0x1p-48;  // of distances, as a part of the extent: they promise 2^-50
  const OrderedPair pair(a, b);
  LeastOverlap least(pair, false);
  // What is longer is not the gap; 2 is a choice.
  const double longest = 2 * (distance + rounding * pair.frame.length_from_local(pair.frame.extent()));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      least.consider_corners(pair.given_second[j] - pair.given_first[i], i, j, longest);
    }
  }
  return pair.from_a_to_b(least.normal());
}

}  // namespace

void geometry::ContactBatch::find_crossings() {
  bool may_cross = false;  // some pair; one that is overlooked gets the same bits from contact(), only later
  for (std::uint32_t i = 0; i < size_ && !may_cross; ++i) {
    const Triangle t = a(i), u = b(i);
    may_cross = seems_to_straddle(t, u) && seems_to_straddle(u, t);
  }
  if (may_cross) simd::kernels().find_crossings(pairs_, crossings_);  // of all pairs, in one go
}

ClosestFeatures geometry::ContactBatch::crossing(std::uint32_t i) const {
  LIMBER_ASSERT(geometry::intersects(a(i), b(i)));
  const bool is_of_a = (crossings_.are_of_a >> i & 1) != 0;
  const auto edge = static_cast<std::size_t>(crossings_.edge[i]);
  const double parameter = crossings_.parameter[i];
  Vec3 weights_on_edge;
  weights_on_edge[edge] = 1 - parameter, weights_on_edge[next_corner[edge]] = parameter;
  const Feature of_edge{FeatureKind::edge, static_cast<std::uint8_t>(edge)}, face{FeatureKind::face, 0};
  const Vec3 &point = crossings_.point[i], &weights_in_face = crossings_.weights_in_face[i];
  if (is_of_a) return {0, point, point, of_edge, face, weights_on_edge, weights_in_face};
  return {0, point, point, face, of_edge, weights_in_face, weights_on_edge};
}

void geometry::ContactBatch::separate(std::uint32_t i, TriangleContact& contact) {
  if (!has_overlaps_) simd::kernels().find_least_overlaps(pairs_, overlaps_);
  has_overlaps_ = true;
  if ((overlaps_.are_ordinary >> i & 1) == 0) return limber::separate(a(i), b(i), oriented_[i], contact);
  contact.normal = overlaps_.normal[i], contact.depth = overlaps_.depth[i];
  if ((overlaps_.are_outward >> i & 1) != 0) contact.normal_side = NormalSide::outward;
}

TriangleContact geometry::ContactBatch::contact(std::uint32_t i, double farthest) {
  LIMBER_ASSERT(i < size_);
  const bool is_certain = (crossings_.are_certain >> i & 1) != 0;
  const FeaturesAndDirection found =
      is_certain ? FeaturesAndDirection{crossing(i), {}} : features_and_direction(a(i), b(i));
  const ClosestFeatures& closest = found.closest;
  TriangleContact contact;
  contact.distance = closest.distance;
  contact.point_a = closest.point_a, contact.point_b = closest.point_b;
  contact.feature_a = closest.feature_a, contact.feature_b = closest.feature_b;
  contact.weights_a = closest.weights_a, contact.weights_b = closest.weights_b;
  if (closest.distance == 0) {
    separate(i, contact);
  } else if (closest.distance <= farthest) {
    const Triangle t = a(i), u = b(i);
    contact.normal = found.are_proven_apart ? normalized(found.a_to_b) : normal_of_a_small_gap(t, u, closest.distance);
    contact.normal_side = side_of(contact.normal, t, u, oriented_[i]);
  }
  return contact;
}

TriangleContact geometry::contact(const Triangle& a, const Triangle& b, OrientedFaces oriented, double farthest) {
  ContactBatch batch;
  batch.add(a, b, oriented);
  batch.find_crossings();
  return batch.contact(0, farthest);
}

}  // namespace limber
