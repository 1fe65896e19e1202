// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What do moves and commits take at worst, while the tree is kept as good as new?
// Workload        A sheet of 100 352 triangles: a dent of 150 vertices that is dragged over it and relaxes; and 150
//                 vertices anywhere that drift away a little in every frame. 100 000 frames of move and commit, as
//                 models are by default, with a worker, and as ModelOptions::real_time() has them.
// Metric          Time of moves and of commits, next to a loop that only looks at the clock. By counts: the most that
//                 one commit has refitted and spent on rebuilding, and whole passes over tree or vertices. Visits
//                 of queries at the end (a test of nodes is one, of triangles eight) as a multiple of a new tree's.
// Expected shape  In real time no passes, commits of at most twice their own refits and the budget, and a tail that is
//                 the machine's.
// Checked         What real_time() promises, by counts. Distances equal those of a new tree; the tree is sound.
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
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

constexpr std::uint32_t side = 224;
constexpr VertexId side_vertices = side + 1;
constexpr std::size_t moved = 150;
constexpr double budget_us = 20;

/// The ids and positions of one frame.
struct Batch {
  std::vector<VertexId> ids;
  std::vector<Vec3> positions;
};

/// What moves in a frame of a sheet.
using Deformation = Batch (*)(const Mesh& mesh, int frame, scenes::Rng& rng);

/// A dent under a point that goes round; what it has left rises again.
Batch dragged(const Mesh& mesh, int frame, scenes::Rng&) {
  Batch batch;
  constexpr double reach = 7;
  const double angle = 0.002 * (frame + 1);
  const double x = 0.5 * side + 0.4 * side * std::cos(angle), y = 0.5 * side + 0.4 * side * std::sin(1.7 * angle);
  for (auto row = static_cast<VertexId>(y - reach); row <= static_cast<VertexId>(y + reach); ++row) {
    for (auto column = static_cast<VertexId>(x - reach); column <= static_cast<VertexId>(x + reach); ++column) {
      const VertexId id = row * side_vertices + column;
      const double dx = column - x, dy = row - y, r = std::sqrt(dx * dx + dy * dy) / reach;
      if (r > 1) continue;
      const Vec3& p = mesh.positions()[id];
      const double depth = -4 * (1 - r * r) * (1 - r * r);
      batch.ids.push_back(id);
      batch.positions.push_back({p.x, p.y, std::min(0.9 * p.z, depth)});
    }
  }
  return batch;
}

/// Vertices anywhere, each a little farther every time: the sheet becomes a soup.
Batch drifted(const Mesh& mesh, int, scenes::Rng& rng) {
  Batch batch;
  for (std::size_t i = 0; i < moved; ++i) {
    const auto id = static_cast<VertexId>(rng.below(mesh.positions().size()));
    const Vec3 by{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    batch.ids.push_back(id);
    batch.positions.push_back(mesh.positions()[id] + 0.2 * by);
  }
  return batch;
}

double visits(const QueryStats& stats) {
  return static_cast<double>(stats.node_tests) + 8 * static_cast<double>(stats.primitive_tests);
}

/// The visits of some queries as a multiple of those of a new tree.
double degradation(const Model& model, Checker& checker, const std::string& name) {
  const Model fresh(Mesh::create(model.mesh().positions(), model.mesh().triangles()).value());
  const Model ball(scenes::ball(32, 17));
  scenes::Rng rng(5);
  double sum = 0, fresh_sum = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 at{rng.uniform(0, side), rng.uniform(0, side), rng.uniform(1.5, 8)};
    const DistanceResult found = distance({model}, {ball, {{}, at}}), wanted = distance({fresh}, {ball, {{}, at}});
    checker.check(std::abs(found.upper - wanted.upper) <= 1e-10, "{}: {} instead of {}", name, found.upper,
                  wanted.upper);
    sum += visits(found.stats), fresh_sum += visits(wanted.stats);
  }
  return sum / fresh_sum;
}

/// The most that one commit has done, by counts.
struct Worst {
  std::uint64_t refits = 0;
  double rebuild_us = 0;

