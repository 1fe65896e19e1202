// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// All pairs of triangles and of elements, of two models and of one with itself, against brute force: in random scenes,
// on every instruction set, around common vertices and edges, on a real mesh, and while models deform.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "limber/io.h"
#include "reference/reference.h"
#include "simd/kernels.h"
#include "support/keys.h"
#include "support/random_scene.h"
#include "support/real_meshes.h"

namespace limber::testing {
namespace {

using reference::ElementPairs;

const auto ids_in_order = [](const auto& p, const auto& q) { return ids_of(p) < ids_of(q); };

template <typename Pair>
std::vector<Pair> in_order(std::vector<Pair> pairs) {
  std::sort(pairs.begin(), pairs.end(), ids_in_order);
  return pairs;
}

template <typename Pair>
bool same(const std::vector<Pair>& list, const std::vector<Pair>& other) {
  return std::equal(list.begin(), list.end(), other.begin(), other.end(),
                    [](const Pair& p, const Pair& q) { return key_of(p) == key_of(q); });
}
bool same(const ElementPairs& p, const ElementPairs& q) {
  return same(p.vertex_face, q.vertex_face) && same(p.edge_edge, q.edge_edge);
}

/// Makes a list on every instruction set; all have to be the same, order and numbers included.
template <typename List>
auto on_all_sets(const List& list) {
  simd::use_kernels(&simd::scalar_kernels);
  const auto first = list();
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::use_kernels(&set);
    EXPECT_TRUE(same(list(), first)) << set.name;
  }
  simd::use_kernels(nullptr);
  return first;
}

/// What a query of pairs of triangles visits, in its order.
template <typename Pair, typename Visit>
std::vector<Pair> visited(const Visit& visit) {
  return on_all_sets([&] {
    std::vector<Pair> pairs;
    const PairCount result = visit([&](const Pair& pair) { return pairs.push_back(pair), true; });
    EXPECT_EQ(result.count, pairs.size());
    EXPECT_TRUE(result.is_complete);
    return pairs;
  });
}

/// What a query of elements visits.
template <typename Visit>
ElementPairs visited_elements(const Visit& visit) {
  return on_all_sets([&] {
    ElementPairs found;
    const ElementPairCount count = visit([&](const VertexFacePair& p) { return found.vertex_face.push_back(p), true; },
                                         [&](const EdgeEdgePair& p) { return found.edge_edge.push_back(p), true; });
    EXPECT_EQ(count.vertex_face, found.vertex_face.size());
    EXPECT_EQ(count.edge_edge, found.edge_edge.size());
    EXPECT_TRUE(count.is_complete);
    return found;
  });
}

/// Whether the contacts within a margin are those of brute force. Pairs whose distance equals the margin up to rounding
/// may be missing or not. `truth` has all pairs within margin + rounding.
void expect_same(const std::vector<Contact>& found, const std::vector<Contact>& truth, double margin, double rounding) {
  const double slack = margin == 0 ? 0 : rounding;
  const std::vector<Contact> pairs = in_order(found);
  auto next = pairs.begin();
  for (const Contact& t : truth) {
    if (next == pairs.end() || ids_of(*next) != ids_of(t)) {
      EXPECT_GT(t.distance, margin - slack) << "a pair is missing";
      continue;
    }
    const Contact& c = *next++;
    EXPECT_LE(t.distance, margin + slack) << "a pair is too far apart";
    EXPECT_EQ(c.distance == 0, t.distance == 0);
    EXPECT_NEAR(c.distance, t.distance, rounding);
    EXPECT_NEAR(length(c.normal), 1, 1e-14);
    EXPECT_TRUE(c.normal != t.normal || c.normal_side == t.normal_side);
  }
  EXPECT_EQ(next, pairs.end()) << "pairs are wrong, or came twice";
}

/// Expects pairs of elements to be those of `truth`, numbers to the bit. `truth` has all pairs within the margin.
template <typename Pair>
void expect_same(const std::vector<Pair>& found, const std::vector<Pair>& truth, double certain) {
  const std::vector<Pair> pairs = in_order(found);
  auto next = pairs.begin();
  for (const Pair& pair : truth) {
    if (next != pairs.end() && ids_of(*next) == ids_of(pair)) {
      EXPECT_EQ(key_of(*next++), key_of(pair));
    } else {
      EXPECT_GT(pair.distance, certain) << "a pair is missing";
    }
  }
  EXPECT_EQ(next, pairs.end()) << "pairs are wrong, or came twice";
}

void expect_same(const ElementPairs& found, const ElementPairs& truth, double margin, double rounding) {
  const double certain = margin == 0 ? 0 : margin - rounding;
  expect_same(found.vertex_face, truth.vertex_face, certain);
  expect_same(found.edge_edge, truth.edge_edge, certain);
}

/// Whether the closest pairs are those of the twin, but for pairs that are equally close.
void expect_closest(const std::vector<Contact>& found, const std::vector<Contact>& truth, double rounding) {
  ASSERT_EQ(found.size(), truth.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].distance == 0, truth[k].distance == 0) << k;
    EXPECT_NEAR(found[k].distance, truth[k].distance, rounding) << k;
    EXPECT_TRUE(k == 0 || found[k - 1].distance <= found[k].distance) << k;
  }
  const std::vector<Contact> pairs = in_order(found);
  const auto same_ids = [](const Contact& c, const Contact& d) { return ids_of(c) == ids_of(d); };
  EXPECT_EQ(std::adjacent_find(pairs.begin(), pairs.end(), same_ids), pairs.end()) << "a pair came twice";
}

