// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/distance.h"
#include "limber/math.h"
#include "pair/placed_leaf.h"
#include "simd/kernels.h"

namespace limber::pair {

// A collector says what a query looks for. A traversal offers it pairs of triangles, and prunes by what it learns.
//
// Needs    static constexpr Hits hits;
//          static constexpr bool is_self;
//          double initial_cutoff() const;
//          bool is_done() const;
//          compare(const PlacedTriangle& a, const PlacedTriangle& b);
//
// One of all hits may have finish(), which is called after the last pair: compare() may then wait for more pairs, to
// look at them together.
//
// One of the closest pair needs also, for a contact that was found without a distance, and for searches of one tree:
//          std::optional<BoundUpdate> take(double distance, const Witness& points);
//          double close_enough() const;
//
// hits: AllPairs offers a collector of all hits each pair within the cutoff once. BestFirst is for the others; a front
// is for `any` and `closest` alone. is_self: whether the two models are one; then `all` or `k_closest`, and pairs of
// different triangles are offered, but for neighbors that certainly meet only in what they share; the pair of a
// QueryCache is offered once more. initial_cutoff(): above 0. is_done(): whether no other pair can matter.
// close_enough(): a pair at most that far apart is all that is looked for. compare(): returns
// std::optional<BoundUpdate>, nullopt if the pair changes nothing that the traversal could use; nothing for a collector
// of all hits.
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
