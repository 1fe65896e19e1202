// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What does it cost to keep the tree of a deforming mesh up to date, next to other libraries, when all
//                 vertices move, some, or one?
// Workload        Waving sheets of 20 000, 200 000 and 2 000 000 triangles, of which every frame moves all vertices.
//                 The sheet of 200 000 with a distance to the bunny in every frame. Commits of 1 to all vertices of the
//                 sheets, next to each other and anywhere.
// Metric          Nanoseconds a triangle, moving the vertices included; milliseconds a frame; medians over rounds in
//                 which all libraries take turns.
// Expected shape  Ours costs a third of a ray tracer's refit, a fifth of that of FCL's boxes, and about a hundredth of
//                 those of swept spheres and oriented boxes.
// Checked         Distances of all libraries in every frame; the table counts the wrong ones.
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/peers/scenes.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/io.h"
#include "limber/model.h"
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

/// The pose of the bunny in a frame of the waving sheet.
Transform bunny_pose(int frame) {
  const double f = frame, half = 0.03 * f, s = scenes::sine(half) / std::sqrt(14.0);
  const Vec3 place{2 + 1.2 * scenes::cosine(0.05 * f), 1.25 + 0.7 * scenes::sine(0.05 * f),
                   0.75 + 0.15 * scenes::sine(0.11 * f)};
  return transform_from_quaternion(place, scenes::cosine(half), s, 2 * s, 3 * s).value();
}

/// Every frame moves all vertices and asks for an exact distance of `other`, placed by pose_of(frame).
template <typename PoseOf>
void frames_with_queries(const scenes::Motion& motion, const Mesh& other, const PoseOf& pose_of, int frames,
                         Checker& checker, Table& table) {
  table.line("\n### {}, {} triangles: all vertices moved, exact distance; ms\n", motion.name,
             motion.mesh.triangles().size());
  table.line(
      "| library | update | query | frame, median | p99 | times ours | wrong answers |\n|:--|--:|--:|--:|--:|--:|--:|");
  std::vector<Contestant> contestants = deforming_peers(motion.mesh, other);
  std::erase_if(contestants, [](const Contestant& c) { return !c.peer->answers(Question::exact); });
  std::vector<Times> times(contestants.size());
  for (int frame = 1; frame <= frames; ++frame) {
    const std::vector<Vec3> positions = motion.positions(frame);
    double truth = 0;
    for (std::size_t i = 0; i < (frame > 10 ? 1 : contestants.size()); ++i) {
      const auto& [name, peer] = contestants[i];
      const Stopwatch update;
      checker.check(peer->deform(positions), "{} cannot deform", name);
      times[i].update_us.push_back(update.us());
      const Stopwatch asking;
      const double found = peer->ask(Question::exact, pose_of(frame));
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

/// Commits of some vertices, neighbours or anywhere, which move a little.
void some_vertices(std::uint32_t nx, std::uint32_t ny, int rounds, Table& table) {
  const Mesh sheet = scenes::wave_sheet(nx, ny, 0);
  const auto triangles = static_cast<double>(sheet.triangles().size());
  const std::size_t vertex_count = sheet.positions().size();
  Model model(sheet, {.rebuild_policy = RebuildPolicy::off});
  scenes::Rng rng(0x5EED0020);
  std::vector<double> full;
  for (int round = 0; round < std::max(3, rounds / 10); ++round) {
    const Stopwatch watch;
    if (!model.move_all(sheet.positions())) return;
    model.commit();
    full.push_back(watch.us());
  }
  for (const bool anywhere : {false, true}) {
    for (std::size_t batch = 1; batch <= vertex_count; batch = batch < vertex_count / 10 ? batch * 10 : batch * 3) {
      std::vector<double> us;
      for (int round = 0; round < (batch > 10000 ? std::max(3, rounds / 10) : rounds); ++round) {
        std::vector<VertexId> ids;
        std::vector<Vec3> positions;
        const std::uint64_t first = rng.below(vertex_count);
        for (std::size_t i = 0; i < batch; ++i) {
          ids.push_back(static_cast<VertexId>((anywhere ? rng.below(vertex_count) : first + i) % vertex_count));
          positions.push_back(sheet.positions()[ids.back()] + Vec3{0, 0, rng.uniform(-1e-3, 1e-3)});
        }
        const Stopwatch watch;
        if (!model.move_vertices(ids, positions)) return;
        model.commit();
        us.push_back(watch.us());
      }
      const double whole = median(us);
      table.line("| {} | {} | {} | {:.3g} | {:.3g} | {:.3g} |", triangles, batch, anywhere ? "anywhere" : "neighbours",
                 whole, whole * 1e3 / static_cast<double>(batch), whole / median(full));
    }
  }
}

/// Two frames of a real cloth, to and fro, with the bunny beside it.
void real_cloth(const std::filesystem::path& meshes, const Mesh& bunny, int frames, Checker& checker, Table& table) {
  const Mesh cloth = load_mesh(meshes / "cloth_ball_92.ply").value();
  const scenes::Motion real = scenes::morph("two frames of a real cloth, to and fro", cloth,
                                            load_mesh(meshes / "cloth_ball_93.ply").value(), 10);
  const Box box = Model(cloth).bounding_box();
  const Vec3 center = 0.5 * (box.low + box.high);
  const double size = length(box.high - box.low);
  std::vector<Vec3> positions = normalised(bunny).positions();
  for (Vec3& p : positions) p *= 0.2 * size;
  const auto pose_of = [&](int frame) {
    const double angle = 0.05 * frame;
    return Transform{{}, center + size * Vec3{0.5 * scenes::cosine(angle), 0.5 * scenes::sine(angle), 0.3}};
  };
  frames_with_queries(real, Mesh::create(std::move(positions), bunny.triangles()).value(), pose_of, frames, checker,
                      table);
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
  if (!options.meshes.empty()) {
    const Mesh bunny = normalised(load_mesh(options.meshes / "stanford-bunny.obj").value());
    const int frames = options.quick ? 3 : 100;
    frames_with_queries(scenes::waving_sheet(400, 250), bunny, bunny_pose, frames, checker, table);
    real_cloth(options.meshes, bunny, frames, checker, table);
  }
  table.line("\n### Some vertices, moving them and commit\n");
  table.line("| triangles | vertices | where | us | ns a vertex | of moving all |\n|--:|--:|:--|--:|--:|--:|");
  some_vertices(100, 100, 10 * rounds, table);
  some_vertices(400, 250, 10 * rounds, table);
  if (!options.quick) some_vertices(1000, 1000, 5 * rounds, table);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "What does it cost to keep the tree of a deforming mesh up to date?",
                                  limber::bench::run);
}
