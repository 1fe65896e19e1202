// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What do all pairs of triangles that intersect or are close cost, of two meshes and of one with
//                 itself, and what do closest points cost, next to other libraries?
// Workload        A cloth that intersects itself, bunny and armadillo, each with itself. Two cloths of 100 000
//                 triangles with a ball of 10 000, and frames in which all their vertices move. The margin is a
//                 thousandth of the size. 10 000 points around the bunny, and 10 000 near it, in one call each.
// Metric          Microseconds a call, medians of up to 15 runs, by the clock and by the processor's time, one thread.
//                 Closest points on two threads, too; these runs and those on one thread take turns. Ratios of other
//                 libraries, measured by peers.py as README.md says, to ours.
// Expected shape  Several times faster than other libraries that answer the same question. Where a mesh is close to
//                 itself everywhere, contacts cost what comparing their triangles costs. Two threads answer at least
//                 1.9 times as many points as one does.
// Checked         Pairs of other libraries: each difference has a reason. Our answers with each other, and after motion
//                 with those of new models. Closest points lie on their triangles; every hundredth by brute force, and
//                 those that other libraries have closer.
#include <oneapi/tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/contacts/contact_bench.h"
#include "bench/support/report.h"
#include "limber/io.h"

namespace limber::bench {
namespace {

/// All questions about pairs, on one thread.
void ask_for_pairs(ContactBench& bench, const Settings& settings) {
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  bench.one_mesh("cloth", load_mesh(settings.meshes / "cloth_ball_92.ply").value());
  bench.one_mesh("bunny", load_mesh(settings.meshes / "stanford-bunny.obj").value());
  bench.one_mesh("armadillo", load_mesh(settings.meshes / "armadillo.obj").value());
  bench.elements("cloth", load_mesh(settings.meshes / "cloth_ball_92.ply").value());
  bench.elements("bunny", load_mesh(settings.meshes / "stanford-bunny.obj").value());
  bench.elements("armadillo", load_mesh(settings.meshes / "armadillo.obj").value());
  for (const std::string name : {"drape", "folded"}) {
    if (settings.answers.empty() || !std::filesystem::exists(settings.answers / (name + ".ply"))) {
      fmt::print(stderr, "{} is left out: peers.py, which makes it, has not run\n", name);
      continue;
    }
    const MeshSequence cloths = MeshSequence::open(settings.answers / (name + ".ply")).value();
    const Mesh &cloth = cloths.first().mesh, ball = load_mesh(settings.answers / (name + "_ball.ply")).value();
    if (name == "folded") bench.one_mesh(name, cloth);
    bench.two_meshes(name, cloth, ball, name == "drape");
    const std::vector<Vec3> moved = cloths.read_positions(settings.answers / (name + "_moved.ply"), 1).value();
    bench.frames("frame_" + name, cloth, moved, ball);
    bench.element_frames("frame_" + name, cloth, moved, ball);
  }
}

int run(const Settings& settings) {
  report_machine(settings.options);
  ContactBench bench(settings);
  ask_for_pairs(bench, settings);
  const Mesh bunny = load_mesh(settings.meshes / "stanford-bunny.obj").value();
  for (const std::string kind : {"anywhere", "near"}) bench.points("bunny", bunny, kind);
  return bench.report();
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  CLI::App app{"What do pairs of triangles and closest points cost, next to other libraries?"};
  Settings settings;
  app.add_option("--meshes", settings.meshes, "folder with cloth_ball_92.ply, stanford-bunny.obj and armadillo.obj")
      ->required();
  app.add_option("--out", settings.options.out, "folder for results; default: only the console");
  app.add_option("--peers", settings.peers, "contact_peers.csv, written by peers.py; default: no other library");
  app.add_option("--answers", settings.answers, "folder of answers and meshes written by peers.py; default: none");
  app.add_flag("--quick", settings.options.quick, "few runs: shows that everything works");
  CLI11_PARSE(app, argc, argv);
  try {
    if (!settings.options.out.empty()) std::filesystem::create_directories(settings.options.out);
    return run(settings);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
