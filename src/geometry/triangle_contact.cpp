// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  the separating axes of two triangles, [Ericson2005] 5.2.1: two face normals and nine cross products of
//           edges. The difference of two triangles is a polytope whose faces have these normals, so the least overlap
//           along them is the shortest motion that parts the two.
// Differs   Every axis is a candidate, however badly conditioned: the overlap along any direction parts the triangles,
//           so a wrong direction costs some depth, never the promise. If all axes are badly conditioned, everything is
//           nearly collinear, and perpendiculars of the longest edge are tried too. Triangles are put in an order that
//           does not depend on which is a, so that swapping them negates the normal to the bit. Triangles of bodies
//           are parted along the direction between their face normals, which tells outside from inside.
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

using geometry::LocalFrame;
using geometry::near_unit;
using geometry::next_corner;

/// The direction of a vector, of length 1, with one rounding less than unit(). Pre: as near_unit().
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
Vec3 perpendicular(const Vec3& e, const Vec3& f) {
  const Vec3 n = cross(e, f);
  const double n_sq = length_sq(n);
  return n_sq < 0x1p-4 && n_sq > 0 ? across(n, e) : n;
}

/// A normal of a triangle from the pair of edges that gives the most accurate one.
Vec3 normal_of(const std::array<Vec3, 3>& edge) {
  Vec3 best;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 n = perpendicular(edge[i], edge[next_corner[i]]);
    if (max_abs(n) > max_abs(best)) best = n;
  }
  return best;
}

/// A vector perpendicular to v, which is near unit length.
Vec3 perpendicular(const Vec3& v) {
  const Vec3 size = abs(v);
  if (size.x <= size.y && size.x <= size.z) return {0, v.z, -v.y};
  return size.y <= size.z ? Vec3{-v.z, 0, v.x} : Vec3{v.y, -v.x, 0};
}

/// Two triangles near the origin.
class LocalPair {
 public:
  LocalPair(const Triangle& first, const Triangle& second)
      : frame_(first.v0, {first.v1, first.v2, second.v0, second.v1, second.v2}),
        first_(frame_.to_local(first)),
        second_(frame_.to_local(second)) {}

  const Triangle& first() const { return first_; }
  const Triangle& second() const { return second_; }
  double extent() const { return frame_.length_from_local(frame_.extent()); }

  /// At least the overlap along the normal n from the first to the second, in exact arithmetic.
  ///
  /// With u = 2^-53 and S the largest sum of |n_k p_k|: a coordinate p_k is off by u of itself, a dot product by 3 u S
  /// more, so the overlap by 8 u S. Rounding the overlap, and n . n, which is 1 up to 8 u, add relative errors.
  double depth(const Vec3& n) const {
    double high = -std::numeric_limits<double>::infinity(), low = -high, sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      high = std::max(high, dot(n, first_[i]));
      low = std::min(low, dot(n, second_[i]));
      sum = std::max({sum, dot(abs(n), abs(first_[i])), dot(abs(n), abs(second_[i]))});
    }
    return frame_.length_from_local(std::max(0.0, (high - low) + 9 * 0x1p-53 * sum) * (1 + 0x1p-49));
  }

 private:
  LocalFrame frame_;
  Triangle first_, second_;
};

/// A triangle, and the directions of its edges and its normal, each near unit length, or 0.
struct Axes {
  Triangle corner;  ///< near the origin
  std::array<Vec3, 3> edge;
  Vec3 normal;

  Axes(const Triangle& local, const Triangle& as_given)
      : corner(local), edge(directions_of_edges(as_given)), normal(normal_of(edge)) {}
};

/// The axis along which two triangles overlap least: moving the second along it by that much parts them. Of equal ones
/// the first that was considered.
///
/// A triangle that an axis separates from the other overlaps less than 0; `intersect` says that this would be rounding.
class LeastOverlap {
 public:
  LeastOverlap(const LocalPair& pair, const Triangle& first, const Triangle& second, bool intersect)
      : first_(pair.first(), first), second_(pair.second(), second), intersect_(intersect) {
    consider(first_.normal), consider(second_.normal);
    for (const Vec3& e : first_.edge) {
      for (const Vec3& f : second_.edge) consider(perpendicular(e, f));
    }
    if (!is_well_conditioned_) consider_across_longest_edge();
  }

  /// Takes the line from corner i of the first triangle to corner j of the second, or the part of it across an edge at
  /// one of them, if the triangles overlap less along it; but nothing longer than `longest`, beyond rounding.
  ///
  /// With the axes above these are all that can be between the closest points of triangles that are apart.
  void consider_corners(const Vec3& line, std::size_t i, std::size_t j, double longest) {
    if (max_abs(line) == 0) return;
    const Vec3 direction = near_unit(line);
    const double size = max_abs(line), most = longest * max_abs(direction);
    const auto is_too_long = [&](const Vec3& part) { return max_abs(part) * size > most; };
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
    const Vec3 sideways = perpendicular(longest);
    consider(sideways);
    consider(cross(longest, sideways));
  }

