// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Every promise of the queries, on random meshes, poses and settings, with every instruction set, next to brute force;
// with caches along any motion, and interrupted while models move, deform and are rebuilt. The environment variable
// LIMBER_INTERRUPTED_QUERIES changes how many are interrupted.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "simd/kernels.h"
#include "support/brute_force.h"
#include "support/keys.h"
#include "support/random_scene.h"
#include "support/right_answers.h"

namespace limber::testing {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(BruteForce, EqualsTheReferenceToTheBitWhateverItSkips) {
  Rng rng(92);
  int contacts = 0;
  for (int i = 0; i < 1000; ++i) {
    const RandomScene s = arbitrary_scene(rng);
    const double truth = reference::distance({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}).upper;
    ASSERT_EQ(brute_force_distance({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}), truth) << "scene " << i;
    contacts += truth == 0 ? 1 : 0;
  }
  EXPECT_GT(contacts, 50);
  EXPECT_LT(contacts, 950);
}

TEST(RandomQueries, OfTheFastEngineEqualTheReferenceOnEveryInstructionSet) {
  Rng rng(90);
  int queries = 0, contacts = 0;
  double worst = 0;  // difference from the truth, as a fraction of the size
  for (int scene = 0; queries < 200'000; ++scene) {
    SCOPED_TRACE("scene " + std::to_string(scene));
    const RandomScene s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b);
    ASSERT_TRUE(static_cast<bool>(model_a.validate()));
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    const Truth truth{brute_force_distance({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}), s.tolerance};
    const DistanceOptions options[] = {{}, {.relative_error = rng.uniform(0, 1)}};
    std::vector<DistanceResult> first;
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::use_kernels(&set);
      for (int k = 0; k < 4; ++k, ++queries) {
        ASSERT_EQ(wrong_answer_to_any(rng, a, b, truth), "") << set.name;
        ASSERT_EQ(wrong_answer_to_any(rng, b, a, truth), "") << set.name;
      }
      for (std::size_t k = 0; k < std::size(options); ++k, ++queries) {
        const DistanceResult found = distance(a, b, options[k]);
        ASSERT_EQ(wrong_answer(found, options[k], a, b, truth), "") << set.name;
        if (first.size() <= k) first.push_back(found);
        ASSERT_EQ(key_of(found), key_of(first[k])) << set.name;
      }
    }
    simd::use_kernels(nullptr);
    contacts += truth.distance == 0 ? 1 : 0;
    worst = std::max(worst, std::abs(first[0].upper - truth.distance) / s.size);
  }
  std::printf("%d queries, %d scenes in contact, worst difference %.2g of the size\n", queries, contacts, worst);
  EXPECT_GT(contacts, 500);
}

/// One step of a motion: usually small, sometimes none, a jump, or a jump far away, after which it is back to `home`.
Transform step_from(Rng& rng, const Transform& pose, const Transform& home, double size) {
  if (rng.below(8) == 0) return pose;
  if (length(pose.translation - home.translation) > 100 * size) return home;
  if (rng.below(8) == 0 && size < 0x1p150) {
    return {pose.rotation, pose.translation + (1e12 * size) * uniform_point(rng)};
  }
  const double most = rng.below(8) == 0 ? 1 : std::pow(10.0, rng.uniform(-6, -1));
  const Vec3 axis = uniform_point(rng);
  const Transform turn = transform_from_quaternion({}, 1, most * axis.x, most * axis.y, most * axis.z).value();
  return {turn.rotation * pose.rotation, pose.translation + (most * size) * uniform_point(rng)};
}

RC_GTEST_PROP(FastEngine, CachesAreRightAlongAnyMotion, (std::uint64_t seed)) {
  Rng rng(seed);
  RandomScene s = arbitrary_scene(rng);
  const Model model_a(s.mesh_a), model_b(s.mesh_b);
  const Transform home_a = s.pose_a, home_b = s.pose_b;
  QueryCache cache;
  for (int frame = 0; frame < 20; ++frame) {
    if (rng.below(4) == 0) s.pose_a = step_from(rng, s.pose_a, home_a, s.size);
    s.pose_b = step_from(rng, s.pose_b, home_b, s.size);
    const double tolerance = s.tolerance + 1e-14 * (length(s.pose_a.translation) + length(s.pose_b.translation));
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    if (rng.below(20) == 0)
      static_cast<void>(distance(b, a, {.cache = &cache}));  // the cache does not fit the models in this order
    const std::string wrong = wrong_answer_to_any(rng, a, b, {distance(a, b).upper, tolerance}, &cache);
    if (!wrong.empty()) RC_FAIL(wrong);
  }
}

