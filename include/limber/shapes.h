// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "limber/base.h"
#include "limber/math.h"
#include "limber/model.h"

/// Shapes: what is simpler as a few numbers than as a mesh. A shape is a small model, its core, and a radius: all
/// points that are at most the radius from the core belong to it. So a sphere is a point with a radius, and a capsule
/// is a segment.
///
///   const limber::Shape hand = limber::Shape::capsule({0, 0, 0}, {0, 0, 1}, 0.25);
///   const auto near = limber::distance({cloth}, {hand, pose});
///
/// Wherever a model can be Placed, so can a shape; a few functions take none that has a radius, and say so.
///
/// Radii    The distance of two bodies is that of their triangles (distance.h) less both radii, rounded to nearest, and
///          0 where that is negative. Bodies meet if fl(distance) <= fl(radius_a + radius_b). The points of a witness
///          are those of the triangles, moved by the radii towards each other; where the bodies meet, they are one
///          point of both, which divides the way between those of the triangles as the radii do.
/// Solids   What lies inside of a solid (ClosedSurface::solid(), or a shape that is one) meets it, decided exactly for
///          the triangles. The witness is then a vertex that is inside, and names triangle 0 of the solid. A budget
///          that ends a query before this is decided leaves `lower` at 0; the next query with the cache begins this
///          search anew, and each of its steps takes as long as a closest point.
namespace limber {

/// A shape. It does not change.
///
/// Frame    The shape's own. A pose places it, as it does a model.
/// Throws   Factories throw std::invalid_argument unless all lengths, coordinates and radii are finite, at most
///          `max_coordinate` in size and, where they are sizes, >= 0; also std::bad_alloc.
/// Moved    A shape that has been moved from may be destroyed and assigned to. Bodies that were made of it stay
///          valid, as long as the shape that it was moved to lives.
/// Threads  Const functions, queries included, may run concurrently on one shape.
class [[nodiscard]] Shape {
 public:
  /// A ball around the origin.
  LIMBER_API static Shape sphere(double radius);
  /// All points at most `radius` from a segment.
  LIMBER_API static Shape capsule(const Vec3& start, const Vec3& end, double radius);
  /// A solid box around the origin. With a radius, all points that are at most that far from it: a larger box with
  /// round edges.
  LIMBER_API static Shape box(const Vec3& half_extents, double radius = 0);
  /// A solid cylinder: all points at most `radius` from a segment, between the planes across its ends. It is
  /// approximated by the prism around it with the fewest sides whose points are at most `max_error` from it, but for
  /// rounding: some 2^-46 of the largest coordinate. So no collision is missed, and the distance may be too small by
  /// deviation().
  ///
  /// Throws   Also unless the segment is longer than 0, radius and max_error are above 0, and 65 536 sides suffice.
  LIMBER_API static Shape cylinder(const Vec3& start, const Vec3& end, double radius, double max_error);
  /// All points p with dot(normal, p) <= offset, where the normal is first scaled to length 1. It is cut to a solid
  /// cube, whose face in the plane is a square around the point nearest to the origin, with sides of 2 * `half_extent`.
  /// Rounding moves the plane by about 2^-51 of half_extent and offset, so these should not be much larger than the
  /// scene. Default errors of limber/path.h are parts of the size of the bodies: give an error there.
  ///
  /// Throws   Also unless the normal is not 0, and half_extent is above 0.
  LIMBER_API static Shape half_space(const Vec3& normal, double offset, double half_extent);

  /// The convex hull of some points, a solid; or a flat polygon, a segment or a point, where the points leave no more.
  /// With a radius, all points that are at most that far from it.
  ///
  /// Promise  Exactly the hull: no point is outside of it, and its corners are points. Points on its surface may be
  ///          corners of its triangles.
  /// Throws   Also unless there is a point.
  /// Cost     O(n h) for h triangles of the hull, so O(n^2) at worst.
  LIMBER_API static Shape convex_hull(std::span<const Vec3> points, double radius = 0);
  /// A surface over a grid in the x-y plane: the height at (column * step_x, row * step_y) is
  /// heights[row * columns + column]. Squares are cut from their corner of least column and row. It is a surface, with
  /// nothing below.
  ///
  /// Throws   Also unless there are at least two columns and rows, as many heights as both say, and steps above 0.
  LIMBER_API static Shape height_field(std::span<const double> heights, std::size_t columns, std::size_t rows,
                                       double step_x, double step_y, double radius = 0);
  /// All points at most `radius` from one of some points: balls of one size. Triangle i is point i.
  ///
  /// Throws   Also unless there is a point.
  LIMBER_API static Shape point_cloud(std::span<const Vec3> points, double radius);

  /// The core. Its triangles are those that witnesses and contacts name.
  const Model& model() const { return *model_; }
  /// How far points of the shape are from the core at most, but for the inside of solids.
  double radius() const { return radius_; }
  /// Whether the core's surface is closed, and what it encloses belongs to the shape.
  bool is_solid() const { return is_solid_; }
  /// At most how far points of the shape are from what the factory describes, which is inside of it: the true distance
  /// is between `lower` and `upper + deviation()`, up to rounding. Of two cylinders, both count. 0 for all other
  /// shapes; a half-space is cut, as it says.
  double deviation() const { return deviation_; }

 private:
  friend struct Access;  // for the library's own use
  Shape(Mesh core, double radius, bool is_solid, bool is_convex, double deviation = 0);

  std::unique_ptr<const Model> model_;
  std::shared_ptr<const model::ConvexParts> parts_;  // of a shape that is convex
  double radius_, deviation_;
  bool is_solid_;
};

}  // namespace limber
