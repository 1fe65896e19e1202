// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/check.h"
#include "geometry/primitives.h"
#include "limber/distance.h"
#include "limber/math.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"

namespace limber::pair {

// A collector says what a query looks for. A walk offers it pairs of triangles, and prunes by what it learns.
//
//   it has                             who asks          what it means
//   ---------------------------------  ----------------  ------------------------------------------------------------
//   static constexpr Hits hits         walk, search.h    which pairs: `all` makes AllPairs walk, the others BestFirst
//   static constexpr bool is_self      walk, search.h    the two models are one; then `all` or `k_closest`. Pairs of
//                                                        different triangles are offered, but for neighbors that
//                                                        certainly meet only in what they share
//   double initial_cutoff()            search.h          above 0: pairs at least that far apart never matter
//   bool is_done()                     walk              whether no other pair can matter
//   compare(const PlacedTriangle& a,   leaf comparison   looks at a pair. `all`: each pair within the cutoff once, and
//           const PlacedTriangle& b)                     returns nothing. Others return std::optional<BoundUpdate>,
//                                                        nullopt if the pair changes nothing that the walk could use;
//                                                        a pair may come again: that of a QueryCache, or of a budget
//   of `all`, if it has them:
//   finish()                           AllPairs          after the last pair: compare() may wait for more pairs, to
//                                                        look at them together
//   compares_leaves,                   leaf comparison   it is offered leaves instead of triangles: ComparesLeaves
//   compare_leaves(pair, stats)
//   of `closest`:
//   take(double distance,              leaf comparison   as compare(), for a contact that was found without a distance
//        const Witness& points)
//   double close_enough()              search_by_point   a pair at most that far apart is all that is looked for
//
// See      docs/design/adding_a_query.md.

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Which pairs of triangles a query looks for.
enum class Hits {
  any,        ///< one that counts
  closest,    ///< the best one
  k_closest,  ///< the best ones, or the best of those that count: triangles that coincide are told apart
  all         ///< every one that counts
};

/// What a collector has learnt from a pair of triangles.
struct BoundUpdate {
  double distance;  ///< of the pair; if it equals `cutoff`, pairs as far apart up to rounding may be pruned
  double cutoff;    ///< pairs at least that far apart no longer matter; infinite if nothing new can be pruned
  Vec3 separation;  ///< from the closest point of a to that of b
};

/// Two leaves that are not pruned, as the kernels take them.
struct LeafPair {
  simd::SlotRef node_a, node_b;
  const bvh::Leaf &a, &b;
  const simd::FrameTransform& transform;  ///< to the frame of a
  const simd::PruneLimits& pruning;       ///< in the frame of a
};

/// A collector of all hits that is offered pairs of leaves instead of pairs of triangles. Of one model it is also
/// offered each leaf with itself.
///
/// Needs    instead of compare(): static constexpr bool compares_leaves = true;
///          void compare_leaves(const LeafPair& pair, QueryStats& stats);
template <typename Collector>
concept ComparesLeaves = requires {
  requires Collector::compares_leaves && Collector::hits == Hits::all;
};

/// The collector of collide(): any pair of triangles that intersects.
class AnyContact {
 public:
  static constexpr Hits hits = Hits::any;
  static constexpr bool is_self = false;

  double initial_cutoff() const { return std::numeric_limits<double>::min(); }
  bool is_done() const { return witness.has_value(); }

  std::optional<BoundUpdate> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (geometry::intersects(a.corners, b.corners)) {
      const Vec3 shared = geometry::shared_point(a.corners, b.corners);
      witness = Witness{shared, shared, a.id, b.id};
    }
    return std::nullopt;
  }

  std::optional<Witness> witness;
};

/// The collector of distance() and within(): the closest pair of triangles, or one that is close enough.
class ClosestPair {
 public:
  static constexpr Hits hits = Hits::closest;
  static constexpr bool is_self = false;

  /// A pair at most `close_enough` apart ends the query. Errors are those of the distance less the radius; they prune
  /// no pair that is at most the radius apart.
  ClosestPair(const DistanceOptions& options, double close_enough, double radius = 0)
      : options_(options), close_enough_(close_enough), radius_(radius) {
    LIMBER_ASSERT(radius >= 0 && radius <= close_enough);
  }

  /// Just above the limit: a pair exactly max_distance apart is an answer.
  double initial_cutoff() const { return std::nextafter(options_.max_distance, infinity); }
  double close_enough() const { return close_enough_; }
  bool is_done() const { return upper <= close_enough_; }

  std::optional<BoundUpdate> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    const ClosestPoints closest = geometry::closest_points(a.corners, b.corners);
    LIMBER_ASSERT(closest.distance >= 0);
    return take(closest.distance, {closest.point_a, closest.point_b, a.id, b.id});
  }

  /// Two points that are so far apart.
  std::optional<BoundUpdate> take(double distance, const Witness& points) {
    if (distance >= upper) return std::nullopt;
    upper = distance;
    witness = points;
    BoundUpdate update{upper, infinity, points.point_b - points.point_a};
    // A pair beyond the limit is no answer, so nothing may be pruned for its sake.
    if (upper <= options_.max_distance) {
      const double gap = upper - radius_, relative = gap / (1 + options_.relative_error) * down_factor();
      const double wanted = std::min(relative, gap - options_.absolute_error);
      update.cutoff = wanted == gap ? upper : std::max(radius_ + wanted, least_cutoff());
    }
    return update;
  }

  double upper = infinity;
  std::optional<Witness> witness;

 private:
  double least_cutoff() const { return radius_ > 0 ? std::nextafter(radius_, infinity) : -infinity; }
  double down_factor() const { return options_.relative_error == 0 ? 1 : 1 - 0x1p-51; }

  DistanceOptions options_;
  double close_enough_, radius_;
};

}  // namespace limber::pair
