// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "limber/math.h"

/// Primitives: closest points, exact intersection, enclosing spheres.
///
/// Everywhere in this header: points, segments and triangles are closed sets; a triangle may be degenerate to a segment
/// or a point and means the convex hull of its corners. All functions are pure, reentrant, cost O(1) and do not
/// allocate; none depends on the caller's floating-point environment.
namespace limber {

struct Sphere {
  Vec3 center;
  double radius = 0;
};

struct Segment {
  Vec3 p0, p1;
};

struct Triangle {
  Vec3 v0, v1, v2;
  constexpr const Vec3& operator[](std::size_t i) const { return i == 0 ? v0 : i == 1 ? v1 : v2; }
};

/// An axis-aligned box: the points p with low <= p <= high in each coordinate.
struct Box {
  Vec3 low, high;
};

/// Two points and the distance between the sets they lie on.
struct [[nodiscard]] ClosestPoints {
  double distance = 0;
  Vec3 point_a, point_b;
};

/// A part of a triangle.
enum class FeatureKind : std::uint8_t { vertex, edge, face };

/// The vertex, edge or face of a triangle that a closest point lies on.
struct Feature {
  FeatureKind kind = FeatureKind::face;
  std::uint8_t index = 0;  ///< vertex i is corner i, edge i goes from corner i to the next one; 0 for the face
  friend bool operator==(const Feature&, const Feature&) = default;
};

/// The closest points of two triangles, the features that they lie on, and their weights.
struct [[nodiscard]] ClosestFeatures {
  double distance = 0;
  Vec3 point_a, point_b;
  Feature feature_a, feature_b;
  /// Barycentric weights of the points, by corner of their triangles: >= 0, together 1 up to rounding; exactly 0
  /// for the corners that the feature does not have, and above 0 for the others.
  Vec3 weights_a, weights_b;
};

/// Which of two triangles has an outside: the side that it is seen from with its corners counter-clockwise.
enum class OrientedFaces : std::uint8_t {
  none,  ///< neither
  of_a,  ///< the first alone
  of_b,  ///< the second alone
  both,  ///< each of them
};

/// How a normal from a to b lies to the outsides of their faces.
enum class NormalSide : std::uint8_t {
  unknown,  ///< neither triangle has an outside, or their faces do not tell
  outward,  ///< out of a and into b, of those that have an outside; up to rounding it may lie in a face
  inward,   ///< into a, or out of b: the triangles are apart, and one looks at the back of the other; of bodies with a
            ///< radius also if they meet, and the core of one is behind the other
};

/// Two triangles that intersect or are close, as a solver of contact constraints wants to know them.
struct [[nodiscard]] TriangleContact {
  double distance = 0;    ///< 0 exactly when the triangles intersect; of bodies with a radius, when these meet
  double depth = 0;       ///< 0 unless they do: the least overlap of the two triangles, a motion of b that parts them
  Vec3 point_a, point_b;  ///< closest points; one and the same where the triangles intersect
  Vec3 normal;            ///< of length 1, from a to b
  Vec3 weights_a, weights_b;  ///< of the points, by corner, as in ClosestFeatures
  Feature feature_a, feature_b;
  NormalSide normal_side = NormalSide::unknown;  ///< whether the normal points the way that parts bodies
};

/// On which side of the plane through (a, b, c) the point d lies, exact: +1 on the side that the normal
/// (b - a) x (c - a) points to, -1 on the other, 0 when the four points are coplanar.
///
/// Throws   std::invalid_argument if a coordinate is not finite.
/// Promise  The sign of the exact determinant; no rounding, underflow or overflow can change it. It is that of CGAL's
///          orientation(), and the opposite of what Shewchuk's function of this name returns.
/// Source   [Shewchuk1997]; docs/algorithms/intersection.md.
LIMBER_API int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the area of (a, b, c) after dropping coordinate `axis`, exact: +1 when counter-clockwise, 0 when collinear.
///
/// The kept coordinates are taken in the order (y, z), (z, x), (x, y) for axis 0, 1, 2.
/// Throws   std::invalid_argument if a coordinate is not finite, or axis is above 2.
LIMBER_API int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis);

/// Whether two closed triangles share a point, decided exactly for the float64 coordinates given.
///
/// Touching is intersecting; coplanar, segment-like and point-like triangles are decided exactly too.
/// Throws   std::invalid_argument if a coordinate is not finite.
/// Source   docs/algorithms/intersection.md; compare [GuigueDevillers2003].
LIMBER_API bool intersects(const Triangle& a, const Triangle& b);

/// Whether a closed segment and a closed triangle share a point, decided exactly.
///
/// Throws   As above.
LIMBER_API bool intersects(const Segment& segment, const Triangle& triangle);

