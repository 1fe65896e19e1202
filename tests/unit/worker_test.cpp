// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models that are rebuilt on a worker thread: while the worker runs, and when no thread can be started. Tests with
// SharesModels in their names are run under the thread sanitizer too, on meshes too small for oneTBB's threads, which
// the sanitizer cannot follow.
#include <gtest/gtest.h>
#if defined(__GLIBC__)
#include <pthread.h>
#endif

#include <atomic>
#include <cmath>
#include <cstddef>
#include <future>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "reference/reference.h"
#include "scenes/motions.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

constexpr double tolerance = 1e-13;

void expect_right_distance(const Model& model, const Model& probe) {
  const double truth = reference::distance({model.mesh()}, {probe.mesh()}).upper;
  ASSERT_NEAR(distance({model}, {probe}).upper, truth, tolerance);
}

Model some_probe() { return Model(soup({{{0, 0, 0.6}, {0.1, 0, 2}, {0, 0.1, 2}}})); }

/// Moves a soup to a frame of its motion.
void show(const scenes::Motion& soup, Model& model, int frame) {
  ASSERT_TRUE(static_cast<bool>(model.move_all(soup.positions(frame))));
  model.commit();
}

#if defined(__GLIBC__)  // others let no default size of stacks be set
/// While an object lives, no thread can be started: each would need a stack larger than any address space.
class NoThreads {
 public:
  NoThreads() {
    pthread_attr_t without_room;
    pthread_getattr_default_np(&before_);
    pthread_getattr_default_np(&without_room);
    pthread_attr_setstacksize(&without_room, std::size_t{1} << 50);
    pthread_setattr_default_np(&without_room);
    pthread_attr_destroy(&without_room);
  }
  NoThreads(const NoThreads&) = delete;
  NoThreads& operator=(const NoThreads&) = delete;
  ~NoThreads() {
    pthread_setattr_default_np(&before_);
    pthread_attr_destroy(&before_);
  }

 private:
  pthread_attr_t before_;
};

bool can_start_a_thread() {
  try {
    std::thread([] {}).join();
  } catch (const std::system_error&) {
    return false;
  }
  return true;
}

TEST(Worker, IsDoneWithoutWhereNoThreadCanBeStarted) {
  const scenes::Motion soup = scenes::shuffled_soup(600);
  const Model probe = some_probe();
  for (const std::optional<double> us : {std::optional<double>(), std::optional<double>(3.0)}) {
    Model model(soup.mesh, {.rebuild_policy = RebuildPolicy::on_worker, .rebuild_budget_us = us});
    {
      const NoThreads no_threads;
      ASSERT_FALSE(can_start_a_thread());
      for (int frame = 1; frame <= 40; ++frame) {
        ASSERT_NO_THROW(show(soup, model, 10 * frame));
        ASSERT_TRUE(model.is_committed());
        ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text;
        expect_right_distance(model, probe);
      }
    }
    EXPECT_GT(model.maintenance_stats().rebuilt_triangles, 0U);  // by the commits themselves
    // Once threads can be started again, the worker rebuilds.
    ASSERT_TRUE(can_start_a_thread());
    const std::uint64_t before = model.maintenance_stats().rebuilt_triangles;
    for (int frame = 41; model.maintenance_stats().rebuilt_triangles == before; ++frame) {
      ASSERT_LT(frame, 2000);
      show(soup, model, 10 * frame);
      std::this_thread::yield();
    }
    expect_right_distance(model, probe);
  }
}
#endif

/// Shows frames until a worker is likely to be rebuilding.
void keep_busy(const scenes::Motion& soup, Model& model, int first) {
  for (int frame = first; frame < first + 6; ++frame) show(soup, model, 10 * frame);
}

TEST(Worker, SharesModelsSafelyWhenTheyAreMovedReplacedOrDestroyed) {
  const scenes::Motion soup = scenes::shuffled_soup(3000);
  const ModelOptions options{.motion_margin = 0.01, .rebuild_policy = RebuildPolicy::on_worker};
  const Model probe = some_probe();
  for (int round = 0; round < 4; ++round) {
    Model model(soup.mesh, options);
    keep_busy(soup, model, 1 + round);
    Model taken(std::move(model));
    keep_busy(soup, taken, 7 + round);
    model = Model(soup.mesh, options);
    keep_busy(soup, model, 1 + round);
    model = std::move(taken);
    keep_busy(soup, model, 13 + round);
    expect_right_distance(model, probe);
    model.rebuild();
    expect_right_distance(model, probe);
    keep_busy(soup, model, 19 + round);
    model.reset(soup.mesh);
    keep_busy(soup, model, 1 + round);
    expect_right_distance(model, probe);
    model.set_motion_margin(0);
    keep_busy(soup, model, 7 + round);
  }
}

TEST(Worker, SharesModelsWithQueriesBetweenUpdates) {
  // One model is updated, with a motion margin and a worker, while other threads query other models. Then all threads
  // query this model at once and add to its margin cost.
  const scenes::Motion soup = scenes::shuffled_soup(2000);
  const Model probe = some_probe(), ball(scenes::ball(16, 9)), square(scenes::grid(16, 16, -4, -4, 0.5, 0.5));
  const Transform above = scenes::ball_over_square(ball.mesh(), 0.75, 0);
  constexpr std::size_t thread_count = 4;
  for (const double motion_margin : {0.05, 0.005}) {
    Model model(soup.mesh, {.motion_margin = motion_margin, .rebuild_policy = RebuildPolicy::on_worker});
    for (int frame = 1; frame <= 30; ++frame) {
      std::vector<std::future<void>> threads;  // libc++ before 20 has no std::jthread
      std::vector<double> found(thread_count);
      for (std::size_t i = 0; i < thread_count; ++i) {
        threads.push_back(std::async(std::launch::async, [&, i] {
          found[i] = distance({square}, {ball, above}).upper;
        }));
      }
      show(soup, model, 4 * frame);
      threads.clear();
      for (const double d : found) ASSERT_NEAR(d, 0.75, tolerance);
      const double alone = distance({model}, {probe}).upper;
      for (std::size_t i = 0; i < thread_count; ++i) {
        threads.push_back(std::async(std::launch::async, [&, i] {
          QueryCache cache;
          const bool hit = collide({model}, {probe}, {.cache = &cache}).is_yes();
          found[i] = hit ? 0 : distance({model}, {probe}, {.cache = &cache}).upper;
        }));
      }
      threads.clear();
      for (const double d : found) ASSERT_EQ(d, alone);
    }
    expect_right_distance(model, probe);
  }
}

}  // namespace
}  // namespace limber::testing
