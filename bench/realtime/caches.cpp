// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What does a query with a kept cache cost, next to one without?
// Workload        All scenes of scenes.h, at rest, along paths of small and large steps, and at poses that
//                 have nothing in common; exact distance, distance within 10 %, collision, and whether the models are
//                 closer than 0.9 and 1.1 times their distance at first.
// Metric          The least time of each pose over several walks along the path, added up; with a cache over without.
// Expected shape  At most 1.1 everywhere, less than 1 where poses have much in common, a small part of it at rest.
// Checked         Exact distances and answers of yes and no are the same with and without a cache.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/realtime/scenes.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/distance.h"

namespace limber::bench {
namespace {

enum class Question { exact, within_10_percent, collide, closer_than_0_9, closer_than_1_1 };
constexpr Question questions[] = {Question::exact, Question::within_10_percent, Question::collide,
                                  Question::closer_than_0_9, Question::closer_than_1_1};
constexpr const char* names[] = {"exact", "10 %", "collide", "within 0.9", "within 1.1"};

/// The answer as a number: a distance, or 1 for yes.
double ask(Question question, const Placed& a, const Placed& b, double first, QueryCache* cache) {
  const auto limit = first * (question == Question::closer_than_0_9 ? 0.9 : 1.1);
  switch (question) {
    case Question::exact:
      return distance(a, b, {.cache = cache}).upper;
    case Question::within_10_percent:
      return distance(a, b, {.relative_error = 0.1, .cache = cache}).upper;
    case Question::collide:
      return collide(a, b, {.cache = cache}).is_yes() ? 1 : 0;
    default:
      return within(a, b, limit, {.cache = cache}).is_yes() ? 1 : 0;
  }
}

struct Row {
  std::string text;
  double ratio, without_us, with_us;
};

Row compare(const RealTimeScene& scene, const std::string& path_name, const std::vector<Transform>& path,
            Question question, Checker& checker) {
  const double first = distance({scene.a}, {scene.b, path.front()}).upper;
  constexpr int walks = 5;
  std::vector<double> least[2] = {std::vector<double>(path.size(), 1e300), std::vector<double>(path.size(), 1e300)};
  for (int walk = 0; walk < walks; ++walk) {
    QueryCache cache;
    for (std::size_t i = 0; i < path.size(); ++i) {
      double answers[2];
      for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t kept = (k + i) % 2;  // in turn the first
        const Stopwatch watch;
        answers[kept] = ask(question, {scene.a}, {scene.b, path[i]}, first, kept == 1 ? &cache : nullptr);
        least[kept][i] = std::min(least[kept][i], watch.us());
      }
      const double tolerance = question == Question::within_10_percent ? 0.1 * answers[0] : 1e-12 * (1 + answers[0]);
      checker.check(std::abs(answers[1] - answers[0]) <= tolerance, "{}, {}, {}: {} but with a cache {}", scene.name,
                    path_name, names[static_cast<std::size_t>(question)], answers[0], answers[1]);
    }
  }
  // The first query has nothing to start from.
  double sums[2];
  for (std::size_t kept = 0; kept < 2; ++kept) sums[kept] = mean({least[kept].begin() + 1, least[kept].end()});
  return {fmt::format("{} | {} | {}", scene.name, path_name, names[static_cast<std::size_t>(question)]),
          sums[1] / sums[0], sums[0], sums[1]};
}

void run(const Options& options, const std::string& only, std::size_t frames, Checker& checker) {
  Table text(options, "caches.md");
  std::vector<Row> rows;
  for (const RealTimeScene& scene : real_time_scenes(options.meshes)) {
    if (scene.name.find(only) == std::string::npos) continue;
    std::vector<std::pair<std::string, std::vector<Transform>>> paths{{"rest", {frames, scene.pose}}};
    for (const double step : {1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.0}) {
      paths.emplace_back(step > 0 ? fmt::format("{}", step) : "unrelated", real_time_path(scene, step, frames));
    }
    for (const auto& [name, path] : paths) {
      for (const Question question : questions) rows.push_back(compare(scene, name, path, question, checker));
    }
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.ratio > b.ratio; });
  const auto above = std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.ratio > 1.1; });
  text.line("# Queries with a kept cache\n");
  text.line("{} scenes × paths × queries, worst first; {} cost more than 1.1 times a query without a cache. Motion a",
            rows.size(), above);
  text.line("frame is a part of the size; times are means in us.\n");
  text.line("| scene | motion | query | without | with | with / without |\n|:--|:--|:--|--:|--:|--:|");
  for (const Row& row : rows) {
    text.line("| {} | {:.2f} | {:.2f} | {:.2f} |", row.text, row.without_us, row.with_us, row.ratio);
  }
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  std::string only;
  std::size_t frames = 120;
  return run_bench(
      argc, argv, "What a kept cache saves or costs",
      [&](const Options& options, Checker& checker) { run(options, only, frames, checker); },
      [&](CLI::App& app) {
        app.add_option("--frames", frames, "poses of a path")->check(CLI::Range(2, 100000));
        app.add_option("--only", only, "scenes whose names contain this");
      });
}
