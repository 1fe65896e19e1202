// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What does it cost to keep the tree of a deforming mesh up to date, next to other libraries?
// Workload        Waving sheets of 20 000, 200 000 and 2 000 000 triangles, of which every frame moves all vertices.
//                 The sheet of 200 000 with a distance to a ball in every frame.
// Metric          Nanoseconds a triangle, moving the vertices included; milliseconds a frame; medians over rounds in
//                 which all libraries take turns.
// Expected shape  Ours costs a third of a ray tracer's refit, a fifth of that of FCL's boxes, and about a hundredth of
//                 those of oriented boxes.
// Checked         Distances of all libraries in every frame; the table counts the wrong ones.
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "scenes/motions.h"

namespace limber::bench {
namespace {

struct Times {
  std::vector<double> update_us, query_us;
  int wrong = 0;
};

void full_refits(std::uint32_t nx, std::uint32_t ny, int rounds, Checker& checker, Table& table) {
  const scenes::Motion sheet = scenes::waving_sheet(nx, ny);
  const auto count = static_cast<double>(sheet.mesh.triangles().size());
  const std::vector<Contestant> contestants = deforming_peers(sheet.mesh, scenes::thesis_ball());
  std::vector<std::vector<double>> ns(contestants.size());  // a triangle
  for (int round = 1; round <= rounds; ++round) {
    const std::vector<Vec3> positions = sheet.positions(round);
    for (std::size_t i = 0; i < ns.size(); ++i) {
      // A few rounds are enough for the slow libraries.
      if (round > 3 && median(ns[i]) > 500) continue;
      const auto deform = [&] {
        checker.check(contestants[i].peer->deform(positions), "{} refuses", contestants[i].name);
      };
      ns[i].push_back(mean_us(1, deform) * 1e3 / count);
    }
  }
  for (std::size_t i = 0; i < ns.size(); ++i) {
    const Summary summary = summarize(ns[i]);
    table.line("| {} | {} | {:.3g} | {:.3g} | {:.3g} |", count, contestants[i].name, summary.min, summary.median,
               summary.median / median(ns[0]));
  }
}

/// Every frame moves all vertices and asks for an exact distance of a ball that goes round above the sheet.
void frames_with_queries(std::uint32_t nx, std::uint32_t ny, int frames, Checker& checker, Table& table) {
  const scenes::Motion motion = scenes::waving_sheet(nx, ny);
  table.line("\n### {}, {} triangles: all vertices moved, exact distance; ms\n", motion.name,
             motion.mesh.triangles().size());
  table.line(
      "| library | update | query | frame, median | p99 | times ours | wrong answers |\n|:--|--:|--:|--:|--:|--:|--:|");
  std::vector<Contestant> contestants = deforming_peers(motion.mesh, scenes::thesis_ball());
  std::erase_if(contestants, [](const Contestant& c) { return !c.peer->answers(Question::exact); });
  std::vector<Times> times(contestants.size());
  for (int frame = 1; frame <= frames; ++frame) {
    const std::vector<Vec3> positions = motion.positions(frame);
    const Transform pose{{}, {2 + scenes::cosine(0.05 * frame), 1.25 + 0.7 * scenes::sine(0.05 * frame), 1.3}};
    double truth = 0;
    for (std::size_t i = 0; i < (frame > 10 ? 1 : contestants.size()); ++i) {
      const auto& [name, peer] = contestants[i];
      const Stopwatch update;
      checker.check(peer->deform(positions), "{} cannot deform", name);
      times[i].update_us.push_back(update.us());
      const Stopwatch asking;
      const double found = peer->ask(Question::exact, pose);
      times[i].query_us.push_back(asking.us());
      if (i == 0) truth = found;
      if (std::abs(found - truth) > 1e-9) ++times[i].wrong;
    }
  }
  double ours = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto& [update_us, query_us, wrong] = times[i];
    std::vector<double> frame_us = update_us;
    for (std::size_t k = 0; k < frame_us.size(); ++k) frame_us[k] += query_us[k];
    const Summary us = summarize(frame_us);
    if (i == 0) ours = us.median;
    table.line("| {} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {} of {} |", contestants[i].name,
               median(update_us) * 1e-3, median(query_us) * 1e-3, us.median * 1e-3, us.p99 * 1e-3, us.median / ours,
               wrong, frame_us.size());
  }
  // Tests compare our distances with brute force. Here another library has to agree with them.
  checker.check(times.size() == 1 || std::any_of(times.begin() + 1, times.end(),
                                                 [](const Times& of_peer) { return of_peer.wrong == 0; }),
                "no other library agrees");
}

void run(const Options& options, Checker& checker) {
  Table table(options, "deforming.md");
  const int rounds = options.quick ? 4 : 41;
  table.line("# Keeping trees of deforming meshes, as printed by `limber_bench_deforming`");
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  table.line("\n### All vertices: ns a triangle, moving them included\n");
  table.line("| triangles | library | least | median | times ours |\n|--:|:--|--:|--:|--:|");
  full_refits(100, 100, rounds, checker, table);
  full_refits(400, 250, rounds, checker, table);
  if (!options.quick) full_refits(1000, 1000, rounds / 3, checker, table);
  frames_with_queries(400, 250, options.quick ? 3 : 100, checker, table);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "What does it cost to keep the tree of a deforming mesh up to date?",
                                  limber::bench::run);
}
