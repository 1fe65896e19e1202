// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries for pairs and about motions on several threads: the bits, order and work of one thread.
#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "scenes/scenes.h"
#include "support/keys.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// Calls something on several threads, also where the machine has one.
template <typename Call>
void on_threads(const Call& call) {
  oneapi::tbb::task_arena(4).execute(call);
}

/// Compares what ask(options) says on one thread and on several; returns what it says.
template <typename Options, typename Ask>
auto check_alike(Options options, const Ask& ask) {
  const auto serial = ask(options);
  options.parallel = true;
  on_threads([&] { EXPECT_EQ(ask(options), serial); });
  return serial;
}

/// Compares what find(visitor, options) visits on one thread and on several; returns how many pairs there are.
template <typename Pair, typename Options, typename Find>
std::size_t check_pairs(const Options& asked, const Find& find) {
  const auto found = check_alike(asked, [&](const Options& options) {
    std::vector<decltype(key_of(Pair{}))> keys;
    const PairCount count = find([&](const Pair& p) { return keys.push_back(key_of(p)), true; }, options);
    EXPECT_EQ(count.count, keys.size());
    EXPECT_TRUE(count.is_complete);
    return std::pair(keys, key_of(count.stats));
  });
  return found.first.size();
}

/// As check_pairs(), for pairs of elements.
template <typename Find>
std::size_t check_elements(const Find& find) {
  const auto found = check_alike(ElementPairOptions{}, [&](const ElementPairOptions& options) {
    std::vector<decltype(key_of(VertexFacePair{}))> vertex_face;
    std::vector<decltype(key_of(EdgeEdgePair{}))> edge_edge;
    const ElementPairCount count =
        find([&](const VertexFacePair& p) { return vertex_face.push_back(key_of(p)), true; },
             [&](const EdgeEdgePair& p) { return edge_edge.push_back(key_of(p)), true; }, options);
    EXPECT_EQ(std::pair(count.vertex_face, count.edge_edge), std::pair(vertex_face.size(), edge_edge.size()));
    return std::tuple(edge_edge, vertex_face, key_of(count.stats));
  });
  return std::get<0>(found).size();
}

// --- pairs ---

std::size_t check_two(const Placed& a, const Placed& b, double margin) {
  const PairOptions options;
  return check_pairs<TrianglePair>(options, [&](auto visit, auto& o) { return visit_intersections(a, b, visit, o); }) +
         check_pairs<Contact>(options, [&](auto visit, auto& o) { return visit_contacts(a, b, margin, visit, o); }) +
         check_elements(
             [&](auto face, auto edge, auto& o) { return visit_element_pairs(a, b, margin, face, edge, o); });
}

std::size_t check_self(const Model& model, double margin) {
  const PairOptions options;
  return check_pairs<TrianglePair>(options,
                                   [&](auto visit, auto& o) { return visit_self_intersections(model, visit, o); }) +
         check_pairs<Contact>(options,
                              [&](auto visit, auto& o) { return visit_self_contacts(model, margin, visit, o); }) +
         check_elements(
             [&](auto face, auto edge, auto& o) { return visit_self_element_pairs(model, margin, face, edge, o); });
}

TEST(ParallelForWith, MakesAStateForEachThreadWhichTakesTheNextThatIsLeft) {
  const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, 4);
  for (const int threads : {1, 4}) {
    constexpr std::size_t count = 40;
    std::vector<std::atomic<int>> calls(count);
    std::atomic<std::size_t> states = 0, done = 0;
    const auto body = [&](std::size_t&, std::size_t i) {
      ++calls[i];
      // A long one: it ends once all others are done, which are left to other threads.
      const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(20);
      while (i == 0 && threads > 1 && done < count - 1 && std::chrono::steady_clock::now() < late) {
        std::this_thread::yield();
      }
      EXPECT_TRUE(i > 0 || threads == 1 || done == count - 1);
      ++done;
    };
    oneapi::tbb::task_arena(threads).execute([&] {
      base::parallel_for_with(
          count, [&] { return ++states; }, body);
    });
    for (const std::atomic<int>& of_i : calls) EXPECT_EQ(of_i, 1);
    EXPECT_TRUE(states >= 1 && states <= static_cast<std::size_t>(threads));
  }
}

