// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "limber/base.h"
#include "limber/distance.h"
#include "limber/math.h"
#include "limber/model.h"

/// Convex bodies: faster distances, and how deep two are in each other.
///
/// A body is known as convex if it is of a ConvexSurface, or a shape (shapes.h) other than a height field or a cloud of
/// points. For two such bodies collide(), within() and distance() search by supports first, unless they have a budget.
/// Yes and no stay what they are. A distance is no longer the least one to the bit: `lower` and `upper` may be wrong by
/// 2^-45 of both models' largest coordinates and translations, also if both poses are the identity.
namespace limber {

/// A model whose triangles, with what they enclose, are convex: a closed surface without a concave edge, a flat
/// polygon, a segment or a point. It is checked once. After a vertex has moved, all queries of it throw
/// std::invalid_argument, until create() has checked the model again. Keeps a pointer: the model must outlive it.
///
/// Rounded  Coordinates that were rounded leave edges a little concave. Distances, and yes and no, are those of the
///          triangles all the same; a depth is that of their convex hull.
///
/// Threads  Const functions may run concurrently, with queries of the model too.
class ConvexSurface {
 public:
  /// Takes edges, and vertices in front of a triangle's plane, that are concave by at most `max_concavity`: a length.
  /// By default it is 2^-40 of the largest coordinate; for a mesh that was stored in float32 give 10^-6 of its size.
  ///
  /// Errors   `not_convex`, naming the edge that is concave and by how much; `not_closed`, naming the edge; `where` is
  ///          the triangle.
  /// Throws   std::invalid_argument unless max_concavity is finite and >= 0.
  /// Cost     O(n log n) where an edge is concave. O(n^2) where none is: some 40 ms for 1000 vertices.
  LIMBER_API static Result<ConvexSurface> create(const Model& model,
                                                 std::optional<double> max_concavity = std::nullopt);
  static Result<ConvexSurface> create(const Model&&,
                                      std::optional<double> = {}) = delete;  // would point to a temporary

  const Model& model() const { return *model_; }
  /// Whether the surface is closed, and encloses something.
  bool is_solid() const { return is_solid_; }
  /// The model as a convex body. Keeps a pointer to this surface.
  ///
  /// Throws   std::invalid_argument if a vertex has moved since the surface was created.
  [[nodiscard]] Placed solid(const Transform& world_from_model = {}) const& { return {Body(*this), world_from_model}; }
  Placed solid(const Transform& = {}) const&& = delete;  // would point to a temporary

 private:
  friend struct Access;  // for the library's own use
  ConvexSurface(const Model& model, bool is_solid);

  const Model* model_;
  std::shared_ptr<const model::ConvexParts> parts_;
  bool is_solid_;
};

struct ConvexDepthOptions {
  /// The search ends when upper <= (1 + relative_error) lower; finite and >= 0. With 0 it ends where rounding does.
  double relative_error = 0;
};

/// How deep two convex bodies are in each other.
///
/// Frame    World: the one that both poses map to.
struct [[nodiscard]] ConvexDepth {
  double lower = 0, upper = 0;  ///< an interval that holds the depth; both 0 if the bodies are apart
  Vec3 direction;               ///< moved along it by `upper`, b is apart from a or touches it; 0 if they are apart
  /// Points of a and of b, which meet when b is moved by the depth; none if the bodies are apart.
  std::optional<Witness> witness;
  QueryStats stats{};
};

/// The length of the shortest translation of b that parts it from a, for two bodies that are known to be convex. Flat
/// ones count as what they are: two that overlap in their plane have depth 0.
///
/// Promise  lower <= depth <= upper, whatever rounding does. The gap is at most the asked error, or 2^-42 of both
///          bodies' largest coordinates, radii and translations, but for bodies with very long thin triangles or more
///          than some 100 faces equally deep. Bodies that touch may have a depth of 0, or one of that rounding.
/// Throws   std::invalid_argument unless both bodies are known to be convex, both models are committed, both poses are
///          rigid and the relative error is what its comment says.
/// Cost     Some microseconds. 30 kB of stack; allocates nothing.
/// Threads  Reentrant; any number of calls may share models.
/// Source   docs/algorithms/shapes.md.
LIMBER_API ConvexDepth convex_depth(const Placed& a, const Placed& b, const ConvexDepthOptions& options = {});

}  // namespace limber
