// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What does a distance of very large surfaces cost that run alongside each other over a long way?
// Workload        Two linked rings, a ball in another one, and two waving sheets, 7.5 million triangles each, in random
//                 poses.
// Metric          Time of an exact distance, of one within 1 %, and of a collision: median over the poses, and the
//                 worst; the fastest of three calls counts. Node tests and triangle tests of the exact distance: means.
// Expected shape  A little more for many triangles than for few, as the logarithm of their number.
// Checked         Bounds of the distance within 1 % hold the exact one, and are within 1 %; no collision is found.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

struct Scene {
  std::string name;
  Mesh a, b;
  std::vector<Transform> poses;  // of b
};

Mesh scaled(const Mesh& mesh, double factor) {
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) p *= factor;
  return Mesh::create(std::move(positions), mesh.triangles()).value();
}

/// Of about 2 * side^2 triangles each.
std::vector<Scene> all_scenes(std::uint32_t side, std::uint32_t pose_count) {
  const Mesh ring = scenes::ring(side, side, 0.1), ball = scenes::ball(side, side);
  std::vector<Scene> all{{"linked rings", ring, ring, {}},
                         {"a ball in another", ball, scaled(ball, 0.8), {}},
                         {"sheets", scenes::wave_sheet(side, side, 0), scenes::wave_sheet(side, side, 3), {}}};
  scenes::Rng rng(17);
  for (std::uint32_t i = 0; i < pose_count; ++i) {
    all[0].poses.push_back(scenes::linked_ring(i));
    const Vec3 direction = scenes::random_rotation(rng).row0;
    all[1].poses.push_back({scenes::random_rotation(rng), direction * rng.uniform(0.05, 0.15)});
    all[2].poses.push_back({{}, {rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), rng.uniform(0.25, 0.5)}});
  }
  return all;
}

/// Calls `ask` once, then three times with a clock. Appends the time of the fastest of these to `times`.
template <typename Ask>
auto fastest(std::vector<double>& times, const Ask& ask) {
  double least = std::numeric_limits<double>::infinity();
  auto answer = ask();
  for (int i = 0; i < 3; ++i) {
    const Stopwatch watch;
    answer = ask();
    least = std::min(least, watch.us());
  }
  times.push_back(least);
  return answer;
}

int run(const Options& options) {
  Checker checker;
  Markdown table(options, "develop_large_surfaces.md");
  table.line("# Large surfaces alongside each other, as printed by `limber_bench_large_surfaces`\n");
  table.line(
      "Microseconds, median (worst); tests of the exact distance, means.\n\n| scene | triangles each | distances | "
      "exact "
      "| within 1 % | collision | node tests | triangle tests |\n|:--|--:|:--|--:|--:|--:|--:|--:|");
  for (const std::uint32_t side :
       options.quick ? std::vector<std::uint32_t>{50} : std::vector<std::uint32_t>{200, 1936}) {
    for (const Scene& scene : all_scenes(side, options.quick ? 4 : 16)) {
      const Model a(scene.a), b(scene.b);
      std::vector<double> exact_us, close_us, collide_us, distances, node_tests, triangle_tests;
      for (const Transform& pose : scene.poses) {
        const auto exact = fastest(exact_us, [&] { return distance({a}, {b, pose}); });
        const auto close = fastest(close_us, [&] { return distance({a}, {b, pose}, {.relative_error = 0.01}); });
        const auto met = fastest(collide_us, [&] { return collide({a}, {b, pose}); });
        checker.check(
            close.lower <= exact.upper && exact.upper <= close.upper && close.upper <= 1.01 * (1 + 1e-12) * close.lower,
            "{}: {} is not within 1 % of [{}, {}]", scene.name, exact.upper, close.lower, close.upper);
        checker.check(!met.is_yes(), "{}: a collision {} apart", scene.name, exact.upper);
        distances.push_back(exact.upper);
        node_tests.push_back(static_cast<double>(exact.stats.node_tests));
        triangle_tests.push_back(static_cast<double>(exact.stats.triangle_tests));
      }
      const Summary exact = summarize(exact_us), close = summarize(close_us), met = summarize(collide_us);
      const Summary apart = summarize(distances);
      table.line(
          "| {} | {} | {:.2f} to {:.2f} | {:.0f} ({:.0f}) | {:.0f} ({:.0f}) | {:.1f} ({:.1f}) | {:.0f} | {:.0f} |",
          scene.name, scene.a.triangles().size(), apart.min, apart.max, exact.median, exact.max, close.median,
          close.max, met.median, met.max, mean(node_tests), mean(triangle_tests));
    }
  }
  return checker.all_right() ? 0 : 1;
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  const ParsedOptions parsed =
      parse_options(argc, argv, "What does a distance of very large surfaces that run alongside each other cost?");
  return parsed.exit_code ? *parsed.exit_code : run(parsed.options);
}