/// A distance that tells the pairs before it, which are sorted, from those behind it, whatever their rounding.
double between_distances(const std::vector<Contact>& sorted, Rng& rng, double rounding) {
  const std::size_t k = rng.below(sorted.size() + 1);
  const double below = k == 0 ? 0 : sorted[k - 1].distance,
               above = k == sorted.size() ? 2 * below + 1 : sorted[k].distance;
  return above - below > 4 * rounding ? 0.5 * (below + above) : std::numeric_limits<double>::infinity();
}

std::vector<Contact> up_to(double max_distance, std::vector<Contact> sorted) {
  const auto is_near = [&](const Contact& c) { return c.distance <= max_distance; };
  sorted.erase(std::partition_point(sorted.begin(), sorted.end(), is_near), sorted.end());
  return sorted;
}

/// Asks find(room, options) for some closest pairs, with and without a limit; truth_of(count) has those of brute force.
template <typename Find, typename TruthOf>
void check_closest(Rng& rng, const Find& find, const TruthOf& truth_of, double rounding) {
  std::vector<Contact> closest(rng.below(40));
  const std::vector<Contact> truth = truth_of(closest.size());
  closest.resize(find(closest, ClosestPairsOptions{}).count);
  expect_closest(closest, truth, rounding);
  const ClosestPairsOptions limited{.max_distance = between_distances(truth, rng, rounding)};
  closest.resize(find(closest, limited).count);
  expect_closest(closest, up_to(limited.max_distance, truth), rounding);
}

/// How many pairs have been compared with those of brute force.
struct Totals {
  std::size_t intersecting = 0, close = 0, vertex_face = 0, edge_edge = 0, touching = 0;

  void add(const ElementPairs& pairs) {
    vertex_face += pairs.vertex_face.size(), edge_edge += pairs.edge_edge.size();
    for (const VertexFacePair& p : pairs.vertex_face) touching += p.distance == 0 ? 1 : 0;
    for (const EdgeEdgePair& p : pairs.edge_edge) touching += p.distance == 0 ? 1 : 0;
  }
  void expect_many() const {
    EXPECT_GT(intersecting, 200U);
    EXPECT_GT(close, 2000U);
    EXPECT_GT(vertex_face, 2000U);
    EXPECT_GT(edge_edge, 5000U);
  }
};

// --- two models ---

void check_elements(const RandomScene& s, double margin, Totals& totals) {
  const Model model_a(s.mesh_a), model_b(s.mesh_b);
  const ElementPairs found = visited_elements([&](VertexFaceVisitor vertex_face, EdgeEdgeVisitor edge_edge) {
    return visit_element_pairs({model_a, s.pose_a}, {model_b, s.pose_b}, margin, vertex_face, edge_edge);
  });
  expect_same(found, reference::element_pairs({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}, margin), margin, s.tolerance);
  totals.add(found);
}

