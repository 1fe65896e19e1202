// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  Has anything become slower since another revision of the library?
// Workload  Queries between two scans, a ball and a square, parallel sheets, and linked rings of two million triangles
//           each; the broad mix (bench/peers/scenes.h), along its paths with a cache; updates and builds.
// Metric    Time of this revision over that of the other: the two are called in turn, in one process. The median of the
//           ratios of these turns is printed, and at the end what all rows say together.
// Expected  Ratios about 1, and the same answers; else each difference is printed, and the exit code is 1.
//
// The other revision, `before`, is built by `./dev bench against REV`, with its namespace renamed to limber_before: its
// own engine.cpp defines make_engine_before() (bench/CMakeLists.txt).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/against/engine.h"
#include "bench/peers/scenes.h"
#include "bench/support/sampling.h"
#include "scenes/scenes.h"

namespace limber::bench {
namespace {

using against::Question;
using against::RawMesh;
using against::RawPose;

RawMesh raw(const Mesh& mesh) {
  RawMesh result;
  for (const Vec3& p : mesh.positions()) result.positions.push_back({p.x, p.y, p.z});
  for (const Corners& c : mesh.triangles()) result.triangles.push_back(c);
  return result;
}

RawPose raw(const Transform& t) {
  const Mat3& r = t.rotation;
  return {{r.row0.x, r.row0.y, r.row0.z, r.row1.x, r.row1.y, r.row1.z, r.row2.x, r.row2.y, r.row2.z},
          {t.translation.x, t.translation.y, t.translation.z}};
}

struct Engines {
  std::unique_ptr<against::Engine> before, now;
  Engines(const Mesh& a, const Mesh& b)
      : before(make_engine_before(raw(a), raw(b))), now(make_engine_now(raw(a), raw(b))) {}
};

// The least time of one sample, in microseconds: reading the clock, some 0.03, is nothing next to it.
constexpr double least_sample_us = 200;
// About the time of one row, in microseconds, so that the whole table takes minutes.
constexpr double row_us = 2e5;
// How many ratios a median is taken of: fewer are a matter of chance, more gain little.
constexpr std::size_t least_rounds = 9, most_rounds = 401;
// Ratios above these are counted. Guesses: the machine alone may be the reason up to the first; the second is worth a
// look.
constexpr double noise_ratio = 1.03, slower_ratio = 1.05;

/// The rows, printed one by one, and what they say together.
class Table {
 public:
  Table() { fmt::print("| what | before, us | now, us | now / before |\n| :-- | --: | --: | --: |\n"); }

  /// Calls both in turn and prints the ratio of their times.
  void compare(const std::string& name, const std::function<void()>& before, const std::function<void()>& now) {
    before();
    now();
    constexpr double tick_us = 1e-3;  // a call that the clock does not see has taken less
    const double once_us = std::max(std::min(mean_us(1, before), mean_us(1, now)), tick_us);
    const auto repetitions = static_cast<std::size_t>(std::max(1.0, std::ceil(least_sample_us / once_us)));
    const double round_us = 2 * once_us * static_cast<double>(repetitions);
    const std::size_t rounds = std::clamp(static_cast<std::size_t>(row_us / round_us), least_rounds, most_rounds);
    std::vector<double> ratios, times_before, times_now;
    for (std::size_t i = 0; i < rounds; ++i) {
      // The first call may find colder caches, so the order alternates.
      const bool now_first = i % 2 == 0;
      const double first_us = mean_us(repetitions, now_first ? now : before);
      const double second_us = mean_us(repetitions, now_first ? before : now);
      times_before.push_back(now_first ? second_us : first_us);
      times_now.push_back(now_first ? first_us : second_us);
      ratios.push_back(times_now.back() / times_before.back());
    }
    ratios_.push_back(median(std::move(ratios)));
    fmt::print("| {} | {:.4g} | {:.4g} | {:.3f} |\n", name, median(std::move(times_before)),
               median(std::move(times_now)), ratios_.back());
    std::fflush(stdout);
  }

