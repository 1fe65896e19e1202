// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries for pairs on several threads: the same pairs, numbers, order and work as on one.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <tuple>
#include <vector>

#include "limber/contacts.h"
#include "limber/elements.h"
#include "scenes/scenes.h"
#include "support/crumpled_mesh.h"
#include "support/on_threads.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

auto key_of(const TrianglePair& p) { return std::tuple(p.a, p.b); }
auto key_of(const Contact& c) {
  return std::tuple(c.triangle_a, c.triangle_b, c.distance, c.depth, bits_of(c.point_a), bits_of(c.normal),
                    bits_of(c.weights_a), bits_of(c.weights_b), c.normal_side);
}
auto key_of(const VertexFacePair& p) {
  return std::tuple(p.vertex, p.triangle, p.is_vertex_of_b, p.distance, bits_of(p.weights));
}
auto key_of(const EdgeEdgePair& p) { return std::tuple(p.a, p.b, p.distance, p.parameter_a, p.parameter_b); }

template <typename Pair>
bool are_same(const std::vector<Pair>& p, const std::vector<Pair>& q) {
  return std::equal(p.begin(), p.end(), q.begin(), q.end(),
                    [](const Pair& x, const Pair& y) { return key_of(x) == key_of(y); });
}

/// Compares what find(visitor, options) gives on one thread and on several. Adds how many pairs there are.
template <typename Pair, typename Find>
void check(const Find& find, std::size_t& total) {
  std::vector<Pair> serial, parallel;
  const PairCount count = find([&](const Pair& p) { return serial.push_back(p), true; }, PairOptions{});
  on_threads([&] {
    const PairCount in_parallel =
        find([&](const Pair& p) { return parallel.push_back(p), true; }, PairOptions{.parallel = true});
    EXPECT_EQ(in_parallel.count, count.count);
    EXPECT_TRUE(in_parallel.is_complete);
    EXPECT_EQ(in_parallel.stats.node_tests, count.stats.node_tests);
    EXPECT_EQ(in_parallel.stats.primitive_tests, count.stats.primitive_tests);
  });
  EXPECT_TRUE(are_same(serial, parallel));
  total += serial.size();
}

template <typename Find>
void check_elements(const Find& find, std::size_t& total) {
  struct Lists {
    std::vector<VertexFacePair> vertex_face;
    std::vector<EdgeEdgePair> edge_edge;
  };
  const auto ask = [&](Lists& lists, bool parallel) {
    return find([&](const VertexFacePair& p) { return lists.vertex_face.push_back(p), true; },
                [&](const EdgeEdgePair& p) { return lists.edge_edge.push_back(p), true; },
                ElementPairOptions{.parallel = parallel});
  };
  Lists serial, parallel;
  const ElementPairCount count = ask(serial, false);
  on_threads([&] {
    const ElementPairCount in_parallel = ask(parallel, true);
    EXPECT_EQ(in_parallel.vertex_face, count.vertex_face);
    EXPECT_EQ(in_parallel.edge_edge, count.edge_edge);
    EXPECT_EQ(in_parallel.stats.node_tests, count.stats.node_tests);
    EXPECT_EQ(in_parallel.stats.primitive_tests, count.stats.primitive_tests);
  });
  EXPECT_TRUE(are_same(serial.vertex_face, parallel.vertex_face));
  EXPECT_TRUE(are_same(serial.edge_edge, parallel.edge_edge));
  total += serial.edge_edge.size();
}

void check_all(const Placed& a, const Placed& b, double margin, std::size_t& total) {
  check<TrianglePair>([&](auto visit, const auto& options) { return visit_intersections(a, b, visit, options); },
                      total);
  check<Contact>([&](auto visit, const auto& options) { return visit_contacts(a, b, margin, visit, options); }, total);
  check_elements(
      [&](auto visit_vertex_face, auto visit_edge_edge, const auto& options) {
        return visit_element_pairs(a, b, margin, visit_vertex_face, visit_edge_edge, options);
      },
      total);
}

