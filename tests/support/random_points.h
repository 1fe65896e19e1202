// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "limber/points.h"
#include "reference/reference.h"
#include "support/random_geometry.h"

/// Points next to a mesh, and what is found for them.
namespace limber::testing {

/// A point of one of the kinds that break code: on a triangle, a corner or an edge, up to rounding or a little off it;
/// anywhere; far away, up to the largest coordinates. `size` is that of the mesh.
inline Vec3 arbitrary_query_point(Rng& rng, const reference::Placed& mesh, double size) {
  const Triangle t =
      mapped(mesh.mesh.triangle(static_cast<TriangleId>(rng.below(mesh.mesh.triangles.size()))), mesh.pose);
  const double u = rng.uniform(), v = rng.uniform() * (1 - u);
  switch (rng.below(10)) {
    case 0:
      return t[rng.below(3)];
    case 1:
      return 0.5 * t.v0 + 0.5 * t.v1;
    case 2:
      return nudged(rng, point_on(t, u, v));
    case 3:
      return point_on(t, u, v) + size * std::pow(10.0, rng.uniform(-16, -1)) * uniform_point(rng);
    case 4:
      return point_on(t, rng.uniform(-1, 2), rng.uniform(-1, 2));
    case 5: {  // far away
      const Vec3 far = size * std::pow(10.0, rng.uniform(0, 20)) * uniform_point(rng);
      return max_abs(far) < max_coordinate ? far : Vec3{};
    }
    case 6:  // where the coordinates of the world have no digits left for the mesh
      return (rng.below(8) == 0 ? 1.0 : 0x1p-40) * max_coordinate * uniform_point(rng);
    default:
      return t.v0 + 0.5 * size * uniform_point(rng);
  }
}

/// Whether two results are the same to the bit; the triangle only if asked for.
inline void expect_same_point(const PointResult& found, const PointResult& truth, const std::string& what,
                              bool names_same_triangle = true) {
  ASSERT_EQ(found.closest.has_value(), truth.closest.has_value()) << what;
  if (!truth.closest) return;
  const SurfacePoint &f = *found.closest, &t = *truth.closest;
  ASSERT_EQ(f.distance, t.distance) << what;
  ASSERT_EQ(f.position, t.position) << what;
  ASSERT_EQ(f.weights, t.weights) << what;
  ASSERT_EQ(f.feature, t.feature) << what;
  if (names_same_triangle) {
    ASSERT_EQ(f.triangle, t.triangle) << what;
  }
}

}  // namespace limber::testing