/// Asks for the distance with a cache, and notes what is as far apart as the answer up to rounding.
void ask_for_ties(Rng& rng, const Placed& a, const Placed& b, QueryCache& cache, std::vector<double>& limits) {
  const double known = limits.empty() ? infinity : limits[rng.below(limits.size())];
  const DistanceOptions asked[] = {{},
                                   {},
                                   {.relative_error = rng.uniform(0, 5)},
                                   {.max_distance = known},
                                   {.relative_error = 5, .max_distance = known}};
  const double upper = distance(a, b, with(asked[rng.below(std::size(asked))], &cache)).upper;
  if (upper == infinity) return;
  for (const double limit : {std::nextafter(upper, 0.0), upper, std::nextafter(upper, infinity)}) {
    limits.push_back(limit);
  }
}

RC_GTEST_PROP(FastEngine, WithinIsThatOfComparingAllPairsWithAnyCache, (std::uint64_t seed)) {
  Rng rng(seed);
  RandomScene s = arbitrary_scene(rng);
  const Model model_a(s.mesh_a), model_b(s.mesh_b);
  const Transform home = s.pose_b;
  QueryCache cache;
  for (int pose = 0; pose < 3; ++pose) {
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    const double truth = brute_force_distance({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b});
    std::vector<double> limits{truth};
    for (int query = 0; query < 10; ++query) {
      if (rng.below(2) == 0) ask_for_ties(rng, a, b, cache, limits);
      const double limit = limits[rng.below(limits.size())];
      RC_ASSERT(within(a, b, limit, {.cache = &cache}).is_yes() == (truth <= limit));
      RC_ASSERT(within(a, b, limit).is_yes() == (truth <= limit));
      if (truth <= limit) {
        RC_ASSERT(distance(a, b, {.max_distance = limit, .cache = &cache}).status != DistanceStatus::beyond_limit);
      }
    }
    s.pose_b = step_from(rng, s.pose_b, home, s.size);
  }
}

/// What may happen to a model between two queries. Returns whether it has not been at rest.
bool is_disturbed(Rng& rng, Model& model, Transform& pose, double size) {
  const std::uint64_t kind = rng.below(16);
  if (kind < 6) return false;
  const double step = size * std::pow(10.0, rng.uniform(-5, -0.5));
  std::vector<Vec3> positions = model.mesh().positions();
  if (kind < 10) {
    pose = step_from(rng, pose, {}, size);
  } else if (kind == 10) {
    pose = random_pose(rng, size);
  } else if (kind == 11) {
    model.rebuild();
  } else if (kind < 14) {
    const auto v = static_cast<VertexId>(rng.below(positions.size()));
    const std::vector<Vec3> to{positions[v] + step * uniform_point(rng)};
    model.move_vertices(std::vector<VertexId>{v}, to).value();
  } else {
    for (Vec3& p : positions) p += step * uniform_point(rng);
    model.move_all(positions).value();
  }
  model.commit();
  return true;
}

