// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "demo/brute_force.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "limber/geometry.h"

namespace limber::program {

double brute_force_distance(MeshView a, MeshView b, const Transform& a_from_b) {
  std::vector<Vec3> positions(b.positions.size());
  std::transform(b.positions.begin(), b.positions.end(), positions.begin(), a_from_b);
  const MeshView placed{positions, b.triangles};
  using Range = oneapi::tbb::blocked_range<TriangleId>;
  const auto least_of = [&](const Range& range, double least) {
    for (TriangleId i = range.begin(); i < range.end(); ++i) {
      for (TriangleId j = 0; j < placed.triangles.size(); ++j) {
        least = std::min(least, closest_points(a.triangle(i), placed.triangle(j)).distance);
      }
    }
    return least;
  };
  return oneapi::tbb::parallel_reduce(Range(0, static_cast<TriangleId>(a.triangles.size())),
                                      std::numeric_limits<double>::infinity(), least_of,
                                      [](double x, double y) { return std::min(x, y); });
}

}  // namespace limber::program
