// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/contacts.h"

#include <limits>
#include <vector>

#include "bindings.h"
#include "limber/distance.h"
#include "limber/gradients.h"
#include "limber/model.h"

namespace limber::web {
namespace {

PairOptions options_from(bool has_filter, const NeighborRings* rings) {
  if (rings != nullptr) return {.filter = *rings};
  if (has_filter) return {.filter = ask_filter};
  return {};
}

PairOptions options_from(bool has_filter, const NeighborRings* rings, int oriented_faces) {
  PairOptions options = options_from(has_filter, rings);
  options.oriented_faces = oriented_faces_from(oriented_faces);
  return options;
}

ClosestPairsOptions closest_options_from(double max_distance, bool has_filter, const NeighborRings* rings,
                                         int oriented_faces) {
  const PairOptions options = options_from(has_filter, rings, oriented_faces);
  return {.max_distance = max_distance, .filter = options.filter, .oriented_faces = options.oriented_faces};
}

std::vector<TrianglePair> pairs;
std::vector<Contact> contacts_found;
Columns columns;

void give_pairs(const PairCount& count) {
  give_bytes(pairs.data(), pairs.size() * sizeof(TrianglePair));
  give_count(pairs.size(), count.is_complete, count.stats);
}

/// Makes room for `count` contacts, and leaves the closest there.
template <typename Find>
void give_closest(double count, double most_pairs, const Find& find) {
  contacts_found.resize(static_cast<std::size_t>(std::min(count, most_pairs)));
  const PairCount found = find(std::span(contacts_found));
  contacts_found.resize(found.count);
  give_contacts(contacts_found, found);
}

double triangles_of(const Model& model) { return static_cast<double>(model.mesh().triangles().size()); }

}  // namespace

std::optional<OrientedFaces> oriented_faces_from(int number) {
  return number < 0 ? std::nullopt : std::optional(static_cast<OrientedFaces>(number));
}

void give_contacts(std::span<const Contact> contacts, const PairCount& count) {
  const std::size_t n = contacts.size();
  columns.begin(17 * n, 2 * n, 5 * n);
  for (const Contact& c : contacts) *columns.number++ = c.distance;
  for (const Contact& c : contacts) *columns.number++ = c.depth;
  for (const auto part :
       {&Contact::point_a, &Contact::point_b, &Contact::normal, &Contact::weights_a, &Contact::weights_b}) {
    for (const Contact& c : contacts) put(columns.number, c.*part);
  }
  for (const Contact& c : contacts) *columns.id++ = c.triangle_a;
  for (const Contact& c : contacts) *columns.id++ = c.triangle_b;
  for (const auto feature : {&Contact::feature_a, &Contact::feature_b}) {
    for (const Contact& c : contacts) {
      *columns.byte++ = static_cast<std::uint8_t>((c.*feature).kind), *columns.byte++ = (c.*feature).index;
    }
  }
  for (const Contact& c : contacts) *columns.byte++ = static_cast<std::uint8_t>(c.normal_side);
  give_count(n, count.is_complete, count.stats);
}

LIMBER_EXPORT(newCache) QueryCache* new_cache() {
  QueryCache* cache = nullptr;
  guarded([&] { cache = new QueryCache; });
  return cache;
}
LIMBER_EXPORT(deleteCache) void delete_cache(QueryCache* cache) { delete cache; }
LIMBER_EXPORT(clearCache) void clear_cache(QueryCache* cache) { cache->clear(); }

LIMBER_EXPORT(distance)
bool exported_distance(const BodyOwner* a, PoseForm pose_a, const BodyOwner* b, PoseForm pose_b, double relative_error,
                       double absolute_error, double max_distance, double deadline_ms, double max_steps,
                       QueryCache* cache) {
  return guarded([&] {
    const Placed placed_a(a->body(), pose_from(pose_a, 0, "poseA")), placed_b(b->body(), pose_from(pose_b, 1, "poseB"));
    give(distance(placed_a, placed_b,
                  {relative_error, absolute_error, max_distance, cache, budget_from(deadline_ms, max_steps)}));
  });
}

LIMBER_EXPORT(collide)
bool exported_collide(const BodyOwner* a, PoseForm pose_a, const BodyOwner* b, PoseForm pose_b, double deadline_ms,
                      double max_steps, QueryCache* cache) {
  return guarded([&] {
    const Placed placed_a(a->body(), pose_from(pose_a, 0, "poseA")), placed_b(b->body(), pose_from(pose_b, 1, "poseB"));
    give(collide(placed_a, placed_b, {cache, budget_from(deadline_ms, max_steps)}));
  });
}

LIMBER_EXPORT(within)
bool exported_within(const BodyOwner* a, PoseForm pose_a, const BodyOwner* b, PoseForm pose_b, double max_distance,
                     double deadline_ms, double max_steps, QueryCache* cache) {
  return guarded([&] {
    const Placed placed_a(a->body(), pose_from(pose_a, 0, "poseA")), placed_b(b->body(), pose_from(pose_b, 1, "poseB"));
    give(within(placed_a, placed_b, max_distance, {cache, budget_from(deadline_ms, max_steps)}));
  });
}

LIMBER_EXPORT(newRings) NeighborRings* new_rings(const OwnedModel* model, double max_edges) {
  NeighborRings* rings = nullptr;
  guarded([&] {
    if (!(max_edges >= 0 && max_edges < 0x1p32)) throw std::invalid_argument("limber: maxEdges is no number of edges");
    rings = new NeighborRings(model->mesh(), static_cast<std::uint32_t>(max_edges));
  });
  return rings;
}
LIMBER_EXPORT(deleteRings) void delete_rings(NeighborRings* rings) { delete rings; }

LIMBER_EXPORT(intersections)
bool exported_intersections(const BodyOwner* a, PoseForm pose_a, const BodyOwner* b, PoseForm pose_b, double most,
                            bool has_filter) {
  return guarded([&] {
    const Placed placed_a(a->body(), pose_from(pose_a, 0, "poseA")), placed_b(b->body(), pose_from(pose_b, 1, "poseB"));
    const auto collect = collector(pairs, most);
    give_pairs(visit_intersections(placed_a, placed_b, collect, options_from(has_filter, nullptr)));
  });
}

LIMBER_EXPORT(contacts)
bool exported_contacts(const BodyOwner* a, PoseForm pose_a, const BodyOwner* b, PoseForm pose_b, double margin,
                       double most, bool has_filter, int oriented_faces) {
  return guarded([&] {
    const Placed placed_a(a->body(), pose_from(pose_a, 0, "poseA")), placed_b(b->body(), pose_from(pose_b, 1, "poseB"));
    const auto collect = collector(contacts_found, most);
    const PairOptions options = options_from(has_filter, nullptr, oriented_faces);
    const PairCount count = visit_contacts(placed_a, placed_b, margin, collect, options);
    give_contacts(contacts_found, count);
  });
}

LIMBER_EXPORT(closestPairs)
bool exported_closest_pairs(const BodyOwner* a, PoseForm pose_a, const BodyOwner* b, PoseForm pose_b, double count,
                            double max_distance, bool has_filter, int oriented_faces) {
  return guarded([&] {
    const Placed placed_a(a->body(), pose_from(pose_a, 0, "poseA")), placed_b(b->body(), pose_from(pose_b, 1, "poseB"));
    const ClosestPairsOptions options = closest_options_from(max_distance, has_filter, nullptr, oriented_faces);
    give_closest(count, triangles_of(placed_a.model()) * triangles_of(placed_b.model()),
                 [&](std::span<Contact> closest) { return closest_pairs(placed_a, placed_b, closest, options); });
  });
}

/// The contact of two triangles, one of each model, as the only one of many.
LIMBER_EXPORT(contactOf)
bool exported_contact_of(const BodyOwner* a, PoseForm pose_a, const BodyOwner* b, PoseForm pose_b,
                         TriangleId triangle_a, TriangleId triangle_b) {
  return guarded([&] {
    const Placed placed_a(a->body(), pose_from(pose_a, 0, "poseA")), placed_b(b->body(), pose_from(pose_b, 1, "poseB"));
    Contact contact;
    contact.triangle_a = triangle_a, contact.triangle_b = triangle_b;
    static_cast<TriangleContact&>(contact) = contact_of(placed_a, placed_b, {{}, {}, triangle_a, triangle_b});
    contacts_found.assign(1, contact);
    give_contacts(contacts_found, {});
  });
}

LIMBER_EXPORT(selfCollide)
bool exported_self_collide(const OwnedModel* model, bool has_filter, const NeighborRings* rings, QueryCache* cache) {
  return guarded([&] { give(self_collide(*model, {options_from(has_filter, rings).filter, cache})); });
}

LIMBER_EXPORT(selfDistance)
bool exported_self_distance(const OwnedModel* model, double relative_error, double absolute_error, double max_distance,
                            bool has_filter, const NeighborRings* rings, QueryCache* cache) {
  return guarded([&] {
    give(self_distance(*model,
                       {relative_error, absolute_error, max_distance, options_from(has_filter, rings).filter, cache}));
  });
}

LIMBER_EXPORT(selfIntersections)
bool exported_self_intersections(const OwnedModel* model, double most, bool has_filter, const NeighborRings* rings) {
  return guarded([&] {
    const auto collect = collector(pairs, most);
    give_pairs(visit_self_intersections(*model, collect, options_from(has_filter, rings)));
  });
}

LIMBER_EXPORT(selfContacts)
bool exported_self_contacts(const OwnedModel* model, double margin, double most, bool has_filter,
                            const NeighborRings* rings, int oriented_faces) {
  return guarded([&] {
    const auto collect = collector(contacts_found, most);
    const PairOptions options = options_from(has_filter, rings, oriented_faces);
    const PairCount count = visit_self_contacts(*model, margin, collect, options);
    give_contacts(contacts_found, count);
  });
}

LIMBER_EXPORT(selfClosestPairs)
bool exported_self_closest_pairs(const OwnedModel* model, double count, double max_distance, bool has_filter,
                                 const NeighborRings* rings, int oriented_faces) {
  return guarded([&] {
    const ClosestPairsOptions options = closest_options_from(max_distance, has_filter, rings, oriented_faces);
    give_closest(count, triangles_of(*model) * triangles_of(*model),
                 [&](std::span<Contact> closest) { return self_closest_pairs(*model, closest, options); });
  });
}

}  // namespace limber::web