  /// Takes the axis if the triangles overlap less along it than along those before; an axis of 0 is none.
  void consider(Vec3 axis) {
    double axis_sq = length_sq(axis);
    // Below an angle of 2^-30 a cross product has lost half of its digits.
    if (axis_sq > 0x1p-60) is_well_conditioned_ = true;
    if (!(axis_sq > 0x1p-200)) {
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
  // Nearly always the first two edges are good enough.
  if (n_sq > 0x1p-20 * edges_sq && edges_sq > 0x1p-400 && n_sq < 0x1p400) return n;
  const Vec3 careful = normal_of(directions_of_edges(t));
  return length_sq(careful) > 0x1p-60 ? careful : Vec3{};
}

/// A vector of length 1, or 0 for 0. Pre: its square neither overflows nor vanishes.
Vec3 unit_or_none(const Vec3& v) {
  LIMBER_ASSERT(max_abs(v) < 0x1p500);
  const double v_sq = length_sq(v);
  return v_sq > 0 ? v * (1 / std::sqrt(v_sq)) : Vec3{};
}

double longest_edge_sq(const Triangle& t) {
  return std::max({length_sq(t.v1 - t.v0), length_sq(t.v2 - t.v1), length_sq(t.v0 - t.v2)});
}

/// How far a triangle reaches behind another one of unit normal n: from next to 0, which is rounding, to 1, no longer
/// shallow.
double reach(const Vec3& n, const Triangle& plane, const Triangle& other, double shallow_sq) {
  const double behind = std::max({dot(n, plane.v0), dot(n, plane.v1), dot(n, plane.v2)}) -
                        std::min({dot(n, other.v0), dot(n, other.v1), dot(n, other.v2)});
  const double part = std::clamp(behind * std::max(behind, 0.0) / shallow_sq, 0x1p-80, 1.0);
  return part * part;
}

/// A direction from a to b that is out of a and into b; 0 if there is none. `local` is a and b near the origin.
///
/// The normal of a face counts as much as the other face is reached through, but at least so much that the direction
/// does not lead back through it. A face without an outside turns to the other as far as it faces it, so that nothing
/// jumps where they are at right angles.
Vec3 out_of_a(const Triangle& a, const Triangle& b, OrientedFaces oriented, const std::array<Triangle, 2>& local) {
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
  const double size_sq = std::max(std::min(longest_edge_sq(local[0]), longest_edge_sq(local[1])), 0x1p-1000);
  const double of_a = reach(n_b, local[1], local[0], simd::shallow_part_sq * size_sq);
  const double of_b = reach(n_a, local[0], local[1], simd::shallow_part_sq * size_sq);
  return std::max(of_a, dot(n_a, n_b) * of_b) * n_a - std::max(of_b, dot(n_a, n_b) * of_a) * n_b;
}

/// How the normal from a to b, which are apart, lies to their outsides.
NormalSide side_of(const Vec3& normal, const Triangle& a, const Triangle& b, OrientedFaces oriented) {
  if (oriented == OrientedFaces::none) return NormalSide::unknown;
  const Vec3 out_of_a = oriented == OrientedFaces::of_b ? Vec3{} : outside_of(a);
  const Vec3 into_b = oriented == OrientedFaces::of_a ? Vec3{} : -outside_of(b);
  const double out_of_a_sq = length_sq(out_of_a), into_b_sq = length_sq(into_b);
  if (out_of_a_sq + into_b_sq == 0) return NormalSide::unknown;
  // Squares with a sign, and no branches: between neighbors on one surface nothing could predict them.
  constexpr double rounding = 0x1p-20;  // of a normal that lies in a face
  const double ahead_of_a = dot(normal, out_of_a), ahead_of_b = dot(normal, into_b);
  const bool is_behind_a = ahead_of_a * std::abs(ahead_of_a) < -rounding * rounding * out_of_a_sq;
  const bool is_behind_b = ahead_of_b * std::abs(ahead_of_b) < -rounding * rounding * into_b_sq;
  return (static_cast<int>(is_behind_a) | static_cast<int>(is_behind_b)) != 0 ? NormalSide::inward
                                                                              : NormalSide::outward;
}

bool comes_first(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (a[i] != b[i]) return geometry::lexicographically_less(a[i], b[i]);
  }
  return true;
}

/// Whether a triangle has corners on both sides of the plane of another, but for rounding.
bool seems_to_straddle(const Triangle& t, const Triangle& plane) {
  const Vec3 normal = cross(plane.v1 - plane.v0, plane.v2 - plane.v0);
  const double h0 = dot(normal, t.v0 - plane.v0), h1 = dot(normal, t.v1 - plane.v0), h2 = dot(normal, t.v2 - plane.v0);
  return std::min(std::min(h0, h1), h2) < 0 && std::max(std::max(h0, h1), h2) > 0;
}

/// Normal, side and depth of triangles that intersect.
void part(const Triangle& a, const Triangle& b, OrientedFaces oriented, TriangleContact& contact) {
  const bool in_order = comes_first(a, b);
  const Triangle &first = in_order ? a : b, &second = in_order ? b : a;
  const LocalPair pair(first, second);
  const Vec3 normal = LeastOverlap(pair, first, second, true).normal();
  contact.normal = in_order ? normal : -normal;
  contact.depth = pair.depth(normal);
  LIMBER_ASSERT(contact.depth >= 0);
  if (oriented == OrientedFaces::none) return;
  const Triangle &local_a = in_order ? pair.first() : pair.second(), &local_b = in_order ? pair.second() : pair.first();
  const Vec3 way = out_of_a(a, b, oriented, {local_a, local_b});
  if (max_abs(way) == 0) return;
  contact.normal = normalized(way);
  contact.normal_side = NormalSide::outward;
}

/// The normal of triangles that are so close that rounding turns the line of the closest points.
///
/// The plane perpendicular to it leaves the largest gap of all planes between the triangles.
Vec3 normal_of_a_small_gap(const Triangle& a, const Triangle& b, double distance) {
  const bool in_order = comes_first(a, b);
  const Triangle &first = in_order ? a : b, &second = in_order ? b : a;
  const LocalPair pair(first, second);
  LeastOverlap least(pair, first, second, false);
  const double longest = 2 * (distance + 0x1p-48 * pair.extent());
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) least.consider_corners(second[j] - first[i], i, j, longest);
  }
  const Vec3 normal = least.normal();
  return in_order ? normal : -normal;
}

}  // namespace

