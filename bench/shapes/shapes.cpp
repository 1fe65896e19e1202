// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  What does the distance of a sphere, a capsule and a rounded box to a large mesh cost, next to that of a
//           point?
// Workload  The bunny of the folder --meshes, else a generated mesh; shapes of a twentieth of its size at gaps of 0.001
//           to 1 of its size, in random directions.
// Metric    Microseconds of one call, on one thread, in turn with the others: the median of all poses.
// Expected  A sphere at most 1.5 times a point, a capsule two to four times.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/io.h"
#include "limber/limber.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

struct Contender {
  std::string name;
  std::function<double(const Transform&)> distance;
  std::vector<double> times{};
};

Mesh mesh_of(const Options& options) {
  if (options.meshes.empty()) return scenes::ring(300, 120, 0.25);
  return load_mesh((options.meshes / "stanford-bunny.obj").string()).value();
}

/// Places the origin of a shape at a distance from a model, turned at random.
Transform placed_at(scenes::Rng& rng, const Model& model, double distance) {
  const Sphere sphere = model.bounding_sphere();
  const Mat3 turned = scenes::random_rotation(rng);
  const Vec3 direction = turned.row0;
  double low = 0, high = 2 * sphere.radius + distance;  // by bisection along a ray; the last end is farther away
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const bool is_far = closest_point(model, sphere.center + middle * direction).closest->distance >= distance;
    (is_far ? high : low) = middle;
  }
  return {turned, sphere.center + high * direction};
}

void measure(Table& table, Checker& checker, const Model& model, double gap, std::size_t poses) {
  const double size = model.bounding_sphere().radius, r = 0.05 * size;
  const Shape sphere = Shape::sphere(r), capsule = Shape::capsule({-2 * r, 0, 0}, {2 * r, 0, 0}, r);
  const Shape box = Shape::box({r, r, r}, 0.1 * r);
  const auto to = [&](const Shape& shape) {
    return [&](const Transform& pose) { return distance(model, {shape, pose}).upper; };
  };
  Contender all[] = {
      {"point", [&](const Transform& pose) { return closest_point(model, pose.translation).closest->distance - r; }},
      {"sphere", to(sphere)},
      {"capsule", to(capsule)},
      {"rounded box", to(box)},
      {"sphere, collide", [&](const Transform& pose) {
         return collide(model, {sphere, pose}).is_yes() ? 1 : 0;
       }}};
  scenes::Rng rng(1);
  for (std::size_t i = 0; i < poses; ++i) {
    const Transform pose = placed_at(rng, model, r + gap * size);
    checker.check(std::abs(all[0].distance(pose) - all[1].distance(pose)) <= 1e-12 * size, "a sphere is not as far");
    for (Contender& contender : all) {
      const std::size_t repetitions = repetitions_for(mean_us(2, [&] { contender.distance(pose); }));
      contender.times.push_back(mean_us(repetitions, [&] { contender.distance(pose); }));
    }
  }
  if (!checker.all_right()) return;
  for (Contender& contender : all) {
    std::sort(contender.times.begin(), contender.times.end());
    const double median = contender.times[poses / 2];
    table.line("| {} | {} | {:.2f} | {:.2f} |", gap, contender.name, median, median / all[0].times[poses / 2]);
  }
}

void run(const Options& options, Checker& checker) {
  const Model model(mesh_of(options));
  Table table(options, "shapes.md");
  table.line("# Distances of shapes to a mesh, as printed by `limber_bench_shapes`\n");
  table.line("Distances to {} triangles; medians of one call, and as parts of a point's.\n",
             model.mesh().triangles().size());
  table.line("| gap | shape | us | of a point |");
  table.line("|--:|:--|--:|--:|");
  for (const double gap : {0.001, 0.05, 1.0}) measure(table, checker, model, gap, options.quick ? 5 : 200);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "Distances of shapes to a mesh, next to closest points.",
                                  limber::bench::run);
}
