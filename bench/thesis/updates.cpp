// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What does it cost, per vertex moved, to keep the sphere tree of a deforming sheet in each of the
//                 three modes of maintenance? What does batching save? What does looseness save, and what does it
//                 cost queries?
// Workload        A flat sheet of 100 x 100 squares, 20 000 triangles. The same 1000 dents for every variant, random
//                 centers and radii from 1 to 10, with a commit after every 1 to 1000 dents; large motion (slope 0.1)
//                 and small (0.001). Then 8 exact distance queries of a ball hovering over the dented sheet. Apart from
//                 that, one step that moves every vertex. The classic sphere tree in three modes, and the fast engine;
//                 one thread.
// Metric          Time per moved vertex: minimum, median and maximum over rounds in each of which every variant runs
//                 once. Beside them the spheres refitted and the motions absorbed per moved vertex, and the pairs of
//                 spheres and of triangles that a hovering query compares.
// Expected shape  Immediate is most expensive and does not depend on the batch. Batched gains once the dents of one
//                 commit overlap. By depth is cheapest everywhere: each sphere is refitted once per commit. Looseness
//                 saves refits, most for small motion, and makes queries more expensive. The fast engine refits 8-wide
//                 nodes, so fewer, and costs a tenth.
// Checked         Before a time is printed: positions, tree invariants and hovering distances after every variant, the
//                 latter also against brute force; tight refits per vertex: immediate > batched > by depth; all
//                 vertices moved: exactly one refit per sphere by depth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "reference/classic/classic.h"
#include "reference/reference.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

using classic::Maintenance;
using classic::MaintenanceStats;

constexpr std::uint64_t dent_seed = 0x5EED0003;
constexpr std::uint32_t hovering_poses = 8;
constexpr double hovering_gap = 0.5;  // between the ball and the highest vertex nearby
constexpr double tolerance = 1e-12;

constexpr std::array<std::pair<Maintenance, const char*>, 3> modes = {
    {{Maintenance::immediate, "immediate"}, {Maintenance::batched, "batched"}, {Maintenance::by_depth, "by_depth"}}};
constexpr std::array batch_sizes = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};
constexpr std::array extra_radii = {0.0, 0.01, 0.05, 0.2, 0.5};

/// A sequence of dents, the sheet after it, and a ball that hovers over its center.
struct Motion {
  std::string name;
  std::vector<scenes::VertexMoves> dents;
  std::size_t moved_vertices = 0;
  Mesh dented = scenes::thesis_sheet();
  std::vector<Transform> hovering;
  std::vector<double> distances;  // of the hovering ball, as found by the first variant
};

Motion make_motion(const std::string& name, double slope, int dent_count, const Mesh& ball) {
  Motion motion;
  motion.name = name;
  scenes::Rng rng(dent_seed);
  for (int i = 0; i < dent_count; ++i) {
    scenes::Dent dent = scenes::random_dent(rng);
    dent.slope = std::copysign(slope, dent.slope);
    scenes::VertexMoves moves = scenes::dent_moves(dent, motion.dented.positions());
    for (std::size_t k = 0; k < moves.ids.size(); ++k)
      motion.dented.set_position(moves.ids[k], moves.positions[k]).value();
    motion.moved_vertices += moves.ids.size();
    motion.dents.push_back(std::move(moves));
  }
  Vec3 peak{50, 50, -1e9};
  for (const Vec3& p : motion.dented.positions()) {
    if (std::abs(p.x - 50) <= 3 && std::abs(p.y - 50) <= 3) peak.z = std::max(peak.z, p.z);
  }
  for (std::uint32_t index = 0; index < hovering_poses; ++index) {
    motion.hovering.push_back(Transform{{}, peak} * scenes::ball_over_square(ball, hovering_gap, index));
  }
  return motion;
}

/// One mode of maintenance during one motion.
struct Variant {
  Motion* motion;
  Maintenance mode;
  const char* mode_name;
  double extra_radius;
  int batch_dents;

  std::vector<double> total_us, move_us;  // per moved vertex; the latter in move_vertices() alone
  double refits = 0, absorbed = 0;        // per moved vertex
  double query_us = 0;                    // a mean over the poses, taken once
  double query_node_tests = 0, query_primitive_tests = 0;

  std::string name() const {
    return fmt::format("{} motion, {}, extra radius {}, {} dents per commit", motion->name, mode_name, extra_radius,
                       batch_dents);
  }
};