  void note(const MaintenanceStats& before, const MaintenanceStats& after) {
    refits = std::max(refits, after.refits - before.refits);
    rebuild_us = std::max(rebuild_us, after.rebuild_us - before.rebuild_us);
  }
};

struct Variant {
  std::string name;
  ModelOptions options;
  bool is_in_time;  // whether what real_time() promises is checked
};

void play(Deformation deformation, const std::string& scene, const Variant& variant, int frames, Checker& checker,
          Table& text) {
  const std::string name = scene + ", " + variant.name;
  Model model(scenes::grid(side, side, 0, 0, 1, 1), variant.options);
  std::vector<double> moves, commits;
  moves.reserve(static_cast<std::size_t>(frames)), commits.reserve(static_cast<std::size_t>(frames));
  Worst worst;
  scenes::Rng rng(71);
  for (int frame = 0; frame < frames; ++frame) {
    const Batch batch = deformation(model.mesh(), frame, rng);
    const MaintenanceStats before = model.maintenance_stats();
    bool is_right = false;
    moves.push_back(mean_us(1, [&] { is_right = static_cast<bool>(model.move_vertices(batch.ids, batch.positions)); }));
    commits.push_back(mean_us(1, [&] { model.commit(); }));
    checker.check(is_right, "{}: refused", name);
    worst.note(before, model.maintenance_stats());
  }
  const MaintenanceStats stats = model.maintenance_stats();
  checker.check(static_cast<bool>(model.validate()), "{}: unsound", name);
  if (variant.is_in_time) {
    // A vertex is in at most six triangles, so in six lowest nodes; each level above has at most as many nodes.
    constexpr double most_refits = 6 * 160 * 5, us_per_refit = 0.6, step_us = 10;
    checker.check(stats.whole_passes == 0, "{}: {} whole passes", name, stats.whole_passes);
    checker.check(static_cast<double>(worst.refits) <= 2 * most_refits, "{}: {} refits", name, worst.refits);
    checker.check(worst.rebuild_us <= budget_us + step_us + us_per_refit * most_refits, "{}: {} us", name,
                  worst.rebuild_us);
  }
  const double times = static_cast<double>(stats.rebuilt_triangles) / (2.0 * side * side);
  text.line("| {} | moves | {} | | | | | |", name, summarize(std::move(moves)).tail());
  text.line("| | commits | {} | {} | {:.1f} | {} | {:.1f} | {:.2f} |", summarize(std::move(commits)).tail(),
            worst.refits, worst.rebuild_us, stats.whole_passes, times, degradation(model, checker, name));
}

void time_the_clock(int frames, Table& text) {
  std::vector<double> idle;
  for (int frame = 0; frame < frames; ++frame) {
    const auto start = Clock::now();
    while (us_since(start) < 50) {
    }
    idle.push_back(us_since(start) - 50);
  }
  text.line("| nothing but the clock, for 50 us | late | {} | | | | | |", summarize(std::move(idle)).tail());
}

void run(const Options& options, Checker& checker) {
  const int frames = options.quick ? 500 : 100'000;
  Table text(options, "spikes.md");
  text.line("# Moves and commits at worst, as printed by `limber_bench_spikes`\n");
  text.line("Microseconds, {} frames. Counts are of the one commit that has most.\n", frames);
  text.line(
      "| scene | | p50 | p99 | p99.9 | p99.99 | max | refits at most | us of rebuilding, estimated | whole passes | "
      "times "
      "rebuilt | visits, of a new tree's |");
  text.line("|:--|:--|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
  time_the_clock(frames / 10, text);
  const Variant variants[] = {
      {"default", {}, false},
      {"on a worker", {.rebuild_policy = RebuildPolicy::on_worker}, false},
      {"real time, 20 us", ModelOptions::real_time(budget_us), true},
  };
  for (const Variant& variant : variants) {
    play(dragged, "a dent dragged", variant, frames, checker, text);
    play(drifted, "vertices drifting", variant, frames, checker, text);
  }
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "What moves and commits take at worst while a tree stays as good as new",
                                  limber::bench::run);
}
