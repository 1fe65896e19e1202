// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Closest points of many points in one call, on one thread and on two.
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "bench/contacts/contact_bench.h"
#include "bench/contacts/linked_projectors.h"
#include "bench/contacts/peer_points.h"
#include "limber/points.h"

namespace limber::bench {
namespace {

/// A library that peers.py asks.
struct Projector {
  const char *name, *peer;
  double tolerance;  // of the size
};

/// Parts of the size. Libraries of float round each vertex by up to 2^-24 of its coordinates, which for the bunny are
/// below its size, and a distance a few times.
constexpr double of_float = 0x1p-22, of_double = 1e-9;
constexpr Projector projectors[] = {
    {"FCPW, float32", "fcpw", of_float}, {"MeshLib, float32", "meshlib", of_float}, {"trimesh", "trimesh", of_double}};

std::vector<LinkedProjector> linked_projectors([[maybe_unused]] const Mesh& mesh) {
  return {
#ifdef LIMBER_PEER_EMBREE
      embree_projector(mesh),
#endif
#ifdef LIMBER_PEER_CGAL
      cgal_projector(mesh),
#endif
  };
}

bool same_distances(const std::vector<PointResult>& a, const std::vector<PointResult>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const PointResult& x, const PointResult& y) {
    return x.closest->distance == y.closest->distance && x.closest->triangle == y.closest->triangle;
  });
}

}  // namespace

void ContactBench::points(const std::string& name, const Mesh& mesh, const std::string& kind) {
  const std::string question = "points_" + kind;
  const auto points = settings_.answers.empty() ? std::nullopt : read_points(settings_.answers / (question + ".txt"));
  if (!points) {
    fmt::print(stderr, "{} is left out: peers.py, which makes the points, has not run\n", question);
    return;
  }
  fmt::print(stderr, "{}, {}\n", name, question);
  const Model model(mesh);
  std::vector<PointResult> results(points->size()), of_two_threads(points->size());
  oneapi::tbb::task_arena one(1), two(2);
  const auto ask_one = [&] { one.execute([&] { closest_points({model}, *points, results); }); };
  const auto ask_two = [&] { two.execute([&] { closest_points({model}, *points, of_two_threads); }); };
  ask_one(), ask_two();

  const PointAnswers ours{mesh, diagonal(mesh), *points, results};
  check_points(name, ours, checker_);
  if (!checker_.all_right()) return;
  checker_.check(same_distances(results, of_two_threads), "{}, {}: two threads have other answers", name, question);
  for (const Projector& projector : projectors) {
    const std::string file = std::string(projector.peer) + "_" + name + "_" + question + ".txt";
    const auto theirs = read_distances(settings_.answers / file, points->size());
    if (!theirs) continue;
    point_differences_.push_back(
        compare_points(question, name, projector.name, ours, *theirs, projector.tolerance, checker_));
  }
  const std::vector<LinkedProjector> linked = linked_projectors(mesh);
  std::vector<double> distances(points->size());
  for (const LinkedProjector& projector : linked) {
    projector.ask(*points, distances);
    point_differences_.push_back(compare_points(question, name, projector.library, ours, distances,
                                                projector.is_float ? of_float : of_double, checker_));
  }
  if (!checker_.all_right()) return;

  const bool has_two = oneapi::tbb::info::default_concurrency() >= 2;
  std::vector<std::function<void()>> calls{ask_one};
  if (has_two) calls.emplace_back(ask_two);
  const std::vector<Timed> times = time_in_turn(calls);
  const std::string count = std::to_string(points->size());
  Row row{question, name, times[0], count, {}};
  for (const LinkedProjector& projector : linked) {
    const Timed taken = time([&] { projector.ask(*points, distances); });
    row.peers.push_back({projector.library, projector.setting, count, taken});
  }
  for (const Projector& projector : projectors) add_peer(row, projector.name, projector.peer, name, question);
  rows_.push_back(row);
  if (!has_two) {
    fmt::print(stderr, "{} on two threads is left out: this process may use one processor only\n", question);
    return;
  }
  rows_.push_back(
      {question + ", two threads", name, times.back(), count, {{"limber, one thread", "", count, times[0]}}});
}

}  // namespace limber::bench