DistanceResult ask(const classic::Model& sheet, const classic::Model& ball, const Transform& pose) {
  return classic::distance({sheet}, {ball, pose});
}
DistanceResult ask(const Model& sheet, const Model& ball, const Transform& pose) {
  return distance({sheet}, {ball, pose});
}

/// The classic tree in its three modes, and the fast engine, which has one.
std::vector<Variant> variants_of(std::vector<Motion>& motions, bool is_fast) {
  std::vector<Variant> variants;
  for (Motion& motion : motions) {
    for (const double extra_radius : extra_radii) {
      for (const auto& [mode, mode_name] : modes) {
        if (is_fast && (extra_radius > 0 || mode != Maintenance::by_depth)) continue;
        for (const int batch_dents : batch_sizes) {
          variants.push_back({&motion, mode, is_fast ? "fast" : mode_name, extra_radius, batch_dents, {}, {}});
        }
      }
    }
  }
  return variants;
}

/// Plays the dents of the motion in batches, and notes the times.
template <typename AnyModel>
void run_dents(Checker& checker, Variant& v, AnyModel& sheet) {
  double move_us = 0, commit_us = 0;
  bool accepted = true;
  int waiting = 0;
  for (const scenes::VertexMoves& moves : v.motion->dents) {
    const Stopwatch move;
    accepted = static_cast<bool>(sheet.move_vertices(moves.ids, moves.positions)) && accepted;
    move_us += move.us();
    if (++waiting < v.batch_dents) continue;
    const Stopwatch commit;
    sheet.commit();
    commit_us += commit.us();
    waiting = 0;
  }
  const Stopwatch commit;
  sheet.commit();
  commit_us += commit.us();
  const auto moved = static_cast<double>(v.motion->moved_vertices);
  v.total_us.push_back((move_us + commit_us) / moved);
  v.move_us.push_back(move_us / moved);
  checker.check(accepted, "{}: an update was refused", v.name());
}

/// Notes the counters, which are the same in every round, and checks the final state of the sheet.
template <typename AnyModel>
void check_sheet(Checker& checker, Variant& v, const AnyModel& sheet) {
  const auto stats = sheet.maintenance_stats();
  const auto moved = static_cast<double>(v.motion->moved_vertices);
  v.refits = static_cast<double>(stats.refits) / moved;
  v.absorbed = static_cast<double>(stats.absorbed) / moved;
  checker.check(stats.moved_vertices == v.motion->moved_vertices, "{}: {} vertices moved instead of {}", v.name(),
                stats.moved_vertices, v.motion->moved_vertices);
  checker.check(sheet.mesh().positions() == v.motion->dented.positions(), "{}: wrong positions", v.name());
  const Result<void> valid = sheet.validate();
  checker.check(static_cast<bool>(valid), "{}: {}", v.name(), valid ? "" : valid.error().text);
}

template <typename AnyModel>
void hover(Checker& checker, Variant& v, const AnyModel& sheet, const AnyModel& ball) {
  std::vector<DistanceResult> results;
  const Stopwatch watch;
  for (const Transform& pose : v.motion->hovering) results.push_back(ask(sheet, ball, pose));
  v.query_us = watch.us() / hovering_poses;
  for (std::uint32_t i = 0; i < hovering_poses; ++i) {
    v.query_node_tests += static_cast<double>(results[i].stats.node_tests) / hovering_poses;
    v.query_primitive_tests += static_cast<double>(results[i].stats.primitive_tests) / hovering_poses;
    if (v.motion->distances.size() == i) v.motion->distances.push_back(results[i].upper);
    checker.check(std::abs(results[i].upper - v.motion->distances[i]) <= tolerance, "{}: distance {} instead of {}",
                  v.name(), results[i].upper, v.motion->distances[i]);
  }
}

void check_by_brute_force(Checker& checker, const std::vector<Motion>& motions, const Mesh& ball) {
  for (const Motion& motion : motions) {
    const double truth = reference::distance({motion.dented}, {ball, motion.hovering[0]}).upper;
    checker.check(std::abs(truth - motion.distances[0]) <= tolerance, "{} motion: distance {} instead of {}",
                  motion.name, motion.distances[0], truth);
  }
}

