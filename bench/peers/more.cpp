// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/peers/more.h"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/peers/peer.h"
#include "bench/peers/scenes_of_peers.h"
#include "bench/support/sampling.h"
#include "limber/distance.h"
#include "limber/io.h"
#include "limber/model.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

/// The first `count` frames of a slow flight of b half around a, at a distance that rises and falls, while b turns.
std::vector<Transform> flight(const Model& a, const Model& b, double closest, std::size_t frames, std::size_t count) {
  std::vector<Transform> poses;
  for (std::size_t f = 0; f < count; ++f) {
    const double t = static_cast<double>(f) / static_cast<double>(frames);
    const Vec3 outward{scenes::cosine(3 * t), scenes::sine(3 * t), 0.3 * scenes::sine(9 * t)};
    const Transform turned = transform_from_quaternion({}, 1, 0.4 * t, 0.2, 0.7 * t).value();
    Transform pose{turned.rotation, outward * 2};
    for (int step = 0; step < 8; ++step) {  // towards a or from it, until about as near as wanted
      const double found = distance({a}, {b, pose}, {.relative_error = 0.01}).upper;
      pose.translation += outward * ((closest * (1.2 + scenes::sine(20 * t)) - found) / length(outward));
    }
    poses.push_back(pose);
  }
  return poses;
}

/// The query of every frame.
struct Question {
  const char* name;
  double error;  // negative: whether they collide
};

/// The sum of all answers along a flight, from scratch or along a cache.
double ask_along(const Model& a, const Model& b, const std::vector<Transform>& poses, const Question& question,
                 QueryCache* cache) {
  double sum = 0;
  const DistanceOptions options{.relative_error = std::max(question.error, 0.0), .cache = cache};
  for (const Transform& pose : poses) {
    const Placed pa{a}, pb{b, pose};
    if (question.error < 0) {
      sum += collide(pa, pb, {.cache = cache}).is_yes() ? 1 : 0;
    } else {
      sum += distance(pa, pb, options).upper;
    }
  }
  return sum;
}

/// What FCL needs for a frame; it has no warm start. 0 if it was not found.
double fcl_frame_us(const Mesh& a, const Mesh& b, const std::vector<Transform>& poses, const Question& question) {
  constexpr std::size_t asked = 100;
  const bench::Question kind = question.error < 0 ? bench::Question::collide : bench::Question::exact;
  std::vector<double> us{0};
  for (const auto& [name, make] : all_peers()) {
    if (name != "fcl") continue;
    const std::unique_ptr<Peer> fcl = make(a, b);
    us.clear();
    for (std::size_t f = 0; f < poses.size(); f += poses.size() / asked) {
      const Stopwatch watch;
      fcl->ask(kind, poses[f]);
      us.push_back(watch.us());
    }
  }
  return summarize(us).median;
}

void warm(const Model& a, const Model& b, int rounds, Checker& checker, CsvFile& csv, Markdown& table) {
  table.line("\n### Warm start along half a turn of a smooth flight, in frames of different length\n");
  table.line("Of the flight in 60000 frames the first 3000. FCL has no warm start and no error.\n");
  table.line("| frames | gap about | query | cold us a frame | warm us a frame | ratio | FCL us a frame | ratio |");
  table.line("|--:|:--|:--|--:|--:|--:|--:|--:|");
  for (const std::size_t half_turn : {500U, 2000U, 10000U, 60000U}) {
    const std::size_t frames = half_turn == 60000 ? 3000 : half_turn;
    for (const double gap : {0.3, 0.05, 0.001}) {
      const std::vector<Transform> poses = flight(a, b, gap, half_turn, frames);
      for (const Question& question : {Question{"distance", 0}, {"within 10 %", 0.1}, {"collide", -1}}) {
        std::vector<double> cold, warmed;
        const int turns = std::max(2, rounds * 500 / static_cast<int>(frames));
        for (int turn = 0; turn < turns; ++turn) {
          const Stopwatch watch;
          const double sum = ask_along(a, b, poses, question, nullptr);
          cold.push_back(watch.us() / static_cast<double>(frames));
          QueryCache cache;
          const Stopwatch warm_watch;
          const double warm_sum = ask_along(a, b, poses, question, &cache);
          warmed.push_back(warm_watch.us() / static_cast<double>(frames));
          checker.check(std::abs(sum - warm_sum) <= (std::max(question.error, 0.0) + 1e-12) * sum,
                        "a warm start changes answers at gap {}", gap);
        }
        const double cold_us = summarize(cold).median, warm_us = summarize(warmed).median;
        const double fcl_us = fcl_frame_us(a.mesh(), b.mesh(), poses, question);
        table.line("| {} | {} | {} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.3g} |", half_turn, gap, question.name,
                   cold_us, warm_us, cold_us / warm_us, fcl_us, fcl_us / warm_us);
        csv.row("warm,{}/{},{},{:.4g},{:.4g},{:.4g}", half_turn, gap, question.name, cold_us, warm_us,
                cold_us / warm_us);
        if (fcl_us > 0) csv.row("fcl,{}/{},{},{:.4g},,{:.4g}", half_turn, gap, question.name, fcl_us, fcl_us / warm_us);
      }
    }
  }
}

