// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/math.h"
#include "limber/query.h"
#include "query/placed_leaf.h"
#include "simd/kernels.h"

namespace limber::query {

/// What a goal has learnt from a pair of triangles.
struct Improvement {
  double distance;        ///< of the pair; ties with it may be pruned if it equals prune_distance
  double prune_distance;  ///< pairs at least that far apart no longer matter; infinite if nothing new can be pruned
  Vec3 separation;        ///< from the closest point of a to that of b
};

/// A goal says what a query looks for. The traversal offers it pairs of triangles, and prunes by what it learns.
///
/// Needs    static constexpr bool takes_any;
///          static constexpr bool needs_all;
///          static constexpr bool is_self;
///          double initial_prune_distance() const;
///          bool is_done() const;
///          std::optional<Improvement> compare(const PlacedTriangle& a, const PlacedTriangle& b);
///
/// takes_any: whether any pair will do; if not, close pairs are taken first. needs_all: whether every
/// pair within the prune distance matters, and not just the best; such a goal is offered each pair once, and cannot use
/// a front. is_self: whether the two models are one; then needs_all too, and pairs of different triangles are offered,
/// but for neighbors that certainly meet only in what they share; the pair of a QueryCache is offered once more.
/// initial_prune_distance(): above 0. is_done(): whether no other pair can matter. compare(): nullopt if the pair
/// changes nothing that the traversal could use.
///
/// See      docs/design/adding_a_query.md.

/// Two leaves that are not pruned, as the kernels take them.
struct LeafPair {
  simd::OtherNode node_a, node_b;
  const bvh::Leaf &a, &b;
  const simd::FrameTransform& transform;  ///< to the frame of a
  const simd::PruneLimits& pruning;       ///< in the frame of a
};

/// A goal that is offered pairs of leaves instead of pairs of triangles. It needs all; of one model it is also offered
/// each leaf with itself.
///
/// Needs    instead of compare(): static constexpr bool compares_leaves = true;
///          void compare_leaves(const LeafPair& pair, QueryStats& stats);
template <typename Goal>
concept ComparesLeaves = requires {
  requires Goal::compares_leaves && Goal::needs_all;
};

/// A goal that takes points of which it is only known how far apart they are.
///
/// Needs    double good_enough(double lower) const;
///          std::optional<Improvement> take(double distance, const Witness& points);
///
/// good_enough(): up to which distance points end the query, if everything is at least `lower` apart.
template <typename Goal>
concept TakesPoints = requires(Goal& goal) {
  goal.take(0.0, Witness{});
};

}  // namespace limber::query
