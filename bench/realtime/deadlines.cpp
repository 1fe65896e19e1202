// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What does a query know when its time is up, and how late is it then?
// Workload        Scans beside each other and the source's ball over its square, near and far apart.
// Metric          Time of a query that may make no step. How long queries go on after deadlines from 5 us to 1 ms, next
//                 to a loop that does nothing but look at the clock. Width of the interval after parts of the steps of
//                 the exact query.
// Expected shape  Overruns of a few us, until the machine itself interrupts. Widths that shrink quickly.
// Checked         Every interval holds the exact distance.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/peers/scenes.h"
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

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  const auto run = [](const Options& options, Checker& checker) {
    Table text(options, "deadlines.md");
    const std::vector<Scene> scenes = all_scenes(options.meshes, 20);
    time_first_intervals(scenes, checker, text, options.quick ? 200 : 20000);
    time_overruns(scenes, checker, text, options.quick ? 1000 : 100'000);
    measure_widths(scenes, text);
  };
  return run_bench(argc, argv, "What queries know when their time is up", run);
}
