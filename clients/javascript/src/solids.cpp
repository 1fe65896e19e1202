// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/solids.h"

#include <optional>

#include "bindings.h"
#include "limber/penetration.h"
#include "limber/points.h"

namespace limber::web {
namespace {

/// Calls query(a, b), both placed, with the poses in Exchange::poses.
template <typename Query>
auto ask(const ClosedSurface* a, PoseForm pose_a, const ClosedSurface* b, PoseForm pose_b, const Query& query) {
  return query(PlacedSurface(*a, pose_from(pose_a, 0, "poseA")), PlacedSurface(*b, pose_from(pose_b, 1, "poseB")));
}

/// Where results have deepest vertices: after what give() writes, and the translation or direction.
constexpr std::size_t deepest_numbers = 13, deepest_words = 4;

/// The numbers of a deepest vertex: depth, position, distance and position of the closest point, its weights,
/// direction; its words: vertex, triangle, kind and index of the feature. If there is none, the vertex is no_id.
void put_deepest(double*& number, std::uint32_t*& word, const std::optional<DeepestVertex>& found) {
  const DeepestVertex d = found.value_or(DeepestVertex{});
  *number++ = d.depth;
  put(number, d.position);
  *number++ = d.closest.distance;
  put(number, d.closest.position);
  put(number, d.closest.weights);
  put(number, d.direction);
  *word++ = d.vertex, *word++ = d.closest.triangle;
  *word++ = static_cast<std::uint32_t>(d.closest.feature.kind), *word++ = d.closest.feature.index;
}

/// The upper bound of the depths, then the deepest vertices of a and of b.
void give_deepest(const DeepestPair& found) {
  double* number = exchange.numbers + deepest_numbers;
  std::uint32_t* word = exchange.words + deepest_words;
  *number++ = found.max_depth;
  put_deepest(number, word, found.of_a);
  put_deepest(number, word, found.of_b);
}

/// The witness and all else that results have in common, with bounds and a vector after it.
template <typename Found>
void give_bounds(const Found& found, const Vec3& vector) {
  give(found.witness, found.stats, 0, found.stopped_by);
  exchange.numbers[0] = found.lower, exchange.numbers[1] = found.upper;
  double* to = exchange.numbers + 10;
  put(to, vector);
}

}  // namespace

/// The relation is where other results have a status.
LIMBER_EXPORT(solidRelation)
bool exported_solid_relation(const ClosedSurface* a, PoseForm pose_a, const ClosedSurface* b, PoseForm pose_b) {
  return guarded([&] {
    const auto query = [](const auto&... bodies) { return solid_relation(bodies...); };
    const SolidRelationResult found = ask(a, pose_a, b, pose_b, query);
    give(found.witness, found.stats, static_cast<std::uint32_t>(found.relation), StoppedBy::nothing);
  });
}

LIMBER_EXPORT(deepestVertices)
bool exported_deepest_vertices(const ClosedSurface* a, PoseForm pose_a, const ClosedSurface* b, PoseForm pose_b,
                               double deadline_ms, double max_steps) {
  return guarded([&] {
    const DeepestVertices found = ask(a, pose_a, b, pose_b, [&](const auto&... bodies) {
      return deepest_vertices(bodies..., {budget_from(deadline_ms, max_steps)});
    });
    give(std::nullopt, found.stats, 0, found.stopped_by);
    give_deepest(found);
  });
}

LIMBER_EXPORT(separatingTranslation)
bool exported_separating_translation(const ClosedSurface* a, PoseForm pose_a, const ClosedSurface* b, PoseForm pose_b,
                                     double x, double y, double z, double deadline_ms, double max_steps) {
  return guarded([&] {
    const SeparatingTranslation found = ask(a, pose_a, b, pose_b, [&](const auto&... bodies) {
      return separating_translation(bodies..., {x, y, z}, {budget_from(deadline_ms, max_steps)});
    });
    give_bounds(found, found.direction);
  });
}

LIMBER_EXPORT(signedDistance)
bool exported_signed_distance(const ClosedSurface* a, PoseForm pose_a, const ClosedSurface* b, PoseForm pose_b,
                              double relative_error, double deadline_ms, double max_steps) {
  return guarded([&] {
    const SolidDistance found = ask(a, pose_a, b, pose_b, [&](const auto&... bodies) {
      return signed_distance(bodies..., {relative_error, budget_from(deadline_ms, max_steps)});
    });
    give_bounds(found, found.translation);
    give_deepest(found.deepest);
  });
}

}  // namespace limber::web
