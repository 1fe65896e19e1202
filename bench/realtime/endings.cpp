// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        How many calls and how much work does it take until a query that is asked again and again at rest has
//                 its answer?
// Workload        All scenes of real_time_scenes.h; budgets of 1 step to 1600, and of 50 us to 2 ms.
// Metric          Calls; node tests of all calls over those of one query without budget and cache.
// Expected shape  As many calls as the work needs, at most twice the node tests and one a call.
// Checked         Every query ends within that, intervals hold the distance, and none is wider than the one before.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>

#include "bench/realtime/real_time_scenes.h"
#include "bench/support/report.h"
#include "limber/distance.h"

namespace limber::bench {
namespace {

using Clock = std::chrono::steady_clock;

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
  } while (last.status == Status::interrupted);
  return fmt::format("{} | {:.2f} |", calls, static_cast<double>(tests) / static_cast<double>(whole.stats.node_tests));
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  CLI::App app{"How much work it takes to get an answer within a budget a call"};
  Options options;
  std::string meshes;
  app.add_option("--out", options.out, "folder for the results");
  app.add_option("--meshes", meshes, "folder with stanford-bunny.obj and armadillo.obj");
  CLI11_PARSE(app, argc, argv);
  Checker checker;
  Markdown text(options, "endings.md");
  text.line("# Queries that are asked until they have their answer\n");
  text.line("Calls, and node tests of all calls over those of one query without a budget; each call also compares the");
  text.line("roots, which counts where a call may make one step.\n");
  std::string head = "| scene | error |", line = "|:--|--:|";
  for (const Limit& limit : limits) head += fmt::format(" {} | tests |", limit.name()), line += "--:|--:|";
  text.line("{}\n{}", head, line);
  for (const RealTimeScene& scene : real_time_scenes(meshes)) {
    for (const double error : {0.0, 0.1}) {
      std::string row;
      for (const Limit& limit : limits)
        row += fmt::format(" {}", ask_to_the_end(scene, {.relative_error = error}, limit, checker));
      text.line("| {} | {} |{}", scene.name, error, row);
    }
  }
  return checker.all_right() ? 0 : 1;
}
