// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/haptic_scene.h"
#include "limber/distance.h"

#include <algorithm>
#include <cmath>

#include "haptics/haptic_models.h"

namespace limber::program {
namespace {

constexpr double rebuild_budget_us = 10;

/// The end of the budget is for the force, and for what a query overruns its deadline by.
constexpr std::chrono::microseconds kept_for_force{5};

constexpr std::uint64_t most_warm_up_ticks = 500;

/// A force loop need not know how far away tissue is that the tool cannot reach for some ticks.
double farthest_of_interest(double rate_hz) {
  constexpr double least_mm = 1, ticks = 4;
  return std::max(least_mm, ticks * fastest_mm_per_s / rate_hz);
}

}  // namespace

ModelOptions tissue_options() { return ModelOptions::real_time(rebuild_budget_us); }

HapticScene::HapticScene(const HapticOptions& options)
    : options_(options),
      query_{.relative_error = options.relative_error, .max_distance = farthest_of_interest(options.rate_hz)},
      tissue_(options.tissue_triangles, 1 / options.rate_hz),
      model_(tissue_.mesh(), options.tissue_model),
      tool_(tool_mesh(options.tool_triangles)),
      proxy_(device(0).translation, fastest_mm_per_s / options.rate_hz) {}

Transform HapticScene::device(std::uint64_t number) const {
  return device_pose(static_cast<double>(number) / options_.rate_hz);
}

void HapticScene::tick(std::uint64_t number, TickSample& sample) {
  const TickClock::time_point start = TickClock::now();
  const Transform device_pose = device(number);
  const Tissue::Moves moves = tissue_.press(tip_at(device_pose));
  model_.move_vertices(moves.ids, moves.positions).value();
  const TickClock::time_point moved = TickClock::now();
  model_.commit();
  const TickClock::time_point committed = TickClock::now();

  const Transform tool_pose{device_pose.rotation, proxy_.place()};
  DistanceOptions options = query_;
  options.cache = &cache_, options.budget = {.deadline = start + options_.tick_budget - kept_for_force};
  const DistanceResult found = distance({model_}, {tool_, tool_pose}, options);
  const TickClock::time_point asked = TickClock::now();
  const Vec3 force = proxy_.follow(device_pose.translation, found);
  const TickClock::time_point done = TickClock::now();

  sample.move = ns_between(start, moved);
  sample.commit = ns_between(moved, committed);
  sample.query = ns_between(committed, asked);
  sample.force = ns_between(asked, done);
  sample.moved_vertices = static_cast<std::uint32_t>(moves.ids.size());
  sample.lower = static_cast<float>(found.lower);
  sample.upper = static_cast<float>(found.upper);
  sample.force_n = static_cast<float>(length(force));
  sample.status = found.status;
}

std::uint64_t HapticScene::warm_up() {
  const auto end = static_cast<std::uint64_t>(std::ceil(press_period_s * options_.rate_hz));
  const std::uint64_t step = std::max<std::uint64_t>(end / most_warm_up_ticks, 1);
  TickSample unused;
  for (std::uint64_t n = 0; n < end; n += step) tick(n, unused);
  return end;
}

double node_tests_over_new_tree(const HapticScene& scene) {
  constexpr int pose_count = 64;
  constexpr double step_s = 0.37, lifted_mm = 2;
  const Model fresh(scene.tissue().mesh());
  std::uint64_t node_tests = 0, fresh_node_tests = 0;
  for (int i = 0; i < pose_count; ++i) {
    Transform pose = device_pose(i * step_s);
    pose.translation.z += lifted_mm;
    node_tests += distance({scene.tissue()}, {scene.tool(), pose}).stats.node_tests;
    fresh_node_tests += distance({fresh}, {scene.tool(), pose}).stats.node_tests;
  }
  return static_cast<double>(node_tests) / static_cast<double>(fresh_node_tests);
}

}  // namespace limber::program
