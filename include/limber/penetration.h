// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "limber/distance.h"
#include "limber/math.h"
#include "limber/points.h"

/// How deep two bodies are in each other, and how they come apart. A body is a closed surface with its inside, as
/// ClosedSurface says. Bodies are apart if they have no common point: their surfaces do not meet, and none is inside of
/// the other. All answers are about bodies, not about pairs of triangles: refining the meshes changes them only as far
/// as it changes the bodies.
///
/// Frame    World: the one that both poses map to.
namespace limber {

/// The vertex of a body that is deepest inside of another one.
struct DeepestVertex {
  VertexId vertex = no_id;
  double depth = 0;  ///< its distance from the surface of the other body
  Vec3 position;
  SurfacePoint closest;  ///< the point of that surface that is closest to it
  /// The shortest way out, of length 1: from the position to the closest point. Where float64 hardly tells these apart,
  /// the normal of the closest triangle, on the side from which its corners run counter-clockwise.
  Vec3 direction;
};

/// Of each of two bodies, the vertex that is deepest inside of the other one.
struct DeepestPair {
  std::optional<DeepestVertex> of_a;  ///< the vertex of a that is deepest in b; none if b contains no vertex of a
  std::optional<DeepestVertex> of_b;  ///< the vertex of b that is deepest in a
  double max_depth = 0;  ///< no vertex of either is deeper in the other: the larger depth, unless the budget was spent
};

/// The deepest vertices of two bodies, and how the search for them ended.
struct [[nodiscard]] DeepestVertices : DeepestPair {
  StoppedBy stopped_by = StoppedBy::nothing;
  QueryStats stats{};
};

/// The deepest vertices of two bodies. Vertices that no triangle uses do not count.
///
/// Promise  The answer is that of ClosedSurface::signed_distance() for each vertex, to the bit; of vertices that are
///          equally deep, the one with the lowest id. Bodies may meet although no vertex of either is in the other.
/// Throws   std::invalid_argument unless both models are committed and both poses are rigid, and if a model was reset()
///          after its surface was made; std::bad_alloc.
/// Cost     In practice 50 to 300 signed distances for each body; one for each vertex where all are about equally deep.
///          Allocates.
/// Budget   A step asks for the signed distance of a node's center, or of the vertices of a leaf. If the budget is
///          spent, the vertices are the deepest found so far.
/// Threads  Reentrant; any number of calls may share models.
/// Source   docs/algorithms/penetration.md.
LIMBER_API DeepestVertices deepest_vertices(const PlacedSurface& a, const PlacedSurface& b,
                                            const QueryBudget& budget = {});

/// How far a body has to be moved along a direction to leave another one for good.
struct [[nodiscard]] SeparatingTranslation {
  Vec3 direction;    ///< that was asked for, of length 1
  double lower = 0;  ///< moved by this, the surfaces meet or nearly do; 0 if they do at no move from there on
  double upper = 0;  ///< moved by this or more, the bodies are apart; 0 if they are apart at every move >= 0
  /// Where they meet last: points of a and of b, which meet when b is moved by `lower`. b is where its pose says.
  std::optional<Witness> witness;
  StoppedBy stopped_by = StoppedBy::nothing;
  QueryStats stats{};
};

/// How far b has to be moved along a direction, while a rests, until it is apart from a and stays so however far it
/// goes on. Surfaces that slide along each other meet: so a box in a corner moves along a wall to its end.
///
/// Promise  true length <= upper: collide() says no for any pose of b that is moved by `upper` or more. When b is moved
///          by `lower`, points of both surfaces are at most 2^-43 of the sum of both models' largest coordinates and
///          translations apart. Where surfaces pass each other as closely as that, the true length may be below
///          `lower`; where they pass each other at a slant, `upper` exceeds it by that over the slope.
/// Throws   As deepest_vertices(), and unless the direction is finite and its length above 0.
/// Cost     A branch and bound over pairs of nodes: some ten times that of a distance. Allocates.
/// Budget   A step expands a pair of nodes, or compares two leaves. If the budget is spent, the interval still holds.
/// Threads  As deepest_vertices().
/// Source   docs/algorithms/penetration.md.
LIMBER_API SeparatingTranslation separating_translation(const PlacedSurface& a, const PlacedSurface& b,
                                                        const Vec3& direction, const QueryBudget& budget = {});

struct SolidDistanceOptions {
  /// The search for a shorter translation ends when upper <= (1 + relative_error) lower; finite and >= 0.
  double relative_error = 0.01;
  /// Steps of distance(), and all others together, may each be so many: of deepest_vertices() and
  /// separating_translation(), contacts, and balls.
  QueryBudget budget = {};
};

/// The signed distance of two bodies: their distance if they are apart, otherwise minus the length of the shortest
/// translation of b that makes them so.
struct [[nodiscard]] SolidDistance {
  double lower = 0, upper = 0;  ///< an interval that holds the signed distance
  Vec3 translation;             ///< moved by it, b is apart from a: as long as -lower; 0 if they are known to be apart
  std::optional<Witness> witness;  ///< the closest points, if the bodies are apart
  DeepestPair deepest;             ///< the vertices of each that are deepest in the other
  StoppedBy stopped_by = StoppedBy::nothing;
  QueryStats stats{};

  bool are_apart() const { return lower > 0; }
};

/// The signed distance of two bodies.
///
/// Promise  lower <= signed distance <= upper, up to the rounding of distances (distance.h). Apart, both are the
///          distance. Otherwise
///          upper   is minus a lower bound of the translation: a ball about a common point in a, and one in b, have to
///                  come apart, so their radii count together. The depth of each vertex is such a bound, too.
///          lower   is minus the length of `translation`. For b moved by it, collide() says no, and neither body is in
///                  the other. The shortest translation of two bodies that are not convex is a problem that no local
///                  search solves, so this one need not be the shortest.
///          Where bodies only touch, `upper` is 0; `lower` may be far below, as for a key in its lock.
/// Throws   As deepest_vertices(), and unless the relative error is what its comment says.
/// Cost     That of a distance and of deepest vertices, if the bodies are apart. Otherwise that of some 20 to 100
///          separating translations, fewer if the interval is soon small enough. Allocates.
/// Budget   If it is spent, the interval still holds. A deadline is overrun by a step: by some ms where all of one
///          surface is about equally far from a point.
/// Threads  As deepest_vertices().
/// Source   docs/algorithms/penetration.md.
LIMBER_API SolidDistance signed_distance(const PlacedSurface& a, const PlacedSurface& b,
                                         const SolidDistanceOptions& options = {});

}  // namespace limber
