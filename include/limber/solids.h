// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "limber/base.h"
#include "limber/distance.h"
#include "limber/math.h"
#include "limber/points.h"
#include "limber/scene.h"

/// Solids: how the volumes of two closed surfaces lie to each other.
namespace limber {

/// How two solids lie to each other. A solid is where the winding number of its closed surface is not 0, without the
/// surface itself; so a cavity does not belong to it. Solids overlap if they have a point in common.
enum class SolidRelation {
  apart,        ///< no overlap, and the surfaces have no common point
  touching,     ///< no overlap, but the surfaces have a common point
  overlapping,  ///< overlap, and each reaches out of the other
  a_inside_b,   ///< overlap, and a does not reach out of b; the surfaces may have common points
  b_inside_a,   ///< overlap, and b does not reach out of a
  equal,        ///< overlap, and neither reaches out of the other
  undecided,    ///< the budget was spent before any of these was proven; never without a budget
};

struct SolidRelationOptions {
  /// Steps of the search for contacts of both surfaces, of each with itself, and all others together, may each be so
  /// many.
  QueryBudget budget = {};
};

struct [[nodiscard]] SolidRelationResult {
  SolidRelation relation = SolidRelation::apart;
  /// A point that both surfaces have in common, if and only if there is one: it tells a body that touches the wall
  /// around it from one that does not. If the relation is undecided, there may be one that was not found.
  std::optional<Witness> witness;
  StoppedBy stopped_by = StoppedBy::nothing;  ///< which limit, if the relation is undecided
  QueryStats stats{};
};

/// How the solids of two placed closed surfaces lie to each other.
///
/// Promise  The relation is decided exactly for the placed vertices, for all closed surfaces: also where they meet
///          themselves, where faces coincide, and where triangles are degenerate. It does not depend on the direction
///          of normals. A surface that encloses nothing overlaps nothing, so it is apart or touching.
/// Pose     Vertices are placed in float64, so a pose that turns flush faces may make them overlap, or part them.
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, and no model has been reset()
///          since its surface was created; std::bad_alloc.
/// Cost     A few contacts or points where the solids are far apart or cross; O(n log n) where they touch, coincide, or
///          one is inside the other, and one ray for each pair of triangles that cross. Allocates.
/// Budget   A step follows a ray, looks at the cut of two triangles, or at up to 64 triangles. A relation that was found
///          before the budget was spent is returned; otherwise it is `undecided`.
/// Threads  Reentrant; any number of calls may share models. Runs on the calling thread.
/// Source   docs/algorithms/solids.md.
LIMBER_API SolidRelationResult solid_relation(const PlacedSurface& a, const PlacedSurface& b,
                                              const SolidRelationOptions& options = {});

/// Answers for many pairs, which name surfaces by their index: results[i] is that of pairs[i]. If surfaces[id] is that
/// of object `id` of a Scene, the pairs may be those of Scene::candidate_pairs(). A surface that no pair names may be
/// empty.
///
/// Throws   As solid_relation(), or if there are not as many results as pairs, or a pair names no surface; no result
///          has been written then, unless memory is missing.
/// Budget   The steps of each pair count for themselves; deadline and flag are those of all.
/// Cost     On the threads of the calling oneTBB arena.
LIMBER_API void solid_relation_many(std::span<const std::optional<PlacedSurface>> surfaces,
                                    std::span<const ObjectPair> pairs, std::span<SolidRelationResult> results,
                                    const SolidRelationOptions& options = {});

}  // namespace limber