TEST(ContactsProperty, AreThoseOfBruteForceInRandomScenes) {
  Rng rng(1301);
  Totals totals;
  for (int i = 0; i < 120 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const RandomScene s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b);
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    const reference::Placed twin_a{s.mesh_a, s.pose_a}, twin_b{s.mesh_b, s.pose_b};
    const auto meeting =
        visited<TrianglePair>([&](TrianglePairVisitor visit) { return visit_intersections(a, b, visit); });
    EXPECT_EQ(in_order(meeting), reference::intersections(twin_a, twin_b));
    const double margin = some_margin(rng, s.size);
    const auto contacts = visited<Contact>([&](ContactVisitor visit) { return visit_contacts(a, b, margin, visit); });
    expect_same(contacts, reference::contacts(twin_a, twin_b, margin + s.tolerance), margin, s.tolerance);
    check_closest(
        rng, [&](auto& room, const auto& options) { return closest_pairs(a, b, room, options); },
        [&](std::size_t count) { return reference::closest_pairs(twin_a, twin_b, count); }, s.tolerance);
    check_elements(s, margin, totals);
    totals.intersecting += meeting.size(), totals.close += contacts.size();
  }
  totals.expect_many();
  EXPECT_GT(totals.touching, 20U);
}

/// Slivers of heights down to 0 and triangles without an area, some with common vertices; those of `other` have corners
/// on or next to the first ones.
Mesh slivers(Rng& rng, const Mesh* other) {
  std::vector<Triangle> triangles;
  for (int i = 0; i < 24; ++i) {
    const Vec3 long_side = uniform_point(rng), across = uniform_point(rng);
    Vec3 at = uniform_point(rng);
    if (other != nullptr) {
      const Triangle t = other->triangle(static_cast<TriangleId>(rng.below(other->triangles().size())));
      const double aside = rng.below(2) == 0 ? 0 : std::ldexp(1.0, -4 - static_cast<int>(rng.below(40)));
      at = point_on(t, rng.uniform(0, 1), 0) + aside * uniform_point(rng);
    }
    const double height = rng.below(4) == 0 ? 0 : std::ldexp(1.0, -static_cast<int>(rng.below(60)));
    triangles.push_back({at, at + long_side, at + rng.uniform(-0.5, 1.5) * long_side + height * across});
  }
  return soup(triangles);
}

TEST(ElementsProperty, AreThoseOfBruteForceNextToSliversOfAnyHeight) {
  Rng rng(1506);
  Totals totals;
  for (int i = 0; i < 60 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const Mesh mesh_a = slivers(rng, nullptr), mesh_b = slivers(rng, &mesh_a);
    const Transform pose = rng.below(2) == 0 ? Transform{} : random_pose(rng, 1);
    check_elements({mesh_a, mesh_b, pose, pose, 1, 1e-13}, std::ldexp(1.0, -static_cast<int>(rng.below(40))), totals);
  }
  EXPECT_GT(totals.vertex_face, 2000U);
  EXPECT_GT(totals.edge_edge, 2000U);
}

// --- one model with itself ---

void check_self_elements(const Model& model, double margin, Totals& totals) {
  const ElementPairs found = visited_elements([&](VertexFaceVisitor vertex_face, EdgeEdgeVisitor edge_edge) {
    return visit_self_element_pairs(model, margin, vertex_face, edge_edge);
  });
  expect_same(found, reference::self_element_pairs(model.mesh(), margin), margin, 1e-14 * extent_of(model.mesh()));
  totals.add(found);
}

void check_self_collision(const Model& model, Totals& totals) {
  const auto meeting =
      visited<TrianglePair>([&](TrianglePairVisitor visit) { return visit_self_intersections(model, visit); });
  const std::vector<TrianglePair> truth = reference::self_intersections(model.mesh());
  ASSERT_EQ(in_order(meeting), truth);
  totals.intersecting += truth.size();
  const CollideResult collision = self_collide(model);
  EXPECT_EQ(collision.is_yes(), !truth.empty());
  ASSERT_EQ(collision.witness.has_value(), !truth.empty());
  if (!collision.witness) return;
  const TrianglePair pair{collision.witness->triangle_a, collision.witness->triangle_b};
  EXPECT_TRUE(std::binary_search(truth.begin(), truth.end(), pair, ids_in_order));
}

