// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/brute_force.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "limber/geometry.h"

namespace limber::testing {
namespace {

struct PlacedTriangle {
  Triangle corners;
  Vec3 low, high;
};

std::vector<PlacedTriangle> placed_triangles_of(const reference::Placed& placed) {
  std::vector<PlacedTriangle> triangles;
  triangles.reserve(placed.mesh.triangles.size());
  for (TriangleId t = 0; t < placed.mesh.triangles.size(); ++t) {
    const Triangle model = placed.mesh.triangle(t);
    const Triangle world{placed.pose(model.v0), placed.pose(model.v1), placed.pose(model.v2)};
    triangles.push_back({world, min(min(world.v0, world.v1), world.v2), max(max(world.v0, world.v1), world.v2)});
  }
  return triangles;
}

/// The largest difference of two coordinates of corners.
double extent_of(const std::vector<PlacedTriangle>& a, const std::vector<PlacedTriangle>& b) {
  Vec3 low = a.front().low, high = a.front().high;
  for (const std::vector<PlacedTriangle>* triangles : {&a, &b}) {
    for (const PlacedTriangle& t : *triangles) low = min(low, t.low), high = max(high, t.high);
  }
  return max_abs(high - low);
}

/// The widest gap between two boxes along an axis; negative where they overlap.
double gap(const PlacedTriangle& a, const PlacedTriangle& b) {
  const Vec3 after = b.low - a.high, before = a.low - b.high;
  return std::max({after.x, after.y, after.z, before.x, before.y, before.z});
}

}  // namespace

double brute_force_distance(const reference::Placed& a, const reference::Placed& b) {
  const std::vector<PlacedTriangle> triangles_a = placed_triangles_of(a), triangles_b = placed_triangles_of(b);
  // Twice what closest_points() may be off by: docs/algorithms/numerics.md.
  const double error = 0x1p-49 * extent_of(triangles_a, triangles_b);
  double least = std::numeric_limits<double>::infinity(), too_far = least;
  for (const PlacedTriangle& s : triangles_a) {
    for (const PlacedTriangle& t : triangles_b) {
      if (gap(s, t) > too_far) continue;
      const double distance = closest_points(s.corners, t.corners).distance;
      if (distance >= least) continue;
      if (distance == 0) return 0;
      least = distance;
      too_far = (least + error) * (1 + 0x1p-50);
    }
  }
  return least;
}

}  // namespace limber::testing
