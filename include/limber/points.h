// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "limber/base.h"
#include "limber/distance.h"
#include "limber/geometry.h"
#include "limber/math.h"
#include "limber/model.h"

/// Points and models: the closest point of a model, what it lies on, and whether a closed model has the point inside.
namespace limber {

struct PointOptions {
  /// Beyond this distance nothing is found; >= 0, infinity for no limit.
  double max_distance = std::numeric_limits<double>::infinity();
};

/// The point of a model that is closest to some point.
///
/// Frame    World: the one that the pose maps to.
struct SurfacePoint {
  double distance = 0;  ///< from the point that was asked for
  Vec3 position;
  TriangleId triangle = no_id;
  Vec3 weights;     ///< barycentric, of the triangle's corners: >= 0, together 1 up to rounding
  Feature feature;  ///< what the position lies on: corners with a weight of 0 have no part in it
};

struct [[nodiscard]] PointResult {
  std::optional<SurfacePoint> closest;  ///< none exactly when nothing is as close as max_distance
  QueryStats stats{};
};

/// The point of a placed model that is closest to a point of the world.
///
/// Promise  The same bits as from a loop over all triangles, whatever the tree, its history and motion margin, the
///          instruction set and the number of threads. Of triangles that are equally close, to the bit, the one with
///          the lowest id is named; of triangles whose corners are equal, in order, any may be. The model is taken as
///          placed: every vertex is moved to the world in float64 first. The distance is within 2^-50 of the extent of
///          the true one, where the extent is the largest coordinate of a corner of the triangle relative to the
///          point.
/// Throws   std::invalid_argument unless the model is committed and has no radius, its pose is rigid, the point is
///          finite and at most `max_coordinate` in size, and max_distance is >= 0 or infinite.
/// Cost     About O(log n) for points near the model. O(n) at worst, some 50 ns a triangle, where all are about equally
///          far away; so a single point has no budget. Allocates nothing.
/// Threads  Reentrant; any number of calls may share models.
/// Source   docs/algorithms/points.md.
LIMBER_API PointResult closest_point(const Placed& model, const Vec3& point, const PointOptions& options = {});

/// Answers for many points: results[i] is that of points[i] asked alone, to the bit.
///
/// Throws   std::invalid_argument as closest_point(), or if there are not as many results as points; no result has been
///          written then.
/// Cost     On the threads of the calling oneTBB arena.
LIMBER_API void closest_point_many(const Placed& model, std::span<const Vec3> points, std::span<PointResult> results,
                                   const PointOptions& options = {});

// --- inside and outside ---

struct [[nodiscard]] SignedDistance {
  bool is_inside = false;               ///< whether the surface encloses the point, or the point lies on it
  std::optional<SurfacePoint> closest;  ///< none exactly when nothing is as close as max_distance
  QueryStats stats{};

  /// Negative inside; on the surface 0, without a minus sign. Pre: `closest` is there.
  double distance() const { return is_inside && closest->distance > 0 ? -closest->distance : closest->distance; }
};

/// A model whose surface is closed and oriented, so that it has an inside: every edge, by vertex ids, belongs to
/// exactly two triangles, which run through it in opposite directions. Connectivity is fixed, so this is checked once;
/// the model may deform afterwards. Keeps a pointer: the model must outlive it, and must not be reset().
///
/// Inside   Where the winding number of the placed surface is not 0, and on the surface. So it does not matter whether
///          normals point outward. What several closed parts enclose is inside; a part within another one is a cavity
///          if it is oriented the other way.
/// Promise  Whether a point is inside is decided exactly for the placed triangles, also where the surface meets itself.
/// Threads  Const functions may run concurrently, with queries of the model too.
/// Source   docs/algorithms/points.md.
class ClosedSurface {
 public:
  /// Errors   `not_closed`, naming the edge; `where` is the first triangle that has a bad one.
  /// Cost     O(n log n).
  LIMBER_API static Result<ClosedSurface> create(const Model& model);
  static Result<ClosedSurface> create(const Model&&) = delete;  // would point to a temporary

  const Model& model() const { return *model_; }
  /// The model as a solid, for queries of two bodies: what its surface encloses collides with it.
  ///
  /// Throws   std::invalid_argument if the model has been reset().
  [[nodiscard]] Placed solid(const Transform& world_from_model = {}) const { return {Body(*this), world_from_model}; }

  /// Whether the surface, placed by world_from_model, encloses a point of the world, or the point lies on it.
  ///
  /// Throws   std::invalid_argument as closest_point(), or if the model has been reset().
  /// Cost     That of following one ray from the point out of the model; O(n) at worst. Allocates nothing.
  [[nodiscard]] LIMBER_API bool contains(const Vec3& point, const Transform& world_from_model = {}) const;

  /// How often the surface winds around a point that is not on it, counter-clockwise seen from outside: 1 inside of a
  /// surface whose normals point outward. Nothing on it.
  ///
  /// Throws   As contains().
  /// Cost     As contains().
  [[nodiscard]] LIMBER_API std::optional<int> winding_number(const Vec3& point,
                                                             const Transform& world_from_model = {}) const;

  /// closest_point() and contains().
  ///
  /// Throws   As contains(), or if max_distance is not >= 0 or infinite.
  /// Cost     That of both.
  LIMBER_API SignedDistance signed_distance(const Vec3& point, const Transform& world_from_model = {},
                                            const PointOptions& options = {}) const;
  /// Answers for many points: results[i] is that of points[i] asked alone, to the bit.
  ///
  /// Throws   As above, or if there are not as many results as points; no result has been written then.
  /// Cost     On the threads of the calling oneTBB arena.
  LIMBER_API void signed_distance_many(std::span<const Vec3> points, std::span<SignedDistance> results,
                                       const Transform& world_from_model = {}, const PointOptions& options = {}) const;

 private:
  friend struct Access;  // for the library's own use
  explicit ClosedSurface(const Model& model);
  Placed placed(const Transform& world_from_model) const;

  const Model* model_;
  std::uint32_t surface_id_;
};

/// A closed surface and where it stands, for queries of two bodies. Its model must outlive it.
struct PlacedSurface {
  PlacedSurface(const ClosedSurface& closed, const Transform& world_from_model = {})
      : surface(closed), pose(world_from_model) {}

  ClosedSurface surface;
  Transform pose;  ///< world_from_model
};

/// The generalized winding number of any placed triangles around a point of the world: the sum of the solid angles
/// under which it sees them, as a part of the whole sphere, positive where it sees their back. Around a point off a
/// closed surface it is a whole number. Around one next to an open surface, a soup or a surface with holes it tells how
/// much of its surroundings they cover, and 0.5 is the usual place to part inside from outside.
///
/// Promise  The same bits on any number of threads. Rounded, without a proven bound: what a triangle adds is off by
///          about 2^-52 of its extent over the point's distance from its edges, by more for slivers. Within rounding of
///          a triangle either of its sides may count.
/// Throws   std::invalid_argument as closest_point().
/// Cost     O(n), some 30 ns a triangle, on the threads of the calling oneTBB arena: every triangle counts.
/// Threads  As closest_point().
/// Source   [Jacobson2013] for the number, [VanOosteromStrackee1983] for the solid angle of a triangle.
[[nodiscard]] LIMBER_API double generalized_winding_number(const Placed& model, const Vec3& point);

}  // namespace limber