/// Closest points of two segments; either may be a point.
///
/// Promise  The distance is within 2^-50 of the extent of the true one, where the extent is the largest coordinate of
///          an end relative to a.p0.
/// Throws   std::invalid_argument if a coordinate is not finite, or above `max_coordinate` in size.
LIMBER_API ClosestPoints closest_points(const Segment& a, const Segment& b);

/// Closest points of a point and a triangle; the triangle may be degenerate. Throws as above.
LIMBER_API ClosestPoints closest_points(const Vec3& point, const Triangle& triangle);

/// Closest points of two triangles; either may be degenerate.
///
/// Promise  distance == 0 exactly when intersects(a, b); then both points are the same point, which lies on both
///          triangles up to rounding, and up to 2^-26 of the extent if one is a sliver. Otherwise distance > 0, within
///          2^-50 of the extent of the true one, and at least 2^-1022. The extent is the largest coordinate of a corner
///          relative to a.v0.
/// Throws   std::invalid_argument if a coordinate is not finite, or above `max_coordinate` in size.
/// Source   docs/algorithms/triangle_distance.md, docs/algorithms/numerics.md.
LIMBER_API ClosestPoints closest_points(const Triangle& a, const Triangle& b);

/// Closest points of two triangles, the features that they lie on, and their weights.
///
/// Promise  Distance and points are those of closest_points(), to the bit. The corners of a times weights_a give
///          point_a, those of b times weights_b give point_b.
///          Apart: each point lies inside its feature, and the distance of the two features is `distance`. The pair is
///          two vertices, a vertex and an edge, two edges, or a vertex and a face.
///          Intersecting: the shared point lies on both features, and at most one of them is a face.
///          All this holds up to twice the rounding of the points. A degenerate triangle may have several features in
///          one place; any of them is named, but none of length 0 that is not a vertex.
/// Throws   As closest_points().
/// Source   docs/algorithms/triangle_distance.md.
LIMBER_API ClosestFeatures closest_features(const Triangle& a, const Triangle& b);

/// What keeps two triangles apart, or would part them: closest features, normal and depth.
///
/// Promise  Distance, points, features and weights are those of closest_features(). The normal has length 1 within
///          2^-50, for every input.
///          Apart: the normal is the direction from point_a to point_b, but for what rounding these has changed. It
///          differs from the true direction by no more than 2^-24 times the root of (extent / true distance), and the
///          triangles do not overlap along it by more than 2^-48 of the extent. The true distance may be less than
///          2^-1022, which `distance` never is.
///          Intersecting: the normal is that normal of a face, or common perpendicular of two edges, along which the
///          triangles overlap least. `depth` is that overlap rounded up: once b has moved by depth + 2^-1000 (1 +
///          extent) along the normal, none of its points is behind a point of a, in exact arithmetic. `depth` exceeds
///          the least overlap by at most 2^-47 of the extent; if one is a sliver, by at most 2^-24. Coplanar triangles
///          get the normal of their plane, which rounding turns where they are slivers; collinear ones a perpendicular,
///          points at one place the z axis.
///          Swapping a and b negates the normal: to the bit if they intersect, unless their corners are equal in
///          order, so that the swap changes nothing; if they are apart, each normal is within the above error.
/// Throws   As closest_points().
/// Cost     That of closest_points(), or twice that much if the triangles intersect.
/// Source   docs/algorithms/triangle_distance.md; separating axes, [Ericson2005] 5.2.1.
LIMBER_API TriangleContact contact(const Triangle& a, const Triangle& b);

/// What keeps two triangles apart, or would part them, where one or both belong to the surface of a body.
///
/// Promise  As above, with these differences. Apart: `normal_side` says whether the normal agrees with the outsides.
///          Intersecting: the normal takes the side of the outsides, and `normal_side` is `outward`. With unit normals
///          n_a and n_b of the faces, it has the direction of n_a - n_b, which turns to -n_b where a hardly reaches
///          behind b, and to n_a where b hardly reaches behind a: by less than a 32nd of the longest edge of the
///          smaller one. If only a has an outside, it has that of n_a + (n_a . n_b) n_b; if only b has, of the negative
///          of n_b + (n_a . n_b) n_a: within 20 degrees of n_a, or of -n_b. `depth` is that without outsides, the least
///          overlap there is: to move b by it parts the triangles, but in another direction than this normal. Where
///          both have an outside, and n_a and n_b are within 30 degrees of each other, or all triangles that have one
///          are degenerate or nearly so, the answer is that without outsides. A sliver lower than 10^-9 of its longest
///          edge may be taken as either. Swapping a and b, and with them what has an outside, negates the normal as
///          above.
/// Throws   As closest_points().
/// Cost     As above.
/// Source   docs/algorithms/triangle_distance.md, "Outsides".
LIMBER_API TriangleContact contact(const Triangle& a, const Triangle& b, OrientedFaces oriented);

}  // namespace limber