TEST(InterruptedQueries, HoldTheTruthWhateverMovesInBetween) {
  Rng rng(1201);
  const std::uint64_t count = count_from("LIMBER_INTERRUPTED_QUERIES", 30000);
  std::uint64_t interrupted = 0, undecided = 0, contacts = 0, narrowed = 0;
  for (std::uint64_t asked = 0; asked < count;) {
    RandomScene s = arbitrary_scene(rng);
    const ModelOptions options[] = {
        {}, {.motion_margin = 0.05 * s.size}, {.motion_margin = 0.001 * s.size}, ModelOptions::real_time(1)};
    Model model_a(s.mesh_a, options[rng.below(4)]), model_b(s.mesh_b);
    QueryCache cache;
    double lower = 0;  // of the last query, if nothing has happened since
    for (int i = 0; i < 40; ++i, ++asked) {
      SCOPED_TRACE("query " + std::to_string(asked));
      const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
      const double places = max_abs(s.pose_a.translation) + max_abs(s.pose_b.translation);
      const Truth truth{distance(a, b).upper, s.tolerance + 0x1p-40 * places};
      const QueryOptions limited{&cache, {.max_steps = rng.below(3) == 0 ? rng.below(40) : rng.below(4)}};
      if (rng.below(3) != 0) {
        const double error = rng.below(2) == 0 ? 0 : rng.uniform(0, 0.5);
        const DistanceOptions asked_for = with({.relative_error = error}, &cache, limited.budget);
        const DistanceResult found = distance(a, b, asked_for);
        ASSERT_EQ(wrong_answer(found, asked_for, a, b, truth), "");
        ASSERT_GE(found.lower, std::min(lower, found.upper));
        interrupted += found.status == DistanceStatus::interrupted ? 1 : 0;
        narrowed += lower > 0 && found.lower > lower ? 1 : 0;
        lower = found.lower;
      } else {
        const double limit = rng.below(2) == 0 ? 0 : truth.distance * rng.uniform(0.5, 1.5);
        const CollideResult found = limit == 0 ? collide(a, b, limited) : within(a, b, limit, limited);
        ASSERT_EQ(wrong_answer(found, limit, a, b, truth), "");
        undecided += found.answer == Answer::undecided ? 1 : 0;
        contacts += truth.distance == 0 ? 1 : 0;
      }
      const bool is_a = rng.below(2) == 0;
      if (is_disturbed(rng, is_a ? model_a : model_b, is_a ? s.pose_a : s.pose_b, s.size)) lower = 0;
    }
  }
  EXPECT_GT(interrupted, count / 10);
  EXPECT_GT(undecided, count / 50);
  EXPECT_GT(contacts, count / 100);
  EXPECT_GT(narrowed, count / 100);
}

/// Two soups at 2^-1074 to 2^-300, a few of their own sizes apart or in each other.
RandomScene tiny_scene(Rng& rng) {
  const double size = std::ldexp(1.0, -300 - static_cast<int>(rng.below(760)));
  const auto mesh = [&] {
    std::vector<Triangle> triangles;
    for (std::size_t i = 0, count = 1 + rng.below(20); i < count; ++i) {
      triangles.push_back(arbitrary_triangle(rng, rng.below(6)));
    }
    return moved(soup(triangles), {}, size);
  };
  Mesh a = mesh(), b = mesh();
  Transform pose;
  if (rng.below(2) == 0) pose.translation = size * uniform_point(rng, -8, 8);
  return {std::move(a), std::move(b), {}, pose, 16 * size, std::max(1e-13 * 16 * size, 0x1p-1060)};
}

TEST(TinyScenes, AreAnsweredWithACacheAndABudgetAsWithout) {
  Rng rng(1601);
  for (int i = 0; i < 3000; ++i) {
    const RandomScene s = tiny_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b);
    const Placed a{model_a}, b{model_b, s.pose_b};
    const Truth truth{distance(a, b).upper, s.tolerance};
    QueryCache cache;
    for (int k = 0; k < 6; ++k) {
      const QueryBudget budget = rng.below(4) == 0 ? QueryBudget{.max_steps = rng.below(20)} : QueryBudget{};
      ASSERT_EQ(wrong_answer_to_any(rng, a, b, truth, &cache, budget), "") << "scene " << i;
    }
  }
}

TEST(TinyScenes, AndLargeOnesHaveAPairWithinWhatADistanceWithAnErrorHasFound) {
  Rng rng(1602);
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    const bool is_tiny = i % 2 == 0;
    const double size = std::ldexp(1.0, is_tiny ? -480 - static_cast<int>(rng.below(300)) : 0);
    // Triangles whose closest points are often corners, so that rounding alone decides.
    const auto model = [&](const Vec3& at) {
      const Vec3 p = at + uniform_point(rng);
      return Model(moved(soup({{p, p + 0.1 * uniform_point(rng), p + 0.1 * uniform_point(rng)}}), {}, size));
    };
    const Model model_a = model({}), model_b = model(uniform_point(rng, -3, 3));
    const Placed a{model_a}, b{model_b, {{}, size * uniform_point(rng)}};
    const double upper = distance(a, b, {.relative_error = rng.uniform(0, 0.9)}).upper;
    ASSERT_NE(distance(a, b, {.max_distance = upper}).status, DistanceStatus::beyond_limit);
    ASSERT_TRUE(within(a, b, upper).is_yes());
    ASSERT_LE(distance(a, b).upper, upper);
  }
}

}  // namespace
}  // namespace limber::testing
