// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  Has anything become slower since another revision of the library?
// Workload  Queries between two scans, a ball and a square, parallel sheets, and linked rings of two million triangles
//           each; updates and builds.
// Metric    Time of this revision over that of the other: the two are called in turn, in one process. The median of the
//           ratios of these turns is printed.
// Expected  Ratios about 1, and the same answers.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "bench/against/engine.h"
#include "bench/peers/scenes_of_peers.h"
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

double median(std::vector<double> values) { return summarize(std::move(values)).median; }

/// Calls both in turn and prints the ratio of their times.
void compare(const std::string& name, const std::function<void()>& before, const std::function<void()>& now) {
  before(), now();
  const double once_us = std::min(mean_us(1, before), mean_us(1, now));
  const std::size_t repetitions = std::max(repetitions_for(once_us), static_cast<std::size_t>(200 / once_us));
  const auto rounds =
      static_cast<std::size_t>(std::clamp(2e5 / (2 * once_us * static_cast<double>(repetitions)), 9.0, 401.0));
  std::vector<double> ratios, times_before, times_now;
  for (std::size_t i = 0; i < rounds; ++i) {
    // The first call may find colder caches, so the order alternates.
    double us[2];
    for (const bool now_first : {i % 2 == 0}) {
      us[now_first ? 1 : 0] = mean_us(repetitions, now_first ? now : before);
      us[now_first ? 0 : 1] = mean_us(repetitions, now_first ? before : now);
    }
    ratios.push_back(us[1] / us[0]), times_before.push_back(us[0]), times_now.push_back(us[1]);
  }
  fmt::print("| {} | {:.4g} | {:.4g} | {:.3f} |\n", name, median(times_before), median(times_now), median(ratios));
  std::fflush(stdout);
}

constexpr std::pair<Question, const char*> questions[] = {{Question::collide, "collision"},
                                                          {Question::exact, "exact distance"},
                                                          {Question::within_10_percent, "distance within 10 %"},
                                                          {Question::within_limit, "closer than 0.01"},
                                                          {Question::warm_exact, "exact, warm cache"}};

void compare_queries(const PeerScene& scene) {
  Engines engines(scene.a, scene.b);
  for (const Situation& situation : scene.situations) {
    std::vector<RawPose> poses;
    for (const Transform& pose : situation.poses) poses.push_back(raw(pose));
    for (const auto& [question, name] : questions) {
      const auto ask_all = [&, question = question](against::Engine& engine) {
        for (const RawPose& pose : poses) engine.ask(question, pose);
      };
      for (const RawPose& pose : poses) {
        const double before = engines.before->ask(question, pose), now = engines.now->ask(question, pose);
        const bool alike = question == Question::within_10_percent || std::abs(before - now) <= 1e-12 * (1 + before);
        if (!alike)
          fmt::print("DIFFERENT: {}, {}, {}: {:.17g} before, {:.17g} now\n", scene.name, situation.name, name, before,
                     now);
      }
      compare(
          fmt::format("{}, {}: {} ({} poses)", scene.name, situation.name, name, poses.size()),
          [&] { ask_all(*engines.before); }, [&] { ask_all(*engines.now); });
    }
  }
}

void compare_updates(std::uint32_t side) {
  const Mesh sheet = scenes::wave_sheet(side, side, 0);
  Engines engines(sheet, scenes::ball(3, 2));
  std::vector<std::vector<std::array<double, 3>>> frames;
  for (int frame = 0; frame < 2; ++frame)
    frames.push_back(raw(scenes::wave_sheet(side, side, 0.001 * frame)).positions);
  const std::string name = fmt::format("sheet of {} triangles", 2 * side * side);
  const auto both = [&](const std::string& what, const std::function<void(against::Engine&)>& call) {
    compare(
        name + ": " + what, [&] { call(*engines.before); }, [&] { call(*engines.now); });
  };
  both("build", [](against::Engine& engine) { engine.build(); });
  both("move all and commit, twice", [&](against::Engine& engine) {
    for (const auto& frame : frames) engine.move_all(frame);
  });
  for (const std::size_t count : {1U, 100U}) {
    std::vector<std::uint32_t> ids;
    std::vector<std::array<double, 3>> places[2];
    for (std::size_t i = 0; i < count; ++i) {
      ids.push_back(static_cast<std::uint32_t>(i * (frames[0].size() / count)));
      for (int frame = 0; frame < 2; ++frame)
        places[frame].push_back(frames[static_cast<std::size_t>(frame)][ids.back()]);
    }
    both(fmt::format("move {} anywhere and commit, twice", count), [&](against::Engine& engine) {
      for (const auto& to : places) engine.move(ids, to);
    });
  }
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber;
  using namespace limber::bench;
  fmt::print("| what | before, us | now, us | now / before |\n| :-- | --: | --: | --: |\n");
  compare_queries(turned_ball_and_square(5));
  PeerScene sheets{"parallel sheets",
                   scenes::grid(64, 64, 0, 0, 1.0 / 64, 1.0 / 64),
                   scenes::grid(60, 60, 0.01, 0.02, 1.0 / 64, 1.0 / 64),
                   {}};
  sheets.situations = {{"0.1 apart", false, {Transform{{}, {0, 0, 0.1}}}},
                       {"0.001 apart", false, {Transform{{}, {0, 0, 0.001}}}}};
  compare_queries(sheets);
  PeerScene same{"a sheet over itself", sheets.a, sheets.a, sheets.situations};
  compare_queries(same);
  PeerScene rings{
      "linked rings", scenes::ring(1000, 1000, 0.1), scenes::ring(1000, 1000, 0.1), {{"2 million", false, {}}}};
  for (std::uint32_t index = 0; index < 5; ++index) rings.situations[0].poses.push_back(scenes::linked_ring(index));
  compare_queries(rings);
  if (argc > 1) {
    const std::filesystem::path folder = argv[1];
    compare_queries(two_scans("bunny and armadillo", folder / "stanford-bunny.obj", folder / "armadillo.obj", 10));
  }
  compare_updates(100);
  compare_updates(316);
  return EXIT_SUCCESS;
}
