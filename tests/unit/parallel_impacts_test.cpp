// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries about motions on several threads: the bits of one thread, in its order.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "limber/motion.h"
#include "scenes/scenes.h"
#include "support/crumpled_mesh.h"
#include "support/on_threads.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

auto key_of(const ElementPair& p) { return std::tuple(p.kind, p.a, p.b); }
auto key_of(const Impact& i) { return std::tuple(key_of(i.elements), i.time.status, i.time.lower, i.time.upper); }
/// All that a first impact says but its statistics.
auto key_of(const ImpactResult& r) {
  const Witness w = r.witness.value_or(Witness{});
  return std::tuple(r.status, r.lower, r.upper, key_of(r.elements.value_or(ElementPair{})), r.elements.has_value(),
                    r.witness.has_value(), bits_of(w.point_a), bits_of(w.point_b), w.triangle_a, w.triangle_b,
                    bits_of(r.normal), r.stopped_by);
}

ImpactOptions parallel(ImpactOptions options) {
  options.parallel = true;
  return options;
}

/// What was found, so that tests can tell that it was something.
struct Totals {
  std::size_t initial = 0, contact = 0, clear = 0, impacts = 0, candidates = 0;
};

/// Compares a first impact on one thread with that on several.
template <typename Find>
void check_first(const Find& find, const ImpactOptions& options, Totals& totals) {
  const ImpactResult serial = find(options);
  on_threads([&] { EXPECT_EQ(key_of(find(parallel(options))), key_of(serial)); });
  totals.initial += serial.status == ImpactStatus::initial_contact ? 1U : 0U;
  totals.contact += serial.status == ImpactStatus::contact ? 1U : 0U;
  totals.clear += serial.status == ImpactStatus::clear ? 1U : 0U;
}

/// Compares what find(visitor, options) gives on one thread and on several; returns how many pairs there are.
template <typename Pair, typename Find>
std::size_t check_pairs(const Find& find, const ImpactOptions& options) {
  const auto ask = [&](const ImpactOptions& asked) {
    std::vector<decltype(key_of(Pair{}))> keys;
    const PairCount count = find([&](const Pair& p) { return keys.push_back(key_of(p)), true; }, asked);
    EXPECT_EQ(count.count, keys.size());
    EXPECT_TRUE(count.is_complete);
    return std::pair(keys, std::pair(count.stats.node_tests, count.stats.primitive_tests));
  };
  const auto serial = ask(options);
  on_threads([&] { EXPECT_EQ(ask(parallel(options)), serial); });
  return serial.first.size();
}

void check_motions(const MovingModel& a, const MovingModel& b, ImpactOptions options, Totals& totals) {
  const auto first = [&](const ImpactOptions& o) { return time_of_impact(a, b, o); };
  const auto self_first = [&](const ImpactOptions& o) { return self_time_of_impact(a, o); };
  for (int which = 0; which < 4; ++which) {
    options.ignore_crossings = which % 2 == 1, options.any_contact = which > 1;
    check_first(first, options, totals);
    check_first(self_first, options, totals);
  }
  const auto impacts = [&](auto visit, const auto& o) { return visit_impacts(a, b, visit, o); };
  const auto self_impacts = [&](auto visit, const auto& o) { return visit_self_impacts(a, visit, o); };
  totals.impacts += check_pairs<Impact>(impacts, options) + check_pairs<Impact>(self_impacts, options);
  const auto pairs = [&](auto visit, const auto& o) { return visit_impact_candidates(a, b, visit, o); };
  const auto self_pairs = [&](auto visit, const auto& o) { return visit_self_impact_candidates(a, visit, o); };
  totals.candidates += check_pairs<ElementPair>(pairs, options) + check_pairs<ElementPair>(self_pairs, options);
}

/// A sheet of that many squares a side, and a motion.
struct MovingSheet {
  Model model;
  MovingModel moving{model};

  template <typename Motion>
  MovingSheet(std::uint32_t side, double frame, const Motion& motion) : model(scenes::wave_sheet(side, side, frame)) {
    std::vector<Vec3> end;
    for (const Vec3& p : model.mesh().positions()) end.push_back(motion(p));
    moving.set_motion(end).value();
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
    const auto move = [&](MovingModel& moving, const Mesh& mesh) {
      std::vector<Vec3> end;
      for (const Vec3& p : mesh.positions()) end.push_back(is_flat ? Vec3{p.x, p.y, 0} : p + far * uniform_point(rng));
      moving.set_motion(end).value();
    };
    move(a, model_a.mesh()), move(b, model_b.mesh());
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

TEST(ParallelImpacts, AreVisitedByTheThreadThatAsksUntilItStops) {
  const MovingSheet below(40, 0, raised), above(40, 1, resting);
  on_threads([&] {
    const std::thread::id asking = std::this_thread::get_id();
    std::size_t seen = 0;
    const auto visit = [&](const auto&) {
      EXPECT_EQ(std::this_thread::get_id(), asking);
      return ++seen < 7;
    };
    const PairCount count = visit_impact_candidates(below.moving, above.moving, visit, {.parallel = true});
    EXPECT_EQ(count.count, 7U);
    EXPECT_FALSE(count.is_complete);
  });
}

TEST(ParallelImpacts, PassOnWhatAFilterThrowsAndKeepToBudgets) {
  const MovingSheet below(40, 0, raised), above(40, 1, resting);
  on_threads([&] {
    std::atomic<int> asked = 0;
    const auto throws = [&](const ElementPair&) -> bool {
      if (++asked > 20) throw std::runtime_error("enough");
      return false;
    };
    const ImpactOptions throwing{.ignore_crossings = true, .filter = throws, .parallel = true};
    EXPECT_THROW((void)time_of_impact(below.moving, above.moving, throwing), std::runtime_error);
    ImpactOptions limited{.ignore_crossings = true, .budget = {.max_steps = 5}};
    const ImpactResult serial = time_of_impact(below.moving, above.moving, limited);
    EXPECT_EQ(serial.stopped_by, StoppedBy::max_steps);
    EXPECT_EQ(key_of(time_of_impact(below.moving, above.moving, parallel(limited))), key_of(serial));
  });
}

}  // namespace
}  // namespace limber::testing
