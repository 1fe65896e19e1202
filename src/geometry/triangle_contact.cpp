// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  the separating axes of two triangles, [Ericson2005] 5.2.1: two face normals and nine cross products of
//           edges. The difference of two triangles is a polytope whose faces have these normals, so the least overlap
//           along them is the shortest motion that parts the two.
// Differs   Every axis is a candidate, however badly conditioned: the overlap along any direction parts the triangles,
//           so a wrong direction costs some depth, never the promise. If all axes are badly conditioned, everything is
//           nearly collinear, and perpendiculars of the longest edge are tried too. Triangles are put in an order that
//           does not depend on which is a, so that swapping them negates the normal to the bit.
#include "geometry/triangle_contact.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/check.h"
#include "geometry/collinear.h"
#include "geometry/local_frame.h"

namespace limber {
namespace {

using geometry::after;
using geometry::LocalFrame;

/// A vector times a power of two that brings its largest coordinate to [1, 2): its square neither overflows nor
/// vanishes.
///
/// Pre      v is finite and not 0, and below 2^1000 in size.
Vec3 near_unit(const Vec3& v) {
  const double size = max_abs(v);
  LIMBER_ASSERT(size > 0 && size < 0x1p1000);
  if (size < std::numeric_limits<double>::min()) return near_unit(v * 0x1p60);
  return v * (1 / std::bit_cast<double>(std::bit_cast<std::uint64_t>(size) & 0x7ff0'0000'0000'0000U));
}

/// Pre      As above.
Vec3 unit(const Vec3& v) {
  const Vec3 w = near_unit(v);
  const double w_length = length(w);
  return {w.x / w_length, w.y / w_length, w.z / w_length};
}

/// The edges of a triangle, each near unit length, or 0. They come from the coordinates as given: relative to another
/// triangle's corner, a small one could lose its shape.
std::array<Vec3, 3> directions_of_edges(const Triangle& t) {
  std::array<Vec3, 3> result;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = t[after[i]] - t[i];
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
    const Vec3 n = perpendicular(edge[i], edge[after[i]]);
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

/// The part of v that is perpendicular to an edge; v for other features.
Vec3 across_edge(const Vec3& v, const Triangle& t, const Feature& feature) {
  if (feature.kind != FeatureKind::edge) return v;
  const Vec3 edge = t[after[feature.index]] - t[feature.index];
  if (max_abs(edge) == 0) return v;
  return across(v, near_unit(edge));
}

/// The axis along which two triangles overlap least: moving the second along it by that much parts them.
///
/// A triangle that an axis separates from the other overlaps less than 0.
class LeastOverlap {
 public:
  LeastOverlap(const Triangle& first, const Triangle& second, bool intersect)
      : frame_(first.v0, {first.v1, first.v2, second.v0, second.v1, second.v2}),
        first_(frame_.to_local(first)),
        second_(frame_.to_local(second)),
        intersect_(intersect) {
    const std::array<Vec3, 3> e = directions_of_edges(first), f = directions_of_edges(second);
    consider(normal_of(e));
    consider(normal_of(f));
    for (const Vec3& e_i : e) {
      for (const Vec3& f_j : f) consider(perpendicular(e_i, f_j));
    }
    if (is_well_conditioned_) return;
    Vec3 longest;
    for (const Triangle* t : {&first_, &second_}) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 edge = (*t)[after[i]] - (*t)[i];
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
    is_well_conditioned_ = is_well_conditioned_ || axis_sq > 0x1p-60;
    if (!(axis_sq > 0x1p-200)) {
      if (max_abs(axis) == 0) return;
      axis = near_unit(axis);
      axis_sq = length_sq(axis);
    }
    const double p0 = dot(axis, first_.v0), p1 = dot(axis, first_.v1), p2 = dot(axis, first_.v2);
    const double q0 = dot(axis, second_.v0), q1 = dot(axis, second_.v1), q2 = dot(axis, second_.v2);
    const double ahead = std::max(std::max(p0, p1), p2) - std::min(std::min(q0, q1), q2);
    const double back = std::max(std::max(q0, q1), q2) - std::min(std::min(p0, p1), p2);
    double overlap = std::min(ahead, back);
    if (intersect_) overlap = std::max(overlap, 0.0);  // below 0 is rounding then
    overlap /= std::sqrt(axis_sq);
    if (overlap < least_) least_ = overlap, axis_ = back < ahead ? -axis : axis;
  }

  Vec3 normal() const { return unit(axis_); }

  /// At least the overlap along the normal n, in exact arithmetic.
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
  bool intersect_;
  bool is_well_conditioned_ = false;
  double least_ = std::numeric_limits<double>::infinity();
  Vec3 axis_;  ///< from the first triangle to the second
};

bool comes_first(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (a[i] != b[i]) return geometry::lexicographically_less(a[i], b[i]);
  }
  return true;
}

}  // namespace

TriangleContact geometry::contact(const Triangle& a, const Triangle& b) {
  const DirectedFeatures found = directed_features(a, b);
  const ClosestFeatures& closest = found.closest;
  TriangleContact contact{closest.distance, 0, closest.point_a, closest.point_b, {}, closest.feature_a,
                          closest.feature_b};
  if (found.are_proven_apart) {
    contact.normal = unit(found.between);
    return contact;
  }
  const bool intersect = closest.distance == 0, in_order = comes_first(a, b);
  LeastOverlap least(in_order ? a : b, in_order ? b : a, intersect);
  if (!intersect) {
    // So close that rounding turns the line of the closest points. Across the edges that they lie on it is exact again.
    for (const Vec3& line : {found.between, closest.point_b - closest.point_a}) {
      if (max_abs(line) == 0) continue;
      const Vec3 from_first = near_unit(in_order ? line : -line);
      least.consider(from_first);
      least.consider(across_edge(from_first, a, closest.feature_a));
      least.consider(across_edge(from_first, b, closest.feature_b));
    }
  }
  const Vec3 normal = least.normal();
  contact.normal = in_order ? normal : -normal;
  if (intersect) contact.depth = least.depth(normal);
  return contact;
}

}  // namespace limber
