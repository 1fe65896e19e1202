// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What does it cost to keep the tree of a deforming mesh up to date, next to other libraries?
// Workload        Waving sheets of 20 000, 200 000 and 2 000 000 triangles. Every frame moves all vertices, and asks
//                 for the exact distance of a ball that goes round above the sheet.
// Metric          Nanoseconds a triangle, moving the vertices included; microseconds a query; over frames in which all
//                 libraries take turns.
// Expected shape  Ours costs a third of a ray tracer's refit, a fifth of that of FCL's boxes, and about a hundredth of
//                 those of oriented boxes.
// Checked         Distances of all libraries in every frame; the table counts the wrong ones, and one other library has
//                 none.
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
  std::vector<double> update_ns, query_us;  // of an update a triangle
  int wrong = 0;
};

void compare(std::uint32_t nx, std::uint32_t ny, int frames, Checker& checker, Table& table) {
  const scenes::Motion sheet = scenes::waving_sheet(nx, ny);
  const auto count = static_cast<double>(sheet.mesh.triangles().size());
  const std::vector<Contestant> contestants = deforming_peers(sheet.mesh, scenes::thesis_ball());
  std::vector<Times> times(contestants.size());
  for (int frame = 1; frame <= frames; ++frame) {
    const std::vector<Vec3> positions = sheet.positions(frame);
    const Transform pose{{}, {2 + scenes::cosine(0.05 * frame), 1.25 + 0.7 * scenes::sine(0.05 * frame), 1.3}};
    double truth = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const auto& [name, peer] = contestants[i];
      auto& [update_ns, query_us, wrong] = times[i];
      if (frame > 3 && median(update_ns) > 500) continue;  // a few are enough for the slow libraries
      const double us = mean_us(1, [&] { checker.check(peer->deform(positions), "{} refuses", name); });
      update_ns.push_back(us * 1e3 / count);
      if (!peer->answers(Question::exact)) continue;
      double found = 0;
      query_us.push_back(mean_us(1, [&] { found = peer->ask(Question::exact, pose); }));
      if (i == 0) truth = found;
      if (std::abs(found - truth) > 1e-9) ++wrong;
    }
  }
  // Tests compare our distances with brute force. Here another library has to agree with them.
  checker.check(times.size() == 1 || std::any_of(times.begin() + 1, times.end(),
                                                 [](const Times& t) { return t.wrong == 0 && !t.query_us.empty(); }),
                "no other library agrees");
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto& [update_ns, query_us, wrong] = times[i];
    const Summary ns = summarize(update_ns);
    table.line("| {} | {} | {:.3g} | {:.3g} | {:.3g} | {} |", count, contestants[i].name, ns.min, ns.median,
               ns.median / median(times[0].update_ns),
               query_us.empty() ? "|" : fmt::format("{:.3g} | {} of {}", median(query_us), wrong, query_us.size()));
  }
}

void run(const Options& options, Checker& checker) {
  Table table(options, "deforming.md");
  const int frames = options.quick ? 4 : 41;
  table.line("# Keeping trees of deforming meshes, as printed by `limber_bench_deforming`");
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  table.line("\n### All vertices: ns a triangle, moving them included\n");
  table.line("| triangles | library | least | median | times ours | query, us | wrong answers |");
  table.line("|--:|:--|--:|--:|--:|--:|--:|");
  compare(100, 100, frames, checker, table);
  compare(400, 250, frames, checker, table);
  if (!options.quick) compare(1000, 1000, frames / 3, checker, table);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "What does it cost to keep the tree of a deforming mesh up to date?",
                                  limber::bench::run);
}
