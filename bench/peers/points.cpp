// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What do closest points of many points cost, next to Embree and CGAL?
// Workload        10 000 points around the bunny, and 10 000 within a hundredth of its size of it. Without files a wavy
//                 sheet takes its place.
// Metric          Nanoseconds a point, medians over rounds in which all libraries take turns; one thread.
// Expected shape  Faster than Embree in float32, and several times as fast as CGAL.
// Checked         Distances of CGAL are the same up to 1e-9 of the size, those of Embree up to 2^-22: libraries of
//                 float32 round each vertex by up to 2^-24 of its coordinates.
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <string>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/io.h"
#include "limber/points.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

Vec3 random_point(scenes::Rng& rng, const Vec3& low, const Vec3& high) {
  return {rng.uniform(low.x, high.x), rng.uniform(low.y, high.y), rng.uniform(low.z, high.z)};
}

/// In the bounding box, made half as large again, or near vertices.
std::vector<Vec3> points_of(const Model& model, bool near, std::size_t count) {
  scenes::Rng rng(0x5EED0020);
  const auto [low, high] = model.bounding_box();
  const Vec3 around = near ? 0.005 * length(high - low) * Vec3{1, 1, 1} : 0.25 * (high - low);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& vertex = model.mesh().positions()[rng.below(model.mesh().positions().size())];
    const Vec3 point = random_point(rng, (near ? vertex : low) - around, (near ? vertex : high) + around);
    points.push_back({static_cast<float>(point.x), static_cast<float>(point.y), static_cast<float>(point.z)});
  }
  return points;
}

void compare(const Model& model, bool near, bool quick, Checker& checker, Table& table) {
  const std::vector<Vec3> points = points_of(model, near, quick ? 500 : 10'000);
  const double size = length(model.bounding_box().high - model.bounding_box().low);
  const std::vector<Projector> others = {
#ifdef LIMBER_PEER_EMBREE
      embree_projector(model.mesh()),
#endif
#ifdef LIMBER_PEER_CGAL
      cgal_projector(model.mesh()),
#endif
  };
  std::vector<PointResult> ours(points.size());
  std::vector<std::vector<double>> theirs(others.size(), std::vector<double>(points.size()));
  std::vector<Turn> turns = {{[&] { closest_point_many({model}, points, ours); }}};
  for (std::size_t k = 0; k < others.size(); ++k) {
    turns.push_back({[&, k] {
      for (std::size_t i = 0; i < points.size(); ++i) theirs[k][i] = others[k].distance(points[i]);
    }});
  }
  const std::vector<double> us = medians_in_turn(turns, quick ? 1 : 15);
  const auto row = [&](const std::string& library, std::size_t turn, double difference) {
    table.line("| {} | {} | {:.0f} | {:.2f} | {:.2g} |", near ? "near" : "anywhere", library,
               1e3 * us[turn] / static_cast<double>(points.size()), us[turn] / us[0], difference);
  };
  row("limber", 0, 0);
  for (std::size_t k = 0; k < others.size(); ++k) {
    double most = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double by = std::abs(theirs[k][i] - ours[i].closest->distance) / size;
      checker.check(by <= (others[k].is_float ? 0x1p-22 : 1e-9), "{} is {} off at point {}", others[k].library, by, i);
      most = std::max(most, by);
    }
    if (checker.all_right()) row(others[k].library + ", " + others[k].setting, k + 1, most);
  }
}

void run(const Options& options, Checker& checker) {
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const Model model(options.meshes.empty() ? scenes::wave_sheet(150, 150, 0)
                                           : load_mesh(options.meshes / "stanford-bunny.obj").value());
  Table table(options, "points.md");
  table.line("# Closest points next to other libraries, as printed by `limber_bench_points`\n");
  table.line("| points | library | ns a point | times limber | largest difference, of the size |");
  table.line("|:--|:--|--:|--:|--:|");
  for (const bool near : {false, true}) compare(model, near, options.quick, checker, table);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "What do closest points of many points cost, next to other libraries?",
                                  limber::bench::run);
}
