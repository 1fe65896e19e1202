// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  How fast are this library's queries and builds next to those of other libraries?
// Workload  Ball over square, both turned, 16 poses at each of 17 separations; bunny and armadillo, 50 poses each
//           apart, near and overlapping (needs --meshes). Exact distance, distance within 10 %, collision. The classic
//           engine takes part at ball over square. Builds of sheets and of the bunny.
// Metric    Microseconds a query and their ratio to ours. Hot: the same query at least six times in a row, for at least
//           30 us; once where it takes 10 ms. First: once, after the other libraries have used caches and branch
//           predictors. For a pose the median of 7 rounds, in each of which every library has its turn; over poses
//           minimum, median, 99th percentile. One thread.
// Shape     Ours is an order of magnitude and more faster, at no pose slower.
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/peers/scenes.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/model.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

struct PoseTimes {
  std::vector<double> hot, first;  // one for each pose
};
using Times = std::map<std::string, PoseTimes>;  // by contestant
using Wrong = std::map<std::string, int>;        // poses answered wrongly

Times time_poses(std::vector<Contestant>& contestants, const Situation& situation, Question question, int rounds,
                 Checker& checker, Wrong& wrong) {
  Times times;
  for (const Transform& pose : situation.poses) {
    double ours = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::string> names;
    std::vector<Turn> turns;  // of each a first call, then hot ones
    for (const auto& [name, peer] : contestants) {
      if (!peer->answers(question)) continue;
      peer->move(pose);
      const double answer = peer->ask(question, pose);
      if (names.empty()) ours = answer;
      const bool is_open = question == Question::collide && situation.touching;  // rounding decides
      if (!is_open && !agree(question, ours, answer, 1e-9)) {
        // If two libraries disagree with ours, ours counts as wrong.
        ++wrong[name];
        checker.check(wrong.size() < 2, "{} says {} to {} at {}, not {}", name, answer, to_text(question),
                      situation.name, ours);
      }
      const auto ask = [&peer = *peer, question, &pose] { peer.ask(question, pose); };
      const double once_us = mean_us(1, ask);
      names.push_back(name);
      turns.push_back({ask});
      turns.push_back({ask, once_us < 10'000 ? std::max<std::size_t>(6, repetitions_for(once_us)) : 1});
    }
    const std::vector<double> medians = medians_in_turn(turns, rounds);
    for (std::size_t i = 0; i < names.size(); ++i) {
      times[names[i]].first.push_back(medians[2 * i]);
      times[names[i]].hot.push_back(medians[2 * i + 1]);
    }
  }
  return times;
}

void report(const Situation& situation, Question question, const Times& times, const Wrong& wrong,
            const std::vector<Contestant>& contestants, Table& table) {
  const PoseTimes& ours = times.at(contestants.front().name);
  const Summary own = summarize(ours.hot);
  for (const Contestant& contestant : contestants) {
    if (!times.contains(contestant.name)) continue;
    if (const auto it = wrong.find(contestant.name); it != wrong.end()) {
      table.line("| {} | {} | {} | wrong in {} poses | | | | | | | |", situation.name, to_text(question),
                 contestant.name, it->second);
      continue;
    }
    const PoseTimes& theirs = times.at(contestant.name);
    const Summary summary = summarize(theirs.hot);
    const double first = median(theirs.first);
    double least_ratio = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < theirs.hot.size(); ++p) {
      least_ratio = std::min(least_ratio, theirs.hot[p] / ours.hot[p]);
    }
    const double numbers[] = {summary.min,           summary.median, summary.p99, summary.median / own.median,
                              summary.p99 / own.p99, least_ratio,    first,       first / median(ours.first)};
    table.line("| {} | {} | {} | {:.3g} |", situation.name, to_text(question), contestant.name,
               fmt::join(numbers, " | "));
  }
}

void compare(const PeerScene& scene, std::vector<Contestant> contestants, int rounds, Checker& checker, Table& table) {
  table.line("\n### {}\n", scene.name);
  table.line(
      "| situation | query | library | min us | median us | p99 us | ratio of medians | of p99 | least, one pose | "
      "first, median us | ratio |");
  table.line("|:--|:--|:--|--:|--:|--:|--:|--:|--:|--:|--:|");
  for (const Question question : {Question::exact, Question::rough, Question::collide}) {
    for (const Situation& situation : scene.situations) {
      Wrong wrong;
      const Times times = time_poses(contestants, situation, question, rounds, checker, wrong);
      if (checker.all_right()) report(situation, question, times, wrong, contestants, table);
    }
  }
}

double build_us(const Mesh& mesh) {
  Mesh copy = mesh;
  return mean_us(1, [&] { const Model model(std::move(copy)); });
}

void compare_builds(const std::string& name, const Mesh& mesh, int rounds, Table& table) {
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const std::pair<const char*, std::function<double()>> builders[] = {
      {"limber", [&] { return build_us(mesh); }},
#ifdef LIMBER_PEER_EMBREE
      {"Embree Morton", [&] { return embree_morton_build_us(mesh); }},
      {"Embree SAH", [&] { return embree_sah_build_us(mesh); }},
#endif
#ifdef LIMBER_PEER_FCL
      {"FCL OBBRSS", [&] { return fcl_build_us(mesh); }},
#endif
  };
  const auto triangles = static_cast<double>(mesh.triangles().size());
  std::vector<std::vector<double>> ns(std::size(builders));
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < ns.size(); ++i) ns[i].push_back(builders[i].second() * 1e3 / triangles);
  }
  for (std::size_t i = 0; i < ns.size(); ++i) {
    const std::string cells = i == 0 ? fmt::format("{} | {}", name, triangles) : " |";
    table.line("| {} | {} | {:.4g} | {:.3g} |", cells, builders[i].first, median(ns[i]), median(ns[i]) / median(ns[0]));
  }
  const double bytes = static_cast<double>(Model(mesh).tree_stats().bytes) / triangles;
  table.line("| | | bytes a triangle | {:.3g} | |", bytes);
}

void run(const Options& options, Checker& checker) {
  Table table(options, "peers.md");
  table.line("# Next to other libraries, as printed by `limber_bench_peers`");
  const int rounds = options.quick ? 1 : 7;
  const PeerScene ball = turned_ball_and_square(options.quick ? 2 : 16);
  compare(ball, all_peers(ball.a, ball.b, true), rounds, checker, table);
  if (options.meshes.empty()) return;
  const PeerScene scans = two_scans("bunny and armadillo", options.meshes / "stanford-bunny.obj",
                                    options.meshes / "armadillo.obj", options.quick ? 2 : 50);
  compare(scans, all_peers(scans.a, scans.b), rounds, checker, table);
  table.line("\n### Build, nanoseconds a triangle, medians; libraries in turn\n");
  table.line("| mesh | triangles | library | ns | times ours |");
  table.line("|:--|--:|:--|--:|--:|");
  const int builds = options.quick ? 1 : 21;
  compare_builds("sheet", scenes::wave_sheet(125, 80, 0), builds, table);
  compare_builds("bunny", scans.a, builds, table);
  compare_builds("sheet", scenes::wave_sheet(400, 250, 0), builds, table);
  compare_builds("sheet", scenes::wave_sheet(1250, 800, 0), options.quick ? 1 : 5, table);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "How fast are queries and builds next to those of other libraries?",
                                  limber::bench::run);
}