/// All lists of a model with itself against brute force.
void check_self(const Model& model, Rng& rng, Totals& totals) {
  const MeshView mesh = model.mesh();
  const double size = extent_of(model.mesh()), rounding = 1e-14 * size, margin = some_margin(rng, size);
  check_self_collision(model, totals);
  check_self_elements(model, margin, totals);
  const auto contacts =
      visited<Contact>([&](ContactVisitor visit) { return visit_self_contacts(model, margin, visit); });
  expect_same(contacts, reference::self_contacts(mesh, margin + rounding), margin, rounding);
  totals.close += contacts.size();
  check_closest(
      rng, [&](auto& room, const auto& options) { return self_closest_pairs(model, room, options); },
      [&](std::size_t count) { return reference::self_closest_pairs(mesh, count); }, rounding);
}

TEST(SelfContactsProperty, AreThoseOfBruteForceInRandomMeshes) {
  Rng rng(1303);
  Totals totals;
  for (int i = 0; i < 80 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const Mesh mesh = crumpled(rng);
    check_self(Model(mesh), rng, totals);
  }
  totals.expect_many();
  EXPECT_GT(totals.touching, 100U);
}

TEST(SelfContactsProperty, AreThoseOfBruteForceWhileModelsDeform) {
  Rng rng(1304);
  Totals totals;
  for (int i = 0; i < 24 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const RebuildPolicy policy = rng.below(2) == 0 ? RebuildPolicy::off : RebuildPolicy::in_commit;
    const double margin = rng.below(2) == 0 ? 0.05 : 0.002;
    Model model(crumpled(rng), {.motion_margin = margin, .rebuild_policy = policy});
    const double size = extent_of(model.mesh());
    for (int step = 0; step < 6 && !HasFailure(); ++step) {
      const double length = size * std::pow(10.0, rng.uniform(-4, -0.5));
      deform(model, [&](const Vec3& p) { return rng.below(1 + step % 3) == 0 ? p + length * uniform_point(rng) : p; });
      if (step == 4) model.rebuild();
      check_self(model, rng, totals);
    }
  }
  totals.expect_many();
}

TEST(SelfContactsProperty, AreThoseOfBruteForceOnARealMesh) {
  const Mesh mesh = load_mesh(real_mesh("spot.ply")).value();
  Totals totals;
  check_self_elements(Model(mesh), 0.01 * extent_of(mesh), totals);
  EXPECT_GT(totals.vertex_face, 100U);
  EXPECT_GT(totals.edge_edge, 500U);
}

// Triangles that share a vertex or an edge: in little more time than other models of their size.
TEST(Fans, MeetThemselvesWhereBruteForceSaysSo) {
  Rng rng(1701);
  Totals totals;
  for (int i = 0; i < 150 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const Mesh mesh = arbitrary_fan(rng);
    const Model model(mesh);
    check_self_collision(model, totals);
    const double size = model.bounding_sphere().radius;
    const double margin = rng.below(4) == 0 ? 0 : size * std::ldexp(1.0, -4 - static_cast<int>(rng.below(20)));
    if (i < 100) check_self_elements(model, margin, totals);
  }
  EXPECT_GT(totals.intersecting, 1000U);
  EXPECT_GT(totals.vertex_face + totals.edge_edge, 10000U);
}

TEST(Fans, TakeLittleMoreThanTimeInProportionToTheirSize) {
  for (const bool is_book : {false, true}) {
    SCOPED_TRACE(is_book);
    std::uint64_t tests[2];
    for (const std::uint32_t k : {0U, 1U}) {
      const std::uint32_t count = 2000U << (3 * k);
      tests[k] = self_collide(Model(is_book ? book(count) : flat_fan(count))).stats.node_tests;
    }
    EXPECT_LT(tests[1], 12 * tests[0]);  // 64 times if all leaves were compared with each other
  }
  const Model copies(Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<Corners>(8000, {0, 1, 2})).value());
  EXPECT_LT(self_collide(copies).stats.node_tests, 20000U);
}

}  // namespace
}  // namespace limber::testing
