// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What does a query know when its time is up? How late is it then? How many calls and how much work
//                 does it take until one that is asked again and again at rest has its answer?
// Workload        Scans beside each other and the source's ball over its square, near and far apart. For the last
//                 question all scenes of realtime/scenes.h; budgets of 1 step to 1600, and of 50 us to 2 ms.
// Metric          Time of a query that may make no step. How long queries go on after deadlines from 5 us to 1 ms, next
//                 to a loop that does nothing but look at the clock. Width of the interval after parts of the time of
//                 the exact query. Calls until the end; node tests of all calls over those of one query without budget
//                 and cache.
// Expected shape  Overruns of a few us, until the machine itself interrupts. Widths that shrink quickly. As many calls
//                 as the work needs, at most twice the node tests and one a call.
// Checked         Every interval holds the exact distance, and none at rest is wider than the one before; every query
//                 ends within that work.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/peers/scenes.h"
#include "bench/realtime/scenes.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

struct Scene {
  std::string name;
  Model a, b;
  std::vector<Transform> poses;

  Scene(const PeerScene& scene, const Situation& situation)
      : name(scene.name + ", " + situation.name), a(scene.a), b(scene.b), poses(situation.poses) {}

  DistanceResult exact(const Transform& pose) const { return distance({a}, {b, pose}); }
};

void check_interval(Checker& checker, const std::string& name, const DistanceResult& found, double truth) {
  checker.check(found.lower <= truth * (1 + 1e-12) && found.upper >= truth * (1 - 1e-12),
                "{}: [{}, {}] does not hold {}", name, found.lower, found.upper, truth);
}

void time_first_intervals(const std::vector<Scene>& scenes, Checker& checker, Table& text, std::size_t count) {
  text.line("## The first interval\n");
  text.line("Time of a query that may make no step, in us.\n");
  text.line("| scene | p50 | p99 | p99.9 | p99.99 | max |\n|:--|--:|--:|--:|--:|--:|");
  for (const Scene& scene : scenes) {
    std::vector<double> times;
    for (std::size_t i = 0; i < count; ++i) {
      const Transform& pose = scene.poses[i % scene.poses.size()];
      const Stopwatch watch;
      const DistanceResult found = distance({scene.a}, {scene.b, pose}, {.budget = {.max_steps = 0}});
      times.push_back(watch.us());
      if (i < scene.poses.size()) check_interval(checker, scene.name, found, scene.exact(pose).upper);
    }
    text.line("| {} | {} |", scene.name, summarize(std::move(times)).tail());
  }
}

void time_overruns(const std::vector<Scene>& scenes, Checker& checker, Table& text, std::size_t count) {
  text.line("\n## After the deadline\n");
  text.line("How long a query goes on after its deadline, 5 us to 1 ms after its start, in us; {} queries.\n", count);
  text.line("| scene | interrupted | p50 | p99 | p99.9 | p99.99 | max |\n|:--|--:|--:|--:|--:|--:|--:|");
  scenes::Rng rng(42);
  const auto a_deadline = [&] {
    const double us = 5 * std::pow(200, rng.uniform());
    return Clock::now() + std::chrono::nanoseconds(static_cast<std::int64_t>(1000 * us));
  };
  std::vector<double> idle;
  for (std::size_t i = 0; i < count / 10; ++i) {
    const auto deadline = a_deadline();
    while (Clock::now() < deadline) {
    }
    idle.push_back(us_since(deadline));
  }
  text.line("| nothing but the clock | | {} |", summarize(std::move(idle)).tail());
  for (const Scene& scene : scenes) {
    std::vector<double> truths;
    for (const Transform& pose : scene.poses) truths.push_back(scene.exact(pose).upper);
    std::vector<double> late;
    for (std::size_t i = 0; i < count / scenes.size(); ++i) {
      const std::size_t k = i % scene.poses.size();
      const auto deadline = a_deadline();
      const DistanceResult found = distance({scene.a}, {scene.b, scene.poses[k]}, {.budget = {.deadline = deadline}});
      if (found.status == DistanceStatus::interrupted) late.push_back(us_since(deadline));
      check_interval(checker, scene.name, found, truths[k]);
    }
    if (!late.empty()) text.line("| {} | {} | {} |", scene.name, late.size(), summarize(late).tail());
  }
}

void measure_widths(const std::vector<Scene>& scenes, Table& text) {
  text.line("\n## Width of the interval\n");
  text.line(
      "Upper less lower, as a part of lower, after a part of the steps of the exact query; medians over poses.\n");
  text.line("| scene | 1 % | 5 % | 10 % | 20 % | 40 % | 80 % |\n|:--|--:|--:|--:|--:|--:|--:|");
  for (const Scene& scene : scenes) {
    std::string row;
    for (const double part : {0.01, 0.05, 0.1, 0.2, 0.4, 0.8}) {
      std::vector<double> widths;
      for (const Transform& pose : scene.poses) {
        // The least number of steps that is enough.
        std::uint64_t low = 0, high = 1;
        const auto is_enough = [&](std::uint64_t steps) {
          return distance({scene.a}, {scene.b, pose}, {.budget = {.max_steps = steps}}).status !=
                 DistanceStatus::interrupted;
        };
        while (!is_enough(high)) low = high, high *= 2;
        while (high - low > 1) (is_enough((low + high) / 2) ? high : low) = (low + high) / 2;
        const auto steps = static_cast<std::uint64_t>(part * static_cast<double>(high));
        const DistanceResult found = distance({scene.a}, {scene.b, pose}, {.budget = {.max_steps = steps}});
        widths.push_back(found.lower > 0 ? found.upper / found.lower - 1 : 1e9);
      }
      const double width = median(widths);
      row += width > 1e6 ? " unbounded |" : fmt::format(" {:.3g} |", width);
    }
    text.line("| {} |{}", scene.name, row);
  }
}