  /// Notes that the two gave different answers.
  void note_difference(const std::string& what, double before, double now) {
    fmt::print("DIFFERENT: {}: {:.17g} before, {:.17g} now\n", what, before, now);
    ++differences_;
  }

  /// Prints what all rows say together. Returns whether all answers were the same.
  bool print_summary() const {
    const auto above = [&](double limit) {
      return std::count_if(ratios_.begin(), ratios_.end(), [&](double ratio) { return ratio > limit; });
    };
    fmt::print("\nMedian over all rows: {:.3f}. Rows above {}: {}, above {}: {}, of {}. Different answers: {}.\n",
               median(ratios_), noise_ratio, above(noise_ratio), slower_ratio, above(slower_ratio), ratios_.size(),
               differences_);
    return differences_ == 0;
  }

 private:
  std::vector<double> ratios_;
  std::size_t differences_ = 0;
};

using NamedQuestion = std::pair<Question, const char*>;
constexpr NamedQuestion collision{Question::collide, "collision"}, exact{Question::exact, "exact distance"},
    within_10_percent{Question::within_10_percent, "distance within 10 %"},
    within_limit{Question::within_limit, "closer than 0.01"}, warm_exact{Question::warm_exact, "exact, warm cache"};

/// Whether two answers to a question may both be right. Each answer within 10 % exceeds the distance by no more than
/// that, so one exceeds the other by no more. All others differ by rounding alone, of coordinates about 1; yes and no
/// are 1 and 0, which never agree.
bool agree(Question question, double before, double now) {
  if (before == now) return true;  // also where both are infinite
  constexpr double rounding = 1e-12;
  const double least = std::min(before, now), allowed = question == Question::within_10_percent ? 0.1 * least : 0;
  return std::abs(before - now) <= allowed + rounding * (1 + least);
}

/// Asks both, and notes if they do not agree.
void compare_answers(Table& table, Engines& engines, Question question, const RawPose& pose, const std::string& what) {
  const double before = engines.before->ask(question, pose), now = engines.now->ask(question, pose);
  if (!agree(question, before, now)) table.note_difference(what, before, now);
}

/// `row` names the scene and the situation.
void compare_poses(Table& table, Engines& engines, const std::string& row, const std::vector<Transform>& transforms,
                   std::initializer_list<NamedQuestion> questions) {
  if (transforms.empty()) return;
  std::vector<RawPose> poses;
  for (const Transform& pose : transforms) poses.push_back(raw(pose));
  for (const auto& [question, name] : questions) {
    const auto ask_all = [&, asked = question](against::Engine& engine) {
      for (const RawPose& pose : poses) engine.ask(asked, pose);
    };
    for (const RawPose& pose : poses) compare_answers(table, engines, question, pose, fmt::format("{}, {}", row, name));
    table.compare(
        fmt::format("{}: {} ({} poses)", row, name, poses.size()), [&] { ask_all(*engines.before); },
        [&] { ask_all(*engines.now); });
  }
}

void compare_queries(Table& table, const PeerScene& scene) {
  Engines engines(scene.a, scene.b);
  for (const Situation& situation : scene.situations) {
    compare_poses(table, engines, scene.name + ", " + situation.name, situation.poses,
                  {collision, exact, within_10_percent, within_limit, warm_exact});
  }
}

void compare_mix(Table& table, const PeerScene& scene) {
  Engines engines(scene.a, scene.b);
  const std::string name = "mix: " + scene.name + ", ";
  for (const Situation& situation : scene.situations) {
    compare_poses(table, engines, name + situation.name, situation.poses, {collision, exact, within_10_percent});
  }
  compare_poses(table, engines, name + "path", scene.path, {warm_exact});
}

/// After the timed calls, both are asked how far a ball above the sheet is. So a revision that leaves out work is
/// noticed. Frames differ by little: scattered vertices are raised before, each to be the closest to a ball above it.
void compare_updates(Table& table, std::uint32_t side) {
  const Mesh sheet = scenes::wave_sheet(side, side, 0);
  Engines engines(sheet, scenes::ball(3, 2));
  std::vector<std::vector<std::array<double, 3>>> frames;
  for (int frame = 0; frame < 2; ++frame)
    frames.push_back(raw(scenes::wave_sheet(side, side, 0.001 * frame)).positions);
  const std::string name = fmt::format("sheet of {} triangles", 2 * side * side);
  const auto both = [&](const std::string& what, const std::function<void(against::Engine&)>& call) {
    table.compare(
        name + ": " + what, [&] { call(*engines.before); }, [&] { call(*engines.now); });
  };
  const auto compare_from_above = [&](const std::string& what, const std::vector<std::uint32_t>& ids) {
    for (const std::uint32_t id : ids) {
      const auto& [x, y, z] = frames[1][id];
      compare_answers(table, engines, Question::exact, raw(Transform{{}, {x, y, z + 2}}), name + ": " + what);
    }
  };
  const auto last = static_cast<std::uint32_t>(frames[0].size() - 1);
  both("build", [](against::Engine& engine) { engine.build(); });
  compare_from_above("build", {0, last / 2, last});
  both("move all and commit, twice", [&](against::Engine& engine) {
    for (const auto& frame : frames) engine.move_all(frame);
  });
  compare_from_above("move all", {0, last / 2, last});
  for (const std::size_t count : {1U, 100U}) {
    std::vector<std::uint32_t> ids;
    std::vector<std::array<double, 3>> places[2];
    for (std::size_t i = 0; i < count; ++i) {
      ids.push_back(static_cast<std::uint32_t>(i * (frames[0].size() / count)));
      for (int frame = 0; frame < 2; ++frame)
        places[frame].push_back(frames[static_cast<std::size_t>(frame)][ids.back()]);
    }
    const std::string what = fmt::format("move {} scattered vertices and commit, twice", count);
    both(what, [&](against::Engine& engine) {
      for (const auto& to : places) engine.move(ids, to);
    });
    auto raised = places[1];
    for (auto& place : raised) place[2] += 0.5;
    for (against::Engine* engine : {engines.before.get(), engines.now.get()}) engine->move(ids, raised);
    compare_from_above(what, ids);
    for (against::Engine* engine : {engines.before.get(), engines.now.get()}) engine->move(ids, places[1]);
  }
}

/// Returns whether all answers were the same. Without a folder of meshes there are no scans.
bool compare_all(const std::filesystem::path& folder) {
  Table table;
  compare_queries(table, turned_ball_and_square(5));
  PeerScene sheets{"parallel sheets",
                   scenes::grid(64, 64, 0, 0, 1.0 / 64, 1.0 / 64),
                   scenes::grid(60, 60, 0.01, 0.02, 1.0 / 64, 1.0 / 64),
                   {}};
  sheets.situations = {{"0.1 apart", {Transform{{}, {0, 0, 0.1}}}}, {"0.001 apart", {Transform{{}, {0, 0, 0.001}}}}};
  compare_queries(table, sheets);
  PeerScene same{"a sheet over itself", sheets.a, sheets.a, sheets.situations};
  compare_queries(table, same);
  PeerScene rings{"linked rings", scenes::ring(1000, 1000, 0.1), scenes::ring(1000, 1000, 0.1), {{"2 million", {}}}};
  for (std::uint32_t index = 0; index < 5; ++index) rings.situations[0].poses.push_back(scenes::linked_ring(index));
  compare_queries(table, rings);
  if (!folder.empty()) {
    compare_queries(table,
                    two_scans("bunny and armadillo", folder / "stanford-bunny.obj", folder / "armadillo.obj", 10));
  }
  for_each_mix_scene(folder, 20, [&](const PeerScene& scene) { compare_mix(table, scene); });
  compare_updates(table, 100);
  compare_updates(table, 316);
  return table.print_summary();
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  return limber::bench::compare_all(argc > 1 ? argv[1] : "") ? EXIT_SUCCESS : EXIT_FAILURE;
}