void growth(Mesh mesh, int rounds, CsvFile& csv, Markdown& table) {
  table.line("\n### Growth: a mesh against itself, subdivided flat, 20 poses\n");
  table.line("| triangles | gap | distance us, median | times that of a quarter |");
  table.line("|--:|--:|--:|--:|");
  const Model coarse(mesh);
  std::vector<std::vector<Transform>> poses;  // by gap
  const double gaps[] = {1, 0.05, 0.001};
  for (const double gap : gaps) {
    scenes::Rng rng(0x5EED0007);
    poses.emplace_back();
    for (int i = 0; i < 20; ++i) {
      Transform pose{scenes::random_rotation(rng), {}};
      const Vec3 outward = scenes::random_rotation(rng).row0;
      pose.translation = outward * 3;
      for (int step = 0; step < 100; ++step) {
        pose.translation += outward * (gap - distance({coarse}, {coarse, pose}).upper);
      }
      poses.back().push_back(pose);
    }
  }
  double before[std::size(gaps)] = {};
  for (int level = 0; level < 3; ++level) {
    if (level > 0) mesh = subdivided(mesh);
    const Model model(mesh);
    for (std::size_t g = 0; g < std::size(gaps); ++g) {
      std::vector<double> times;
      for (const Transform& pose : poses[g]) {
        std::vector<double> samples;
        for (int round = 0; round < rounds; ++round) {
          samples.push_back(mean_us(2, [&] { distance({model}, {model, pose}); }));
        }
        times.push_back(summarize(samples).median);
      }
      const double median = summarize(times).median;
      const double factor = level == 0 ? 1 : median / before[g];
      table.line("| {} | {} | {:.3g} | {:.3g} |", mesh.triangles().size(), gaps[g], median, factor);
      csv.row("growth,{},{},{:.4g},,{:.4g}", mesh.triangles().size(), gaps[g], median, factor);
      before[g] = median;
    }
  }
}

double build_ns(const Mesh& mesh, std::size_t threads) {
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
  Mesh copy = mesh;
  const Stopwatch watch;
  const Model model(std::move(copy));
  return watch.us() * 1e3 / static_cast<double>(mesh.triangles().size());
}

void build(const std::string& name, const Mesh& mesh, int rounds, CsvFile& csv, Markdown& table) {
  const auto others = builders();
  std::vector<double> one, two;
  std::vector<std::vector<double>> theirs(others.size());
  for (int round = 0; round < rounds; ++round) {
    one.push_back(build_ns(mesh, 1));
    two.push_back(build_ns(mesh, 2));
    for (std::size_t i = 0; i < others.size(); ++i) theirs[i].push_back(others[i].second(mesh));
  }
  const double triangles = static_cast<double>(mesh.triangles().size());
  const double bytes = static_cast<double>(Model(mesh).tree_stats().bytes) / triangles;
  const double ours = summarize(one).median, on_two = summarize(two).median;
  table.line("| {} | {} | limber | {:.4g} | 1 |", name, triangles, ours);
  table.line("| | | limber, two threads | {:.4g} | {:.3g} |", on_two, on_two / ours);
  csv.row("build,{},ns per triangle,{:.4g},{:.4g},{:.4g}", triangles, ours, on_two, ours / on_two);
  for (std::size_t i = 0; i < others.size(); ++i) {
    const double other = summarize(theirs[i]).median;
    table.line("| | | {} | {:.4g} | {:.3g} |", others[i].first, other, other / ours);
    csv.row("build,{} {},ns per triangle,{:.4g},{:.4g},{:.4g}", triangles, others[i].first, ours, other, other / ours);
  }
  table.line("| | | bytes a triangle | {:.3g} | |", bytes);
  csv.row("memory,{},bytes per triangle,{:.4g},,", triangles, bytes);
}

}  // namespace

void measure_more(const Options& options, const std::filesystem::path& meshes, Checker& checker, Markdown& table) {
  CsvFile csv(options, "peers_more.csv", "what,situation,query,first,second,ratio");
  const int rounds = options.quick ? 1 : 5;
  const Mesh bunny = normalised(load_mesh(meshes / "stanford-bunny.obj").value());
  const Mesh armadillo = normalised(load_mesh(meshes / "armadillo.obj").value());
  warm(Model(bunny), Model(armadillo), rounds, checker, csv, table);
  growth(bunny, rounds, csv, table);
  table.line("\n### Build, nanoseconds a triangle, medians; libraries in turn\n");
  table.line("| mesh | triangles | library | ns | times ours |");
  table.line("|:--|--:|:--|--:|--:|");
  const int builds = options.quick ? 1 : 21;
  build("sheet", scenes::wave_sheet(125, 80, 0), builds, csv, table);
  build("bunny", bunny, builds, csv, table);
  build("sheet", scenes::wave_sheet(400, 250, 0), builds, csv, table);
  build("sheet", scenes::wave_sheet(1250, 800, 0), options.quick ? 1 : 5, csv, table);
}

}  // namespace limber::bench
