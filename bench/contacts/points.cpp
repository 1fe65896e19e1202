// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Closest points of many points in one call.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "bench/contacts/contact_bench.h"
#include "bench/peers/peer.h"
#include "limber/geometry.h"
#include "limber/points.h"

namespace limber::bench {
namespace {

/// The closest points of a mesh, as found by limber.
struct PointAnswers {
  MeshView mesh;
  double size = 0;  ///< of the mesh
  std::span<const Vec3> points;
  std::span<const PointResult> results;
};

constexpr double rounding_of_size = 1e-12;     // of a point and its distance, as computed here
constexpr double brute_force_of_size = 1e-10;  // below all tolerances; directions of short distances are less exact

bool is_on_surface(const PointAnswers& ours, std::size_t i) {
  const SurfacePoint& found = *ours.results[i].closest;
  const Triangle triangle = ours.mesh.triangle(found.triangle);
  Vec3 position{0, 0, 0};
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(found.weights[k] >= 0)) return false;
    position += found.weights[k] * triangle[k];
    sum += found.weights[k];
  }
  const double rounding = rounding_of_size * ours.size;
  return std::abs(sum - 1) <= rounding_of_size && length(position - found.position) <= rounding &&
         std::abs(length(ours.points[i] - found.position) - found.distance) <= rounding;
}

/// Whether no triangle is closer: for each there is a direction along which it is apart from the point by as much. The
/// direction is that to the triangle's closest point, but need not be right for this to prove it.
bool is_least(const PointAnswers& ours, std::size_t i) {
  const Vec3& point = ours.points[i];
  const double least = ours.results[i].closest->distance - brute_force_of_size * ours.size;
  if (least <= 0) return true;
  for (TriangleId t = 0; t < ours.mesh.triangles.size(); ++t) {
    const Triangle triangle = ours.mesh.triangle(t);
    const ClosestPoints closest = closest_points(point, triangle);
    if (closest.distance < least) return false;
    const Vec3 direction = (1 / closest.distance) * (point - closest.point_b);
    for (std::size_t k = 0; k < 3; ++k) {
      if (dot(point - triangle[k], direction) < least) return false;
    }
  }
  return true;
}

/// Checks that each answer is a point of its triangle at the distance that it names, and by brute force that no
/// triangle is closer to every hundredth point.
void check_points(const std::string& mesh, const PointAnswers& ours, Checker& checker) {
  for (std::size_t i = 0; i < ours.points.size() && checker.all_right(); ++i) {
    if (!checker.check(ours.results[i].closest.has_value(), "{}: point {} has no answer", mesh, i)) return;
    checker.check(is_on_surface(ours, i), "{}: the point closest to {} is not on its triangle", mesh, i);
    checker.check(i % 100 != 0 || is_least(ours, i), "{}: a triangle is closer to the point {}", mesh, i);
  }
}

/// Compares distances up to `tolerance`, a part of the mesh's size. Where a library's distance is greater, ours proves
/// it wrong, once check_points() has passed. Where it is smaller, brute force decides; ours may be wrong then.
///
/// Pre      There is a distance for each point.
PointDifference compare_points(const std::string& question, const std::string& mesh, const std::string& library,
                               const PointAnswers& ours, std::span<const double> theirs, double tolerance,
                               Checker& checker) {
  PointDifference found{question, mesh, library, tolerance, ours.points.size()};
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    const double by = (theirs[i] - ours.results[i].closest->distance) / ours.size;
    if (std::isnan(by)) {
      ++found.others["no answer"];
    } else if (std::abs(by) <= tolerance) {
      ++found.agree;
      found.largest_of_agreeing = std::max(found.largest_of_agreeing, std::abs(by));
    } else {
      ++found.others[by > 0 ? "too far" : "too near"];
      found.largest = std::max(found.largest, std::abs(by));
      if (by < 0 && !checker.check(is_least(ours, i), "{}: {} is closer to point {}", mesh, library, i)) return found;
    }
  }
  return found;
}

/// The points in the order of the file, number and coordinates a line. None if the file is missing.
std::optional<std::vector<Vec3>> read_points(const std::filesystem::path& path) {
  const auto lines = read_numbers<4>(path);
  if (!lines) return std::nullopt;
  std::vector<Vec3> points;
  for (const auto& [number, x, y, z] : *lines) points.push_back({x, y, z});
  return points;
}

/// The distances of `count` points that a peer has written, number and distance a line; NaN where it has none. None if
/// the file is missing.
std::optional<std::vector<double>> read_distances(const std::filesystem::path& path, std::size_t count) {
  const auto lines = read_numbers<2>(path);
  if (!lines) return std::nullopt;
  std::vector<double> distances(count, std::numeric_limits<double>::quiet_NaN());
  for (const auto& [number, distance] : *lines) distances.at(static_cast<std::size_t>(number)) = distance;
  return distances;
}

/// A library that peers.py asks.
struct AskedProjector {
  const char *name, *peer;
  double tolerance;  // of the size
};

/// Parts of the size. Libraries of float round each vertex by up to 2^-24 of its coordinates, which for the bunny are
/// below its size, and a distance a few times.
constexpr double of_float = 0x1p-22, of_double = 1e-9;
constexpr AskedProjector asked_projectors[] = {
    {"FCPW, float32", "fcpw", of_float}, {"MeshLib, float32", "meshlib", of_float}, {"trimesh", "trimesh", of_double}};

/// Libraries that are linked into this program.
std::vector<Projector> linked_projectors([[maybe_unused]] const Mesh& mesh) {
  return {
#ifdef LIMBER_PEER_EMBREE
      embree_projector(mesh),
#endif
#ifdef LIMBER_PEER_CGAL
      cgal_projector(mesh),
#endif
  };
}

}  // namespace

void ContactBench::points(const std::string& name, const Mesh& mesh, const std::string& kind) {
  const std::string question = "points_" + kind;
  const auto points = read_points(answer(question));
  if (!points) {
    fmt::print(stderr, "{} is left out: peers.py, which makes the points, has not run\n", question);
    return;
  }
  fmt::print(stderr, "{}, {}\n", name, question);
  const Model model(mesh);
  std::vector<PointResult> results(points->size());
  const auto ask = [&] { closest_point_many({model}, *points, results); };
  ask();

  const PointAnswers ours{mesh, diagonal(mesh), *points, results};
  check_points(name, ours, checker_);
  if (!checker_.all_right()) return;
  for (const AskedProjector& projector : asked_projectors) {
    const auto theirs = read_distances(answer(fmt::format("{}_{}_{}", projector.peer, name, question)), points->size());
    if (!theirs) continue;
    point_differences_.push_back(
        compare_points(question, name, projector.name, ours, *theirs, projector.tolerance, checker_));
  }
  const std::vector<Projector> linked = linked_projectors(mesh);
  std::vector<double> distances(points->size());
  const auto ask_all = [&](const Projector& projector) {
    std::transform(points->begin(), points->end(), distances.begin(), projector.distance);
  };
  for (const Projector& projector : linked) {
    ask_all(projector);
    point_differences_.push_back(compare_points(question, name, projector.library, ours, distances,
                                                projector.is_float ? of_float : of_double, checker_));
  }
  if (!checker_.all_right()) return;

  const std::string count = std::to_string(points->size());
  Row row{question, name, time(ask), count};
  for (const Projector& projector : linked) {
    const Timed taken = time([&] { ask_all(projector); });
    row.peers.push_back({projector.library, projector.setting, count, taken});
  }
  for (const AskedProjector& projector : asked_projectors) add_peer(row, projector.name, projector.peer, question);
  rows_.push_back(row);
}

}  // namespace limber::bench