std::vector<Scene> all_scenes(const std::filesystem::path& meshes, std::size_t poses) {
  std::vector<Scene> all;
  const PeerScene ball = turned_ball_and_square(poses);
  for (const Situation& situation : ball.situations) {
    if (situation.name == "64" || situation.name == "1" || situation.name == "0.01") all.emplace_back(ball, situation);
  }
  if (meshes.empty()) return all;
  const PeerScene scans =
      two_scans("bunny and armadillo", meshes / "stanford-bunny.obj", meshes / "armadillo.obj", poses);
  for (const Situation& situation : scans.situations) all.emplace_back(scans, situation);
  return all;
}

struct Limit {
  std::uint64_t steps = 0;
  std::int64_t us = 0;  // if there is no limit of steps

  std::string name() const { return steps > 0 ? fmt::format("{} steps", steps) : fmt::format("{} us", us); }
  QueryBudget budget() const {
    if (steps > 0) return {.max_steps = steps};
    return {.deadline = Clock::now() + std::chrono::microseconds(us)};
  }
};
constexpr Limit limits[] = {{1, 0}, {50, 0}, {400, 0}, {1600, 0}, {0, 50}, {0, 400}, {0, 2000}};

/// Asks until there is an answer. Returns calls, and node tests as a part of those of the whole query.
std::string ask_to_the_end(const RealTimeScene& scene, const DistanceOptions& options, const Limit& limit,
                           Checker& checker) {
  const Placed a{scene.a}, b{scene.b, scene.pose};
  const DistanceResult whole = distance(a, b, options);
  const double truth = distance(a, b).upper, tolerance = 1e-12 * (1 + truth);
  QueryCache cache;
  DistanceResult last;
  std::uint64_t calls = 0, tests = 0;
  const std::uint64_t most_tests = 2 * whole.stats.node_tests + 16;
  do {
    DistanceOptions limited = options;
    limited.cache = &cache, limited.budget = limit.budget();
    const DistanceResult found = distance(a, b, limited);
    tests += found.stats.node_tests;
    ++calls;
    checker.check(found.lower <= truth + tolerance && found.upper >= truth - tolerance, "{}: [{}, {}] without {}",
                  scene.name, found.lower, found.upper, truth);
    checker.check(calls == 1 || (found.lower >= std::min(last.lower, found.upper) && found.upper <= last.upper),
                  "{}: [{}, {}] after [{}, {}]", scene.name, found.lower, found.upper, last.lower, last.upper);
    last = found;
    // A deadline may cut a pair of leaves short in every call, which is compared again.
    if (!checker.check(tests <= most_tests + (limit.steps > 0 ? 1 : 16) * calls, "{}, {}: {} node tests and no end",
                       scene.name, limit.name(), tests)) {
      return "no end | |";
    }
  } while (last.status == DistanceStatus::interrupted);
  return fmt::format("{} | {:.2f} |", calls, static_cast<double>(tests) / static_cast<double>(whole.stats.node_tests));
}

void ask_all_to_the_end(const std::vector<RealTimeScene>& scenes, Checker& checker, Table& text) {
  text.line("# Queries that are asked until they have their answer\n");
  text.line("Calls, and node tests of all calls over those of one query without a budget; each call also compares the");
  text.line("roots, which counts where a call may make one step.\n");
  std::string head = "| scene | error |", line = "|:--|--:|";
  for (const Limit& limit : limits) head += fmt::format(" {} | tests |", limit.name()), line += "--:|--:|";
  text.line("{}\n{}", head, line);
  for (const RealTimeScene& scene : scenes) {
    for (const double error : {0.0, 0.1}) {
      std::string row;
      for (const Limit& limit : limits) {
        row += fmt::format(" {}", ask_to_the_end(scene, {.relative_error = error}, limit, checker));
      }
      text.line("| {} | {} |{}", scene.name, error, row);
    }
  }
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  std::size_t queries = 100000;
  const auto run = [&](const Options& options, Checker& checker) {
    Table text(options, "deadlines.md");
    const std::vector<Scene> scenes = all_scenes(options.meshes, 20);
    time_first_intervals(scenes, checker, text, options.quick ? 200 : 20000);
    time_overruns(scenes, checker, text, options.quick ? 1000 : queries);
    measure_widths(scenes, text);
    Table endings(options, "endings.md");
    ask_all_to_the_end(real_time_scenes(options.meshes), checker, endings);
  };
  return run_bench(argc, argv, "What queries know when their time is up, and what it takes to the end", run,
                   [&](CLI::App& app) { app.add_option("--queries", queries, "how many with a deadline"); });
}
