// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        Does a model that tunes its motion margin come close to the best margin there is?
// Workload        Five meshes of about 50 000 triangles that deform slowly, as in a loop at 1 kHz, or as fast as in
//                 films, and a ball that circles over or around each. Every frame: move, commit, exact distance.
// Metric          Time of a frame: moving and commit, query, and both; means over the frames.
// Expected shape  A margin pays where steps are small next to triangles, and does harm where they are not.
// Checked         All margins give the same distances.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
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
  std::string name;
  scenes::Motion motion;
  double frames_per_step;
  Vec3 center;
  double around, above;  // path of the ball
  double ball;           // its radius
};

std::vector<Scene> all_scenes() {
  std::vector<Scene> all;
  all.push_back({"waving sheet", scenes::waving_sheet(158, 158), 1, {2, 2, 0}, 1.2, 0.5, 0.25});
  all.push_back({"waving sheet, 1 kHz", scenes::waving_sheet(158, 158), 0.03, {2, 2, 0}, 1.2, 0.5, 0.25});
  all.push_back({"jittering sheet", scenes::jittering_sheet(158, 158, 0.004), 1, {2, 2, 0}, 1.2, 0.4, 0.25});
  all.push_back({"twisting bar, 1 kHz", scenes::twisting_bar(28), 0.03, {0, 0, 0}, 1.5, 1.0, 0.4});
  all.push_back({"crumpling cloth", scenes::crumpling_cloth(158), 1, {0, 0, 0}, 0.4, 0.9, 0.2});
  return all;
}

/// The pose of the ball, which moves slowly along a circle.
Transform ball_pose(const Scene& scene, int step) {
  const double angle = 0.01 * step;
  return {{},
          scene.center + Vec3{scene.around * scenes::cosine(angle), scene.around * scenes::sine(angle), scene.above}};
}

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Variant {
  std::string name;
  std::optional<double> motion_margin;
  double update_us = 0, query_us = 0;
  MaintenanceStats stats;
  std::vector<double> distances;
};

/// Plays the scene; gives up after a while when a frame costs more than `most_us`.
void run_variant(const Scene& scene, Variant& variant, int steps, bool uses_cache, double most_us) {
  Model deforming(scene.motion.mesh, {.motion_margin = variant.motion_margin});
  const Mesh unit_ball = scenes::ball(32, 17);
  std::vector<Vec3> small = unit_ball.positions();
  for (Vec3& p : small) p *= scene.ball;
  const Model ball(Mesh::create(std::move(small), unit_ball.triangles()).value());
  QueryCache cache;
  double update_us = 0, query_us = 0;
  variant.distances.clear();
  std::vector<VertexId> ids;
  std::vector<Vec3> moved;
  for (int step = 1; step <= steps; ++step) {
    const std::vector<Vec3> positions = scene.motion.positions(step * scene.frames_per_step);
    ids.clear(), moved.clear();
    for (VertexId v = 0; v < positions.size(); ++v) {
      if (positions[v] != deforming.mesh().positions()[v]) ids.push_back(v), moved.push_back(positions[v]);
    }
    const Stopwatch updating;
    const Result<void> done =
        2 * ids.size() > positions.size() ? deforming.move_all(positions) : deforming.move_vertices(ids, moved);
    deforming.commit();
    update_us += updating.us();
    const Transform pose = ball_pose(scene, step);
    const Stopwatch asking;
    const DistanceResult found =
        uses_cache ? distance({deforming}, {ball, pose}, {.cache = &cache}) : distance({deforming}, {ball, pose});
    query_us += asking.us();
    variant.distances.push_back(done ? found.upper : -1);
    variant.update_us = update_us / step, variant.query_us = query_us / step;
    if (step >= 40 && update_us + query_us > most_us * step) break;
  }
  variant.stats = deforming.maintenance_stats();
}

int run(const Options& options) {
  const int steps = options.quick ? 40 : 500;
  Checker checker;
  CsvFile csv(options, "develop_motion_margin.csv",
              "scene,motion_margin,update_us,query_us,total_us,refits,absorbed,margin_steps");
  Markdown table(options, "develop_motion_margin.md");
  table.line(
      "# Motion margins, as printed by `limber_bench_motion_margin`: the best of a sweep, and what a model finds");
  for (const Scene& scene : all_scenes()) {
    const std::vector<Vec3> next = scene.motion.positions(scene.frames_per_step * 30);
    const std::vector<Vec3> last = scene.motion.positions(scene.frames_per_step * 29);
    double longest = 0;
    for (std::size_t v = 0; v < next.size(); ++v) longest = std::max(longest, length(next[v] - last[v]));
    std::vector<Variant> variants{{"none", 0, 0, 0, {}, {}}};
    for (const double steps_of_margin : {1., 2., 4., 8., 16., 32.}) {
      variants.push_back({fmt::format("{} steps", steps_of_margin), steps_of_margin * longest, 0, 0, {}, {}});
    }
    variants.push_back({"tuned", ModelOptions::automatic, 0, 0, {}, {}});
    for (const bool uses_cache : {false, true}) {
      double best = infinity;
      table.line(
          "\n### {}, {} triangles, step {:.2g}{}\n\n| motion margin | move, commit us | query us | frame us | of the "
          "best | refits | absorbed | margin now | margin steps a frame |\n|:--|--:|--:|--:|--:|--:|--:|--:|--:|",
          scene.name, scene.motion.mesh.triangles().size(), longest, uses_cache ? ", with a cache" : "");
      for (Variant& v : variants) {
        const bool may_give_up = v.motion_margin > 0;
        run_variant(scene, v, steps, uses_cache, may_give_up ? 4 * best : infinity);
        best = std::min(best, v.update_us + v.query_us);
        for (std::size_t i = 0; i < v.distances.size(); ++i) {
          checker.check(std::abs(v.distances[i] - variants[0].distances[i]) <= 1e-12, "{}, {}: {} instead of {}",
                        scene.name, v.name, v.distances[i], variants[0].distances[i]);
        }
      }
      for (const Variant& v : variants) {
        const double total = v.update_us + v.query_us;
        table.line("| {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} | {} | {} | {:.2g} | {:.0f} |", v.name, v.update_us,
                   v.query_us, total, total / best, v.stats.refits, v.stats.absorbed, v.stats.motion_margin,
                   v.stats.margin_steps / static_cast<double>(v.distances.size()));
        csv.row("{}{},{},{:.2f},{:.2f},{:.2f},{},{},{:.0f}", scene.name, uses_cache ? " cached" : "",
                v.motion_margin ? fmt::format("{}", *v.motion_margin) : "automatic", v.update_us, v.query_us, total,
                v.stats.refits, v.stats.absorbed, v.stats.margin_steps);
      }
    }
  }
  return checker.all_right() ? 0 : 1;
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  const auto [options, exit_code] =
      limber::bench::parse_options(argc, argv, "What motion margins cost, and whether a model finds the best one");
  return exit_code ? *exit_code : limber::bench::run(options);
}
