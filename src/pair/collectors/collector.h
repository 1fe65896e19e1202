// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/distance.h"
#include "limber/math.h"
#include "pair/placed_leaf.h"
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

}  // namespace limber::pair
