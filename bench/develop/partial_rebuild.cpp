// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        Does partial rebuilding keep a tree as good as new while triangles change places, and what does it
//                 cost?
// Workload        Four meshes of about 50 000 triangles in 500 frames of massive motion: a bar that is twisted and
//                 untwisted, a cloth that is crumpled and smoothed, a soup that explodes, a soup whose triangles all
//                 change places. In every frame all vertices move and are committed. Then 32 queries ask for the exact
//                 distance of a ball next to a random vertex, at gaps from a hundredth of a unit to one.
// Metric          Visits (a test of nodes is one, of triangles eight) as a multiple of those of a tree built for the
//                 frame; time of moving and commit as a part of the time to build. Without partial rebuilds, with
//                 rebuilds in commits, and on a worker.
// Expected shape  Without rebuilds, visits grow without limit where triangles change places. With them the ratio stays
//                 near one.
// Checked         Distances equal those of the new tree; the tree is sound at the end.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/motions.h"

namespace limber::bench {
namespace {

struct Scene {
  scenes::Motion motion;
  double ball;  // its radius
};

struct Variant {
  std::string name;
  ModelOptions options;
};

double visits(const QueryStats& stats) {
  return static_cast<double>(stats.node_tests) + 8 * static_cast<double>(stats.triangle_tests);
}

void play(const Scene& scene, const Variant& variant, int frames, Checker& checker, CsvFile& csv, Markdown& table) {
  constexpr int queries = 32;
  const scenes::Motion& motion = scene.motion;
  Model deforming(motion.mesh, variant.options);
  std::vector<Vec3> small = scenes::ball(32, 17).positions();
  for (Vec3& p : small) p *= scene.ball;
  const Model ball(Mesh::create(std::move(small), scenes::ball(32, 17).triangles()).value());
  std::vector<double> ratios, update_us;
  double build_us = 0, all = 0, all_fresh = 0;
  for (int frame = 1; frame <= frames; ++frame) {
    const std::vector<Vec3> positions = motion.positions(frame);
    const Stopwatch updating;
    checker.check(static_cast<bool>(deforming.move_all(positions)), "{}: refused", motion.name);
    deforming.commit();
    update_us.push_back(updating.us());
    Mesh mesh = Mesh::create(positions, motion.mesh.triangles()).value();
    const Stopwatch building;
    const Model fresh(std::move(mesh));
    build_us += building.us();
    scenes::Rng rng(0x5EED0030 + static_cast<std::uint64_t>(frame));
    double sum = 0, fresh_sum = 0;
    for (int i = 0; i < queries; ++i) {
      const Vec3 near = positions[rng.below(positions.size())], outward = scenes::random_rotation(rng).row0;
      const double gap = std::pow(10.0, rng.uniform(-2, 0));
      const Transform pose{scenes::random_rotation(rng), near + outward * (scene.ball + gap)};
      const DistanceResult found = distance({deforming}, {ball, pose}), wanted = distance({fresh}, {ball, pose});
      checker.check(std::abs(found.upper - wanted.upper) <= 1e-12, "{}, frame {}: {} instead of {}", motion.name, frame,
                    found.upper, wanted.upper);
      sum += visits(found.stats), fresh_sum += visits(wanted.stats);
    }
    ratios.push_back(sum / fresh_sum);
    all += sum, all_fresh += fresh_sum;
  }
  checker.check(static_cast<bool>(deforming.validate()), "{}: unsound", motion.name);
  std::sort(ratios.begin(), ratios.end());
  const auto at = [&](double part) { return ratios[static_cast<std::size_t>(part * static_cast<double>(frames - 1))]; };
  double update_sum = 0;
  for (const double us : update_us) update_sum += us;
  const Summary us = summarize(update_us);
  const auto times = static_cast<double>(deforming.maintenance_stats().rebuilt_triangles) /
                     static_cast<double>(motion.mesh.triangles().size());
  table.line("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.0f} | {:.0f} | {:.0f} % | {:.1f} |",
             motion.name, variant.name, all / all_fresh, at(0.5), at(0.9), at(0.99), at(1), us.median, us.max,
             100 * update_sum / build_us, times);
  csv.row("{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.1f},{:.1f},{:.4f},{:.2f}", motion.name, variant.name,
          all / all_fresh, at(0.5), at(0.9), at(0.99), at(1), us.median, us.max, update_sum / build_us, times);
}

int run(const Options& options) {
  const int frames = options.quick ? 20 : 500;
  Checker checker;
  CsvFile csv(options, "develop_partial_rebuild.csv",
              "scene,rebuild_policy,visits,median,p90,p99,worst,commit_median_us,commit_max_us,cost_of_building,times");
  Markdown table(options, "develop_partial_rebuild.md");
  table.line("# Trees under massive motion, as printed by `limber_bench_partial_rebuild`\n");
  table.line(
      "| scene | rebuild | visits, of a new tree's | frame median | p90 | p99 | worst | commit us | longest | cost, of "
      "building | times rebuilt |");
  table.line("|:--|:--|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
  std::vector<Scene> all;
  all.push_back({scenes::twisting_bar(28), 0.3});
  all.push_back({scenes::crumpling_cloth(158), 0.15});
  all.push_back({scenes::exploding_soup(50'000), 0.1});
  all.push_back({scenes::shuffled_soup(50'000), 0.1});
  const Variant variants[] = {{"off", {.rebuild_policy = RebuildPolicy::off}},
                              {"in commits", {}},
                              {"on a worker", {.rebuild_policy = RebuildPolicy::on_worker}}};
  for (const Scene& scene : all) {
    for (const Variant& variant : variants) play(scene, variant, frames, checker, csv, table);
  }
  return checker.all_right() ? 0 : 1;
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  const auto [options, exit_code] =
      limber::bench::parse_options(argc, argv, "Whether partial rebuilds keep a tree as good as new, and their cost");
  return exit_code ? *exit_code : limber::bench::run(options);
}
