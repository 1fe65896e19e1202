// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <tuple>

#include "limber/geometry.h"

/// The functions of limber/geometry.h as the library itself calls them, and some more. Promises are the same.
///
/// Pre      The thread is in the default floating-point environment (base/float_environment.h). The public functions
///          and queries see to that once; here it would cost as much as a predicate.
namespace limber::geometry {

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis);

bool intersects(const Triangle& a, const Triangle& b);
bool intersects(const Segment& segment, const Triangle& triangle);

/// A point that two triangles share, that of closest_points(), at a part of the cost. Pre: they intersect.
Vec3 shared_point(const Triangle& a, const Triangle& b);

ClosestPoints closest_points(const Segment& a, const Segment& b);
ClosestPoints closest_points(const Vec3& point, const Triangle& triangle);
ClosestPoints closest_points(const Triangle& a, const Triangle& b);
ClosestFeatures closest_features(const Triangle& a, const Triangle& b);
/// Without normal and side where the triangles are farther apart than `farthest`.
TriangleContact contact(const Triangle& a, const Triangle& b, OrientedFaces oriented,
                        double farthest = std::numeric_limits<double>::infinity());

/// The point of a triangle that is closest to some point.
struct PointOnTriangle {
  double distance;
  Vec3 weights;  ///< of the corners, >= 0, together 1 up to rounding; exactly 0 for corners that have no part in it
};
/// It depends on nothing but its arguments, to the bit, and not on their place: a common offset that is exact changes
/// nothing. Promise as for closest_points() of triangles, but distances may be 0 where the point is as good as on it.
PointOnTriangle closest_on(const Triangle& triangle, const Vec3& point);

/// The closest points of two segments, by their parameters in [0, 1]. The distance is that of closest_points().
struct PointsOnSegments {
  double distance;
  double s, t;
};
PointsOnSegments closest_on(const Segment& a, const Segment& b);

/// The corner that follows each corner of a triangle.
inline constexpr std::array<std::size_t, 3> next_corner{1, 2, 0};

/// Lexicographic order of coordinates. Points on a line are in this order along the line, in one of its two directions.
inline bool lexicographically_less(const Vec3& a, const Vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// A coordinate axis along which the projection of three points has a non-zero area; none if and only if the points are
/// collinear. The projection along that axis maps their plane one to one, so it shows areas of other points of it too.
inline std::optional<std::size_t> faithful_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (geometry::orient2d(a, b, c, axis) != 0) return axis;
  }
  return {};
}

inline bool are_collinear(const Vec3& a, const Vec3& b, const Vec3& c) { return !faithful_axis(a, b, c); }

}  // namespace limber::geometry