void check_self(const Model& model, double margin, std::size_t& total) {
  check<TrianglePair>([&](auto visit, const auto& options) { return visit_self_intersections(model, visit, options); },
                      total);
  check<Contact>([&](auto visit, const auto& options) { return visit_self_contacts(model, margin, visit, options); },
                 total);
  check_elements(
      [&](auto visit_vertex_face, auto visit_edge_edge, const auto& options) {
        return visit_self_element_pairs(model, margin, visit_vertex_face, visit_edge_edge, options);
      },
      total);
}

TEST(ParallelPairs, OfLargeModelsAreThoseOfOneThread) {
  const Model sheet(scenes::wave_sheet(100, 100, 0)), other(scenes::wave_sheet(90, 110, 1));
  std::size_t total = 0;
  check_all({sheet}, {other, {{}, {0.1, 0.1, 0.02}}}, 0.03, total);
  check_self(sheet, 0.05, total);
  EXPECT_GT(total, 100'000U);
}

TEST(ParallelPairs, AreThoseOfOneThreadInRandomScenes) {
  Rng rng(1801);
  std::size_t total = 0;
  for (int i = 0; i < 60 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const Scene s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b), crumpled_model(crumpled(rng));
    const double margin = rng.below(3) == 0 ? 0 : 0.05 * s.size;
    check_all({model_a, s.pose_a}, {model_b, s.pose_b}, margin, total);
    check_self(crumpled_model, rng.uniform(0, 0.1), total);
  }
  EXPECT_GT(total, 50'000U);
}

TEST(ParallelPairs, OfFewTrianglesAreThoseOfOneThread) {
  const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::size_t total = 0;
  for (const std::size_t count : {1U, 2U, 8U, 9U, 60U, 200U}) {
    const Model many(soup(std::vector<Triangle>(count, t)));
    check_all({many}, {many, {{}, {0, 0, 0.5}}}, 0.5, total);
    check_all({many}, {many, {{}, {0, 0, 9}}}, 0.5, total);
    check_self(many, 0, total);
  }
  EXPECT_GT(total, 10'000U);
}

TEST(ParallelPairs, AreVisitedByTheThreadThatAsksUntilItStops) {
  const Model sheet(scenes::wave_sheet(40, 40, 0));
  on_threads([&] {
    const std::thread::id asking = std::this_thread::get_id();
    std::size_t seen = 0;
    const auto visit = [&](const auto&) {
      EXPECT_EQ(std::this_thread::get_id(), asking);
      return ++seen < 7;
    };
    const PairCount count = visit_self_contacts(sheet, 0.2, visit, {.parallel = true});
    EXPECT_EQ(count.count, 7U);
    EXPECT_FALSE(count.is_complete);
    const ElementPairCount elements = visit_self_element_pairs(sheet, 0.2, visit, visit, {.parallel = true});
    EXPECT_EQ(elements.vertex_face, 1U);
    EXPECT_EQ(elements.edge_edge, 0U);
    EXPECT_FALSE(elements.is_complete);
  });
}

TEST(ParallelPairs, PassOnWhatAFilterThrowsAndKeepToBudgets) {
  const Model sheet(scenes::wave_sheet(40, 40, 0));
  on_threads([&] {
    std::atomic<int> asked = 0;
    const auto throws = [&](TriangleId, TriangleId) -> bool {
      if (++asked > 100) throw std::runtime_error("enough");
      return true;
    };
    EXPECT_THROW(self_contacts(sheet, 0.2, {}, {.filter = throws, .parallel = true}), std::runtime_error);
    const auto is_even = [](TriangleId a, TriangleId b) { return (a + b) % 2 == 0; };
    EXPECT_EQ(self_contacts(sheet, 0.2, {}, {.filter = is_even, .parallel = true}).count,
              self_contacts(sheet, 0.2, {}, {.filter = is_even}).count);
    const PairCount some = self_contacts(sheet, 0.2, {}, {.budget = {.max_steps = 50}, .parallel = true});
    EXPECT_EQ(some.stopped_by, StoppedBy::max_steps);
    EXPECT_EQ(some.count, self_contacts(sheet, 0.2, {}, {.budget = {.max_steps = 50}}).count);
  });
}

}  // namespace
}  // namespace limber::testing