/// Tight spheres only: a loose sphere may mark_beyond motion in one mode and be refitted in another.
void check_order_of_modes(Checker& checker, const std::vector<Variant>& variants) {
  const std::size_t batches = batch_sizes.size();
  for (std::size_t i = 0; i < variants.size(); i += modes.size() * batches) {
    for (std::size_t k = i; k < i + batches && variants[k].extra_radius == 0; ++k) {
      const double immediate = variants[k].refits;
      const double batched = variants[k + batches].refits;
      const double by_depth = variants[k + 2 * batches].refits;
      checker.check(immediate > batched && batched > by_depth, "{}: refits per vertex {}, batched {}, by depth {}",
                    variants[k].name(), immediate, batched, by_depth);
    }
  }
}

/// One step that moves every vertex, in each mode.
void move_whole_sheet(Checker& checker, const Mesh& target, int rounds, Table& csv) {
  const auto moved = static_cast<double>(target.positions().size());
  std::array<std::vector<double>, modes.size()> us;
  std::array<double, modes.size()> refits{};
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const auto& [mode, mode_name] = modes[m];
      classic::Model sheet(scenes::thesis_sheet(), {.maintenance = mode});
      const Stopwatch watch;
      const bool accepted = static_cast<bool>(sheet.move_all(target.positions()));
      sheet.commit();
      us[m].push_back(watch.us() / moved);
      const std::uint64_t count = sheet.maintenance_stats().refits;
      refits[m] = static_cast<double>(count) / moved;
      checker.check(accepted && sheet.validate(), "all vertices moved, {}: damaged tree", mode_name);
      checker.check(mode != Maintenance::by_depth || count == sheet.tree().nodes.size(),
                    "all vertices moved: {} refits of {} spheres", count, sheet.tree().nodes.size());
    }
  }
  if (!checker.all_right()) return;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const Summary spread = summarize(us[m]);
    csv.line("whole,{},0,1,{},{:.5f},{:.5f},{:.5f},,{:.4f},0,,,", modes[m].second, moved, spread.min, spread.median,
             spread.max, refits[m]);
  }
}

void report(const std::vector<Variant>& variants, Table& csv) {
  for (const Variant& v : variants) {
    const Summary us = summarize(v.total_us);
    csv.line("{},{},{},{},{},{:.5f},{:.5f},{:.5f},{:.5f},{:.4f},{:.4f},{:.1f},{:.1f},{:.1f}", v.motion->name,
             v.mode_name, v.extra_radius, v.batch_dents, v.motion->moved_vertices, us.min, us.median, us.max,
             median(v.move_us), v.refits, v.absorbed, v.query_node_tests, v.query_primitive_tests, v.query_us);
  }
}

void run(const Options& options, Checker& checker) {
  const int rounds = options.quick ? 1 : 3;
  const int dent_count = options.quick ? 100 : 1000;

  const classic::Model ball(scenes::thesis_ball());
  std::vector<Motion> motions = {make_motion("large", 0.1, dent_count, ball.mesh()),
                                 make_motion("small", 0.001, dent_count, ball.mesh())};
  const Model fast_ball(scenes::thesis_ball());
  std::vector<Variant> variants = variants_of(motions, false), fast_variants = variants_of(motions, true);
  const auto play = [&](int round, Variant& v, auto sheet, const auto& hovering_ball) {
    run_dents(checker, v, sheet);
    if (round > 0) return;
    check_sheet(checker, v, sheet);
    hover(checker, v, sheet, hovering_ball);
  };
  for (int round = 0; round < rounds && checker.all_right(); ++round) {
    for (Variant& v : variants) {
      const classic::ModelOptions loose{.maintenance = v.mode, .looseness = {.extra_radius = v.extra_radius}};
      play(round, v, classic::Model(scenes::thesis_sheet(), loose), ball);
    }
    for (Variant& v : fast_variants) play(round, v, Model(scenes::thesis_sheet()), fast_ball);
  }
  check_by_brute_force(checker, motions, ball.mesh());
  check_order_of_modes(checker, variants);
  if (!checker.all_right()) return;

  Table csv(options, "thesis_updates.csv");
  csv.line(
      "motion,mode,extra_radius,batch_dents,moved_vertices,min_us,median_us,max_us,move_us,refits,absorbed,"
      "query_node_tests,query_primitive_tests,query_us");
  report(variants, csv);
  report(fast_variants, csv);
  move_whole_sheet(checker, motions.front().dented, 7 * rounds, csv);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::run_bench(argc, argv, "Time per moved vertex for the three modes of maintenance",
                                  limber::bench::run);
}
