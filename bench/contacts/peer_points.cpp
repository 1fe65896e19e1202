// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/contacts/peer_points.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>

#include "bench/contacts/peer_answers.h"
#include "limber/geometry.h"

namespace limber::bench {
namespace {

constexpr double rounding_of_size = 1e-12;     // of a point and its distance, as computed here
constexpr double brute_force_of_size = 1e-10;  // below all tolerances; directions of short distances are less exact

bool is_on_surface(const PointAnswers& ours, std::size_t i) {
  const SurfacePoint& found = *ours.results[i].closest;
  const Triangle triangle = ours.mesh.triangle(found.triangle);
  Vec3 position{0, 0, 0};
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(found.barycentric[k] >= 0)) return false;
    position += found.barycentric[k] * triangle[k];
    sum += found.barycentric[k];
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

}  // namespace

std::optional<std::vector<Vec3>> read_points(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  std::vector<Vec3> points;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::size_t number = 0;
    Vec3 p;
    if (!(words >> number >> p.x >> p.y >> p.z) || number != points.size()) throw bad_line(path, line);
    points.push_back(p);
  }
  return points;
}

std::optional<std::vector<double>> read_distances(const std::filesystem::path& path, std::size_t count) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  std::vector<double> distances(count, std::numeric_limits<double>::quiet_NaN());
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::size_t number = 0;
    std::string distance;  // may be nan or inf, which streams do not read as numbers
    if (!(words >> number >> distance) || number >= count) throw bad_line(path, line);
    char* end = nullptr;
    distances[number] = std::strtod(distance.c_str(), &end);
    if (*end != '\0') throw bad_line(path, line);
  }
  return distances;
}

void check_points(const std::string& mesh, const PointAnswers& ours, Checker& checker) {
  for (std::size_t i = 0; i < ours.points.size() && checker.all_right(); ++i) {
    if (!checker.check(ours.results[i].closest.has_value(), "{}: point {} has no answer", mesh, i)) return;
    checker.check(is_on_surface(ours, i), "{}: the point closest to {} is not on its triangle", mesh, i);
    checker.check(i % 100 != 0 || is_least(ours, i), "{}: a triangle is closer to the point {}", mesh, i);
  }
}

PointDifference compare_points(const std::string& question, const std::string& mesh, const std::string& library,
                               const PointAnswers& ours, std::span<const double> theirs, double tolerance,
                               Checker& checker) {
  PointDifference found{question, mesh, library, tolerance, ours.points.size(), 0, 0, 0, {}};
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

}  // namespace limber::bench
