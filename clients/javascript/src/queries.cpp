// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries of two bodies, of a model and itself, and of points.
#include <stdexcept>
#include <vector>

#include "bindings.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/points.h"

namespace limber::web {
namespace {

using Cache = Owned<QueryCache>;
using Rings = Owned<NeighborRings>;
using Surface = Owned<ClosedSurface>;

std::optional<TrianglePairFilter> filter_from(const NeighborRings* rings) {
  return rings != nullptr ? std::optional<TrianglePairFilter>(*rings) : std::nullopt;
}

std::vector<Contact> contacts_found;

/// Gives up to `most` contacts of those that visit(visitor) finds: behind what give_all() gives, how many there are,
/// whether they are all, and statistics.
template <typename Visit>
void give_contacts(double most, const Visit& visit) {
  contacts_found.clear();
  const PairCount count = visit([&](const Contact& contact) {
    if (static_cast<double>(contacts_found.size()) >= most) return false;  // one more tells that they are not all
    contacts_found.push_back(contact);
    return true;
  });
  give_all(std::span<const Contact>(contacts_found));
  give_numbers(exchange.numbers[0], exchange.numbers[1], contacts_found.size(), count.is_complete,
               count.stats.node_tests, count.stats.primitive_tests);
}

}  // namespace

LIMBER_EXPORT(newCache) Cache* new_cache() {
  return made([] { return new Cache; });
}
LIMBER_EXPORT(clearCache) void clear_cache(Cache* cache) { cache->clear(); }

LIMBER_EXPORT(newRings) Rings* new_rings(const OwnedModel* model, double max_edges) {
  return made([&] {
    if (!(max_edges >= 0 && max_edges < 0x1p32)) throw std::invalid_argument("limber: maxEdges is no number of edges");
    return new Rings(model->mesh(), static_cast<std::uint32_t>(max_edges));
  });
}

// --- two bodies ---

LIMBER_EXPORT(distance)
bool exported_distance(const OwnedBody* a, PoseForm pose_a, const OwnedBody* b, PoseForm pose_b, double relative_error,
                       double absolute_error, double max_distance, double deadline_ms, double max_steps, Cache* cache) {
  return guarded([&] {
    give(distance(placed_from(a, pose_a, 0), placed_from(b, pose_b, 1),
                  {relative_error, absolute_error, max_distance, cache, budget_from(deadline_ms, max_steps)}));
  });
}

LIMBER_EXPORT(collide)
bool exported_collide(const OwnedBody* a, PoseForm pose_a, const OwnedBody* b, PoseForm pose_b, double deadline_ms,
                      double max_steps, Cache* cache) {
  return guarded([&] {
    give(collide(placed_from(a, pose_a, 0), placed_from(b, pose_b, 1), {cache, budget_from(deadline_ms, max_steps)}));
  });
}

LIMBER_EXPORT(within)
bool exported_within(const OwnedBody* a, PoseForm pose_a, const OwnedBody* b, PoseForm pose_b, double max_distance,
                     double deadline_ms, double max_steps, Cache* cache) {
  return guarded([&] {
    give(within(placed_from(a, pose_a, 0), placed_from(b, pose_b, 1), max_distance,
                {cache, budget_from(deadline_ms, max_steps)}));
  });
}

LIMBER_EXPORT(contacts)
bool exported_contacts(const OwnedBody* a, PoseForm pose_a, const OwnedBody* b, PoseForm pose_b, double margin,
                       double most) {
  return guarded([&] {
    const Placed placed_a = placed_from(a, pose_a, 0), placed_b = placed_from(b, pose_b, 1);
    give_contacts(most, [&](ContactVisitor visit) { return visit_contacts(placed_a, placed_b, margin, visit); });
  });
}

// --- a model and itself ---

LIMBER_EXPORT(selfCollide) bool exported_self_collide(const OwnedModel* model, const Rings* rings, Cache* cache) {
  return guarded([&] { give(self_collide(*model, {filter_from(rings), cache})); });
}

LIMBER_EXPORT(selfDistance)
bool exported_self_distance(const OwnedModel* model, double relative_error, double absolute_error, double max_distance,
                            const Rings* rings, Cache* cache) {
  return guarded([&] {
    give(self_distance(*model, {relative_error, absolute_error, max_distance, filter_from(rings), cache}));
  });
}

LIMBER_EXPORT(selfContacts)
bool exported_self_contacts(const OwnedModel* model, double margin, double most, const Rings* rings) {
  return guarded([&] {
    const PairOptions options{.filter = filter_from(rings)};
    give_contacts(most, [&](ContactVisitor visit) { return visit_self_contacts(*model, margin, visit, options); });
  });
}

// --- points, in input() ---

LIMBER_EXPORT(closestPointMany)
bool exported_closest_point_many(const OwnedModel* model, PoseForm pose, std::size_t count, bool is_float32,
                                 double max_distance) {
  return guarded([&] {
    const std::vector<Vec3> points = points_from(count, is_float32);
    std::vector<PointResult> results(count);
    closest_point_many({model->body(), pose_from(pose, 0, "pose")}, points, results, {max_distance});
    give_all(std::span<const PointResult>(results));
  });
}

LIMBER_EXPORT(newClosedSurface) Surface* new_closed_surface(const OwnedModel* model) {
  return made([&] { return new Surface(ClosedSurface::create(*model).value()); });
}

LIMBER_EXPORT(signedDistanceMany)
bool exported_signed_distance_many(const Surface* surface, PoseForm pose, std::size_t count, bool is_float32,
                                   double max_distance) {
  return guarded([&] {
    const std::vector<Vec3> points = points_from(count, is_float32);
    std::vector<SignedDistance> results(count);
    surface->signed_distance_many(points, results, pose_from(pose, 0, "pose"), {max_distance});
    give_all(std::span<const SignedDistance>(results));
  });
}

LIMBER_EXPORT(contains) bool exported_contains(const Surface* surface, PoseForm pose, double x, double y, double z) {
  return guarded([&] { give_numbers(surface->contains({x, y, z}, pose_from(pose, 0, "pose"))); });
}

}  // namespace limber::web