void geometry::ContactBatch::clear() {
  size_ = 0;
  crossings_.are_certain = 0;
  has_overlaps_ = false;
}

void geometry::ContactBatch::add(const Triangle& a, const Triangle& b, OrientedFaces oriented) {
  LIMBER_ASSERT(size_ < room && !has_overlaps_);
  for (std::size_t k = 0; k < 3; ++k) pairs_.a[k][size_] = a[k], pairs_.b[k][size_] = b[k];
  pairs_.has_outside_a[size_] = oriented == OrientedFaces::both || oriented == OrientedFaces::of_a ? 1 : 0;
  pairs_.has_outside_b[size_] = oriented == OrientedFaces::both || oriented == OrientedFaces::of_b ? 1 : 0;
  ++size_;
}

void geometry::ContactBatch::find_crossings() {
  for (std::uint32_t i = 0; i < size_; ++i) {
    const Triangle t = a(i), u = b(i);
    if (seems_to_straddle(t, u) && seems_to_straddle(u, t)) {
      return simd::kernels().find_crossings(pairs_, crossings_);
    }
  }
}

OrientedFaces geometry::ContactBatch::oriented(std::uint32_t i) const {
  const bool of_a = pairs_.has_outside_a[i] > 0, of_b = pairs_.has_outside_b[i] > 0;
  if (of_a) return of_b ? OrientedFaces::both : OrientedFaces::of_a;
  return of_b ? OrientedFaces::of_b : OrientedFaces::none;
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

void geometry::ContactBatch::part(std::uint32_t i, TriangleContact& contact) {
  if (!has_overlaps_) simd::kernels().find_least_overlaps(pairs_, overlaps_);
  has_overlaps_ = true;
  if ((overlaps_.are_ordinary >> i & 1) == 0) return limber::part(a(i), b(i), oriented(i), contact);
  contact.normal = overlaps_.normal[i], contact.depth = overlaps_.depth[i];
  if ((overlaps_.are_outward >> i & 1) != 0) contact.normal_side = NormalSide::outward;
}

TriangleContact geometry::ContactBatch::contact(std::uint32_t i, double farthest) {
  LIMBER_ASSERT(i < size_);
  FeaturesAndDirection found;
  if ((crossings_.are_certain >> i & 1) != 0) {
    found.closest = crossing(i);
  } else {
    found = features_and_direction(a(i), b(i));
  }
  const ClosestFeatures& closest = found.closest;
  TriangleContact contact;
  contact.distance = closest.distance;
  contact.point_a = closest.point_a, contact.point_b = closest.point_b;
  contact.feature_a = closest.feature_a, contact.feature_b = closest.feature_b;
  contact.weights_a = closest.weights_a, contact.weights_b = closest.weights_b;
  if (closest.distance == 0) {
    part(i, contact);
  } else if (closest.distance <= farthest) {
    const Triangle t = a(i), u = b(i);
    contact.normal = found.are_proven_apart ? normalized(found.a_to_b) : normal_of_a_small_gap(t, u, closest.distance);
    contact.normal_side = side_of(contact.normal, t, u, oriented(i));
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