TEST(ParallelPairs, OfLargeModelsAreThoseOfOneThread) {
  const Model sheet(scenes::wave_sheet(100, 100, 0)), other(scenes::wave_sheet(90, 110, 1));
  const std::size_t total = check_two({sheet}, {other, {{}, {0.1, 0.1, 0.02}}}, 0.03) + check_self(sheet, 0.05);
  EXPECT_GT(total, 100'000U);
}

TEST(ParallelPairs, AreThoseOfOneThreadInRandomScenes) {
  Rng rng(1801);
  std::size_t total = 0;
  for (int i = 0; i < 60 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const RandomScene s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b), crumpled_model(crumpled(rng));
    const double margin = rng.below(3) == 0 ? 0 : 0.05 * s.size;
    total += check_two({model_a, s.pose_a}, {model_b, s.pose_b}, margin);
    total += check_self(crumpled_model, rng.uniform(0, 0.1));
  }
  EXPECT_GT(total, 50'000U);
}

TEST(ParallelPairs, OfFewTrianglesAreThoseOfOneThread) {
  const Triangle t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::size_t total = 0;
  for (const std::size_t count : {1U, 2U, 8U, 9U, 60U, 200U}) {
    const Model many(soup(std::vector<Triangle>(count, t)));
    for (const double height : {0.5, 9.0}) total += check_two({many}, {many, {{}, {0, 0, height}}}, 0.5);
    total += check_self(many, 0);
  }
  EXPECT_GT(total, 10'000U);
}

// --- motions ---

/// What was found, so that tests can tell that it was something.
struct Totals {
  std::size_t initial = 0, contact = 0, clear = 0, impacts = 0, candidates = 0;
};

void check_motions(const MovingModel& a, const MovingModel& b, ImpactOptions options, Totals& totals) {
  for (int which = 0; which < 8; ++which) {
    options.ignore_crossings = which % 2 == 1, options.any_contact = which % 4 > 1;
    const auto first = check_alike(options, [&](const ImpactOptions& o) {
      return key_of(which < 4 ? time_of_impact(a, b, o) : self_time_of_impact(a, o));
    });
    totals.initial += std::get<0>(first) == ImpactStatus::initial_contact ? 1U : 0U;
    totals.contact += std::get<0>(first) == ImpactStatus::contact ? 1U : 0U;
    totals.clear += std::get<0>(first) == ImpactStatus::clear ? 1U : 0U;
  }
  totals.impacts += check_pairs<Impact>(options, [&](auto visit, auto& o) { return visit_impacts(a, b, visit, o); }) +
                    check_pairs<Impact>(options, [&](auto visit, auto& o) { return visit_self_impacts(a, visit, o); });
  totals.candidates +=
      check_pairs<ElementPair>(options, [&](auto visit, auto& o) { return visit_impact_candidates(a, b, visit, o); }) +
      check_pairs<ElementPair>(options, [&](auto visit, auto& o) { return visit_self_impact_candidates(a, visit, o); });
}

/// A sheet of that many squares a side, and a motion.
struct MovingSheet {
  Model model;
  MovingModel moving{model};

  template <typename Motion>
  MovingSheet(std::uint32_t side, double frame, const Motion& motion) : model(scenes::wave_sheet(side, side, frame)) {
    moving.set_motion(mapped(model.mesh(), motion).positions()).value();
  }
};

Vec3 raised(const Vec3& p) { return p + Vec3{0, 0, 0.5 + 0.01 * std::sin(9 * p.x + 7 * p.y)}; }
Vec3 resting(const Vec3& p) { return p; }

TEST(ParallelImpacts, OfLargeModelsAreThoseOfOneThread) {
  const MovingSheet below(60, 0, raised);
  MovingSheet above(50, 1, resting);
  above.moving.set_motion(above.model.mesh().positions(), {{}, {0.01, 0.02, 0.4}}, {{}, {0, 0, 0.4}}).value();
  Totals totals;
  check_motions(below.moving, above.moving, {}, totals);
  check_motions(below.moving, above.moving, {.time_error = 1e-3, .min_separation = 1e-3}, totals);
  check_motions(below.moving, above.moving, {.max_time = 0.01}, totals);
  EXPECT_GT(totals.contact, 4U);
  EXPECT_GT(totals.clear, 4U);
  EXPECT_GT(totals.impacts, 1000U);
  EXPECT_GT(totals.candidates, 1000U);
}

TEST(ParallelImpacts, AreThoseOfOneThreadInRandomScenes) {
  Rng rng(2801);
  Totals totals;
  for (int i = 0; i < 60 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const auto soup = [&] {
      std::vector<Triangle> triangles;
      const double size = rng.uniform(0.02, 0.3);
      for (std::uint64_t k = 20 + rng.below(200); k > 0; --k) {
        const Vec3 p = uniform_point(rng);
        triangles.push_back({p, p + size * uniform_point(rng), p + size * uniform_point(rng)});
      }
      return testing::soup(triangles);
    };
    const Model model_a(rng.below(3) == 0 ? crumpled(rng) : soup()), model_b(soup());
    MovingModel a(model_a), b(model_b);
    const double far = std::ldexp(1.0, -static_cast<int>(rng.below(12)));
    const bool is_flat = rng.below(8) == 0;  // all that meets a plane does so at the same time
    const auto end_of = [&](const Vec3& p) { return is_flat ? Vec3{p.x, p.y, 0} : p + far * uniform_point(rng); };
    a.set_motion(mapped(model_a.mesh(), end_of).positions()).value();
    b.set_motion(mapped(model_b.mesh(), end_of).positions()).value();
    ImpactOptions options;
    if (rng.below(3) == 0) options.max_time = rng.uniform();
    if (rng.below(3) == 0) options.time_error = std::ldexp(1.0, -static_cast<int>(rng.below(30)));
    if (rng.below(3) == 0) options.min_separation = 0.01 * far, options.separation_fraction = 0.5;
    const auto is_even = [](const ElementPair& p) { return (p.a + p.b) % 2 == 0; };
    if (rng.below(3) == 0) options.filter = is_even;
    check_motions(a, b, options, totals);
  }
  EXPECT_GT(totals.initial, 100U);
  EXPECT_GT(totals.contact, 100U);
  EXPECT_GT(totals.clear, 100U);
  EXPECT_GT(totals.impacts, 2'000U);
}

// --- visitors, filters and budgets ---

/// Calls ask(visitor) on several threads with a visitor that stops at the seventh call.
template <typename Ask>
void check_visitor(const Ask& ask) {
  on_threads([&] {
    std::size_t seen = 0;
    const auto visit = [&, asking = std::this_thread::get_id()](const auto&) {
      EXPECT_EQ(std::this_thread::get_id(), asking);
      return ++seen < 7;
    };
    const auto count = ask(visit);
    EXPECT_EQ(seen, 7U);
    EXPECT_FALSE(count.is_complete);
  });
}

TEST(ParallelPairs, AreVisitedByTheThreadThatAsksUntilItStops) {
  const Model sheet(scenes::wave_sheet(40, 40, 0));
  check_visitor([&](auto& visit) { return visit_self_contacts(sheet, 0.2, visit, {.parallel = true}); });
  check_visitor([&](auto& visit) { return visit_self_element_pairs(sheet, 0.2, visit, visit, {.parallel = true}); });
}

TEST(ParallelImpacts, AreVisitedByTheThreadThatAsksUntilItStops) {
  const MovingSheet below(40, 0, raised), above(40, 1, resting);
  check_visitor(
      [&](auto& visit) { return visit_impact_candidates(below.moving, above.moving, visit, {.parallel = true}); });
}

TEST(ParallelPairs, PassOnWhatAFilterThrowsAndKeepToBudgets) {
  const Model sheet(scenes::wave_sheet(40, 40, 0));
  const auto count_of = [&](const PairOptions& options) {
    const PairCount found = self_contacts(sheet, 0.2, {}, options);
    return std::pair(found.count, found.stopped_by);
  };
  std::atomic<int> asked = 0;
  const auto throws = [&](TriangleId, TriangleId) -> bool {
    if (++asked > 100) throw std::runtime_error("enough");
    return true;
  };
  on_threads([&] { EXPECT_THROW(count_of({.filter = throws, .parallel = true}), std::runtime_error); });
  const auto is_even = [](TriangleId a, TriangleId b) { return (a + b) % 2 == 0; };
  check_alike(PairOptions{.filter = is_even}, count_of);
  EXPECT_EQ(check_alike(PairOptions{.budget = {.max_steps = 50}}, count_of).second, StoppedBy::max_steps);
}

TEST(ParallelImpacts, PassOnWhatAFilterThrowsAndKeepToBudgets) {
  const MovingSheet below(40, 0, raised), above(40, 1, resting);
  const auto first = [&](const ImpactOptions& options) {
    return key_of(time_of_impact(below.moving, above.moving, options));
  };
  std::atomic<int> asked = 0;
  const auto throws = [&](const ElementPair&) -> bool {
    if (++asked > 20) throw std::runtime_error("enough");
    return false;
  };
  on_threads(
      [&] { EXPECT_THROW(first({.ignore_crossings = true, .filter = throws, .parallel = true}), std::runtime_error); });
  const auto limited = check_alike(ImpactOptions{.ignore_crossings = true, .budget = {.max_steps = 5}}, first);
  EXPECT_EQ(std::get<StoppedBy>(limited), StoppedBy::max_steps);
}

}  // namespace
}  // namespace limber::testing
