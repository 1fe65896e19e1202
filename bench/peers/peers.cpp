// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  How fast are this library's queries next to those of other libraries?
// Workload  Ball over square, both turned, 16 poses at each of 17 separations; bunny and armadillo, 50 poses each
//           apart, near and overlapping (needs --meshes). Exact distance, distance within 10 %, collision. The classic
//           engine takes part at ball over square.
// Metric    Microseconds a query and their ratio to ours. Hot: the same query at least six times in a row, for at least
//           30 us; once where it takes 10 ms. First: once, after the other libraries have used caches and branch
//           predictors. For a pose the median of 7 rounds, in each of which every library has its turn; over poses
//           minimum, median, 99th percentile. One thread.
// Shape     Ours is an order of magnitude and more faster, at no pose slower.
#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <map>

#include "bench/peers/more.h"
#include "bench/peers/peer.h"
#include "bench/peers/scenes_of_peers.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"

namespace limber::bench {
namespace {

const char* to_text(Question question) {
  return question == Question::exact ? "distance" : question == Question::rough ? "within 10 %" : "collide";
}

struct Contestant {
  std::string name;
  std::unique_ptr<Peer> peer;
};

/// Whether an answer agrees with ours.
bool agrees(Question question, double ours, double theirs, bool touching) {
  if (question == Question::collide) return touching || ours == theirs;
  if (question == Question::exact) return std::abs(ours - theirs) <= 1e-9;
  // Both are within the error of the true distance.
  return ours <= theirs * (1 + rough_error) + 1e-9 && theirs <= ours * (1 + rough_error) + 1e-9;
}

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
    std::vector<std::vector<double>> samples(contestants.size()), firsts(contestants.size());
    std::vector<std::size_t> repetitions(contestants.size(), 0);
    for (std::size_t c = 0; c < contestants.size(); ++c) {
      Peer& peer = *contestants[c].peer;
      if (!peer.answers(question)) continue;
      peer.move(pose);
      const double answer = peer.ask(question, pose);
      if (c == 0) ours = answer;
      if (!agrees(question, ours, answer, situation.touching)) {
        // If two libraries disagree with ours, ours counts as wrong.
        ++wrong[contestants[c].name];
        checker.check(wrong.size() < 2, "{} says {} to {} at {}, not {}", contestants[c].name, answer,
                      to_text(question), situation.name, ours);
      }
      const double once_us = mean_us(1, [&] { peer.ask(question, pose); });
      repetitions[c] = once_us < 10'000 ? std::max<std::size_t>(6, repetitions_for(once_us)) : 1;
    }
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t c = 0; c < contestants.size(); ++c) {
        if (repetitions[c] == 0) continue;
        firsts[c].push_back(mean_us(1, [&] { contestants[c].peer->ask(question, pose); }));
        samples[c].push_back(mean_us(repetitions[c], [&] { contestants[c].peer->ask(question, pose); }));
      }
    }
    for (std::size_t c = 0; c < contestants.size(); ++c) {
      if (repetitions[c] == 0) continue;
      times[contestants[c].name].hot.push_back(summarize(samples[c]).median);
      times[contestants[c].name].first.push_back(summarize(firsts[c]).median);
    }
  }
  return times;
}

void report(const PeerScene& scene, const Situation& situation, Question question, const Times& times,
            const Wrong& wrong, const std::vector<Contestant>& contestants, CsvFile& csv, Markdown& table) {
  const PoseTimes& ours = times.at(contestants.front().name);
  const Summary own = summarize(ours.hot), own_first = summarize(ours.first);
  for (const Contestant& contestant : contestants) {
    if (!times.contains(contestant.name)) continue;
    if (const auto it = wrong.find(contestant.name); it != wrong.end()) {
      table.line("| {} | {} | {} | wrong in {} poses | | | | | | | |", situation.name, to_text(question),
                 contestant.name, it->second);
      continue;
    }
    const PoseTimes& theirs = times.at(contestant.name);
    const Summary summary = summarize(theirs.hot), first = summarize(theirs.first);
    double least_ratio = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < theirs.hot.size(); ++p) {
      least_ratio = std::min(least_ratio, theirs.hot[p] / ours.hot[p]);
    }
    csv.row("{},{},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}", scene.name, situation.name,
            to_text(question), contestant.name, summary.min, summary.median, summary.p99, summary.median / own.median,
            summary.p99 / own.p99, least_ratio, first.median, first.median / own_first.median);
    table.line("| {} | {} | {} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} |",
               situation.name, to_text(question), contestant.name, summary.min, summary.median, summary.p99,
               summary.median / own.median, summary.p99 / own.p99, least_ratio, first.median,
               first.median / own_first.median);
  }
}

void compare(const PeerScene& scene, const std::vector<std::pair<std::string, PeerFactory>>& peers, int rounds,
             Checker& checker, CsvFile& csv, Markdown& table) {
  std::vector<Contestant> contestants;
  for (const auto& [name, make] : peers) contestants.push_back({name, make(scene.a, scene.b)});
  table.line("\n### {}\n", scene.name);
  table.line(
      "| situation | query | library | min us | median us | p99 us | ratio of medians | of p99 | least, one pose | "
      "first, median us | ratio |");
  table.line("|:--|:--|:--|--:|--:|--:|--:|--:|--:|--:|--:|");
  for (const Question question : {Question::exact, Question::rough, Question::collide}) {
    for (const Situation& situation : scene.situations) {
      Wrong wrong;
      const Times times = time_poses(contestants, situation, question, rounds, checker, wrong);
      if (checker.all_right()) report(scene, situation, question, times, wrong, contestants, csv, table);
    }
  }
}

int run(const Options& options, const std::filesystem::path& meshes) {
  report_machine(options);
  Checker checker;
  CsvFile csv(options, "peers_queries.csv",
              "scene,situation,query,library,min_us,median_us,p99_us,ratio_median,ratio_p99,ratio_least,"
              "first_median_us,first_ratio");
  Markdown table(options, "peers.md");
  table.line("# Next to other libraries, as printed by `limber_bench_peers`");
  const int rounds = options.quick ? 1 : 7;
  compare(turned_ball_and_square(options.quick ? 2 : 16), all_peers_and_classic(), rounds, checker, csv, table);
  if (!meshes.empty()) {
    compare(two_scans("bunny and armadillo", meshes / "stanford-bunny.obj", meshes / "armadillo.obj",
                      options.quick ? 2 : 50),
            all_peers(), rounds, checker, csv, table);
    measure_more(options, meshes, checker, table);
  }
  return checker.all_right() ? 0 : 1;
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  CLI::App app{"How fast are queries next to those of other libraries?"};
  limber::bench::Options options;
  std::filesystem::path meshes;
  app.add_option("--out", options.out, "folder for results; default: only the console");
  app.add_option("--meshes", meshes, "folder with stanford-bunny.obj and armadillo.obj; default: no scans");
  app.add_flag("--quick", options.quick, "few poses and rounds: shows that everything works");
  CLI11_PARSE(app, argc, argv);
  try {
    if (!options.out.empty()) std::filesystem::create_directories(options.out);
    return limber::bench::run(options, meshes);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
