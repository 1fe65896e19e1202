// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        How long does it take to find how far moving meshes can go, next to the IPC Toolkit?
// Workload        Two consecutive frames of a cloth on a ball (92 230 triangles) and of a soft body between rollers
//                 (24 242): each mesh with itself, vertices on straight lines. A bunny that flies past or into an
//                 armadillo and turns, 100 paths. Pairs of moving elements of every kind that the tests know, 4 000
//                 of each.
// Metric          Milliseconds, medians of up to 15 runs, one thread: all vertices to the first frame and a commit, the
//                 motion to the second, the first impact; then all impacts. Microseconds a pair, mean and most. The IPC
//                 Toolkit, measured by ipc_steps.py: candidates by its fastest broad phase, and the step by ACCD and by
//                 Tight-Inclusion. FCL on the rigid paths: its conservative advancement, and collisions at 100 and 1000
//                 times.
// Expected shape  20 times as fast as the IPC Toolkit with ACCD. All impacts at most 3 times the first one. A pair that
//                 does not touch 150 ns; the worst kinds 2 us on average.
// Checked         The first impact is the earliest of all impacts. Steps of the IPC Toolkit end before it: those that
//                 do not are told. At the time of a rigid impact the models are as near as they should be.
#include <oneapi/tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "bench/contacts/answers.h"
#include "bench/motion/rigid_paths.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/io.h"
#include "limber/limber.h"
#include "support/random_motion.h"

namespace limber::bench {
namespace {

/// Median milliseconds of a call: 15 runs, or fewer that take two seconds.
template <typename Call>
double median_ms(bool quick, const Call& call) {
  std::vector<double> us;
  double sum = 0;
  while (us.size() < (quick ? 2 : 15) && sum < 2e6) us.push_back(mean_us(1, call)), sum += us.back();
  return 1e-3 * median(us);
}

void compare_frames(const std::string& name, const Mesh& first, const std::vector<Vec3>& second,
                    const std::vector<PeerRow>& peers, bool quick, Checker& checker, Table& table) {
  Model model(first);
  MovingModel moving(model);
  const ImpactOptions options{.ignore_crossings = true};
  ImpactResult found;
  const double commit_ms = median_ms(quick, [&] { model.move_all(first.positions()).value(), model.commit(); });
  const double motion_ms = median_ms(quick, [&] { moving.set_motion(second).value(); });
  const double first_ms = median_ms(quick, [&] { found = self_time_of_impact(moving, options); });
  double earliest = std::numeric_limits<double>::infinity();
  PairCount all;
  const auto all_ms = [&](double time_error) {
    const ImpactOptions within{.time_error = time_error};
    return median_ms(quick, [&] {
      all = visit_self_impacts(
          moving,
          [&](const Impact& i) {
            earliest = std::min(earliest, i.time.upper);
            return true;
          },
          within);
    });
  };
  const double rough_ms = all_ms(1e-6), exact_ms = all_ms(0);
  checker.check(found.lower <= earliest && earliest <= found.upper, "{}: the first impact is not the earliest", name);
  const double ours = commit_ms + motion_ms + first_ms;
  table.line("\n## {}\n", name);
  table.line("The first impact is at {:.17g}; {} pairs of elements touch.\n", found.upper, all.count);
  table.line("| what | ms | over the first impact with commit and motion |\n|:--|--:|--:|");
  table.line("| all vertices moved, commit | {:.1f} | |", commit_ms);
  table.line("| motion set | {:.1f} | |", motion_ms);
  table.line("| first impact | {:.1f} | {:.2f} |", first_ms, first_ms / ours);
  table.line("| all impacts, times within 1e-6 | {:.0f} | {:.2f} |", rough_ms, rough_ms / ours);
  table.line("| all impacts | {:.0f} | {:.2f} |", exact_ms, exact_ms / ours);
  double candidates_us = std::numeric_limits<double>::infinity();
  for (const PeerRow& row : peers) {
    if (row.mesh == name && row.question.starts_with("candidates")) candidates_us = std::min(candidates_us, row.us);
  }
  for (const PeerRow& row : peers) {
    if (row.mesh != name || !row.question.starts_with("step")) continue;
    const double ms = 1e-3 * (candidates_us + row.us), step = std::atof(row.details.c_str());
    table.line("| IPC Toolkit, candidates and {}: {:.6g}{} | {:.0f} | {:.1f} |", row.question, step,
               step > found.upper ? " (late)" : "", ms, ms / ours);
  }
}

void time_elements(bool quick, Table& table) {
  using namespace testing;
  table.line("\n## Pairs of elements\n");
  table.line("| kind | touch, % | mean of those, us | mean of the others, us | most, us |\n|:--|--:|--:|--:|--:|");
  for (int k = 0; k < static_cast<int>(MotionKind::count); ++k) {
    const auto kind = static_cast<MotionKind>(k);
    Rng rng(500 + static_cast<std::uint64_t>(k));
    double sum[2] = {0, 0}, most = 0;
    int count[2] = {0, 0};
    for (int i = 0; i < (quick ? 100 : 4000); ++i) {
      const bool is_face = rng.below(2) == 0;
      const MovingCorners m = random_motion(rng, kind, is_face);
      const auto ask = [&] {
        const Vec3 *const p = m.start, *const q = m.end;
        if (is_face) {
          return time_of_impact(MovingPoint{p[0], q[0]}, MovingTriangle{{p[1], p[2], p[3]}, {q[1], q[2], q[3]}});
        }
        return time_of_impact(MovingSegment{{p[0], p[1]}, {q[0], q[1]}}, MovingSegment{{p[2], p[3]}, {q[2], q[3]}});
      };
      const bool touches = ask().status != ImpactStatus::clear;
      const std::size_t repetitions = quick ? 1 : repetitions_for(mean_us(1, ask));
      const double us = mean_us(repetitions, ask);
      sum[touches ? 1 : 0] += us, ++count[touches ? 1 : 0], most = std::max(most, us);
    }
    std::ostringstream name;
    PrintTo(kind, &name);
    const auto mean_of = [&](int which) {
      return count[which] == 0 ? std::string() : fmt::format("{:.2f}", sum[which] / count[which]);
    };
    table.line("| {} | {:.0f} | {} | {} | {:.0f} |", name.str(), 100.0 * count[1] / (count[0] + count[1]), mean_of(1),
               mean_of(0), most);
  }
}

void run(const Options& options, const std::filesystem::path& csv, Checker& checker) {
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<PeerRow> peers = read_peer_rows(csv);
  Table table(options, "motion.md");
  table.line("# How far moving meshes can go, as printed by `limber_bench_motion`");
  const char* const frames[][3] = {{"cloth_ball", "cloth_ball_92.ply", "cloth_ball_93.ply"},
                                   {"armadillo_rollers", "armadillo_rollers_326.ply", "armadillo_rollers_327.ply"}};
  for (const auto& [name, first, second] : frames) {
    if (options.meshes.empty()) break;
    const Mesh end = load_mesh(options.meshes / second).value();
    compare_frames(name, load_mesh(options.meshes / first).value(), end.positions(), peers, options.quick, checker,
                   table);
  }
  if (!options.meshes.empty()) compare_rigid_paths(options, checker, table);
  time_elements(options.quick, table);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  std::filesystem::path peers;
  return run_bench(
      argc, argv, "How long does it take to find how far moving meshes can go?",
      [&](const Options& options, Checker& checker) { run(options, peers, checker); },
      [&](CLI::App& app) {
        app.add_option("--peers", peers, "motion_peers.csv, written by ipc_steps.py; default: no other library");
      });
}
