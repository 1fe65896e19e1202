// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Every allocation of every function of a scene fails once, alone or with all that follow. Afterwards the scene is as
// before the call, and the same call works.
#include <gtest/gtest.h>

#include <new>
#include <tuple>
#include <vector>

#include "heap.h"
#include "limber/limber.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

auto state_of_scene(const limber::Scene& scene) {
  std::vector<bool> contains;
  for (ObjectId id = 0; id <= scene.id_bound(); ++id) contains.push_back(scene.contains(id));
  return std::tuple(scene.size(), scene.id_bound(), scene.is_committed(), contains);
}

/// Calls on a heap whose allocation `k`, counted over all calls, fails. Calls that throw are made again.
class FailingCalls {
 public:
  FailingCalls(std::int64_t k, Failing failing) : k_(k), failing_(failing) {}

  template <typename Call>
  void operator()(const limber::Scene& scene, const Call& call) {
    const auto before = state_of_scene(scene);
    bool threw = false;
    {
      const FailingHeap heap(k_, failing_);
      const std::uint64_t count = allocation_count();
      try {
        call();
      } catch (const std::bad_alloc&) {
        threw = true;
      }
      has_failed_ = has_failed_ || heap.has_failed();
      k_ -= static_cast<std::int64_t>(allocation_count() - count);
      if (heap.has_failed()) k_ = 1'000'000;
    }
    if (!threw) return;
    ASSERT_EQ(state_of_scene(scene), before);
    call();
  }
  bool has_failed() const { return has_failed_; }

 private:
  std::int64_t k_;
  Failing failing_;
  bool has_failed_ = false;
};

/// Builds a scene, changes it and asks it, and checks the answers. Returns whether an allocation has failed.
bool play_scene(const Model& ball, std::int64_t k, Failing failing) {
  FailingCalls failing_call(k, failing);
  limber::Scene scene;
  std::vector<ObjectPair> pairs(100);
  std::vector<DistanceResult> distances;
  SceneCache cache(2);
  for (ObjectId i = 0; i < 12; ++i) {
    failing_call(scene, [&] { EXPECT_EQ(scene.add({ball, {{}, {1.5 * i, 0, 0}}}), i); });
  }
  for (int frame = 0; frame < 2; ++frame) {
    failing_call(scene, [&] { scene.remove(5); });
    failing_call(scene, [&] { scene.commit(); });
    failing_call(scene, [&] { EXPECT_EQ(scene.candidate_pairs(0.1, pairs).count, 9U); });
    failing_call(scene, [&] { EXPECT_EQ(scene.add({ball, {{}, {7.5, 0, 0}}}), 5U); });
    failing_call(scene, [&] { scene.commit(); });
    const std::size_t count = scene.candidate_pairs(0.1, pairs).count;
    EXPECT_EQ(count, 11U);
    distances.assign(count, {});
    failing_call(scene, [&] { scene.distance(std::span(pairs).first(count), distances, {.cache = &cache}); });
    for (const DistanceResult& d : distances) EXPECT_EQ(d.upper, 0);
    ClosestObjects closest;
    const auto are_not_next = [](ObjectId a, ObjectId b) { return b != a + 1; };
    failing_call(scene, [&] { closest = scene.closest_objects({.filter = are_not_next, .cache = &cache}); });
    EXPECT_NEAR(closest.result.upper, 1, 0.1);
  }
  return failing_call.has_failed();
}

TEST(FailingHeap, LeavesASceneAsItWas) {
  const Model ball(scenes::ball(8, 6));
  for (const Failing failing : {Failing::once, Failing::always}) {
    std::int64_t k = 0;
    while (play_scene(ball, k, failing) && !HasFailure()) ++k;
    EXPECT_GT(k, 30);
  }
}

}  // namespace
}  // namespace limber::testing
