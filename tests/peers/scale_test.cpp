// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Answers that were wrong because of the size, number, place or direction of triangles.
#include "limber/elements.h"
#include "limber/points.h"
#include "peers.h"
#include "simd/kernels.h"

namespace limber::testing {
namespace {

// svenstaro/bvh #159, toolbox-rs #580: the shape with the nearest box, or corner of a box, is taken for the nearest
// shape. Unity hair #98: a point inside a box counts as far from it.
TEST(ScaleAndPlace, NearestTriangleIsNotTheOneWithTheNearestBox) {
  // Diagonal triangles whose boxes hold the point, and a small one beside all boxes that is closest.
  std::vector<Triangle> triangles;
  for (int i = 0; i < 40; ++i) {
    const double s = 10 + i;
    triangles.push_back({{s, 0.1, 0.1}, {0.1, s, 0.1}, {0.1, 0.1, s}});
    triangles.push_back({{-s, s, 0.1}, {s, 0.2, -s}, {0.2, s, s}});
  }
  triangles.push_back({{-1, -1, -1}, {-1.1, -1, -1}, {-1, -1.1, -1}});
  const Model model(triangles_of(triangles)),
      probe(triangles_of({{{0.2, 0.2, 0.2}, {0.3, 0.2, 0.2}, {0.2, 0.3, 0.2}}}));
  const SurfacePoint found = closest_point({model}, {0.2, 0.2, 0.2}).closest.value();
  EXPECT_EQ(found.triangle, triangles.size() - 1);
  EXPECT_NEAR(found.distance, 1.2 * std::sqrt(3), 1e-15);
  EXPECT_NEAR(agreed_distance({model}, {probe}, 1e-14), 1.2 * std::sqrt(3), 1e-14);
}

// exotica #153: distances are wrong when triangles are large. ShapeWorks #812: the triangle is sought among those of
// the nearest vertices, which a huge one has far away.
TEST(ScaleAndPlace, HugeTrianglesAreAsNearAsTheirPointsAre) {
  for (const double size : {1e3, 1e6, 1e9}) {
    std::vector<Triangle> triangles{{{-size, -size, 0}, {size, -size, 0}, {0, 2 * size, 0}}};
    for (int i = 0; i < 200; ++i) {  // small ones with many vertices near the probe, but farther than the large one
      const Vec3 p{0.1 * (i % 15), 0.1 * (i / 15.0), -0.5};
      triangles.push_back({p, p + Vec3{0.05, 0, 0}, p + Vec3{0, 0.05, 0}});
    }
    const Model floor(triangles_of(triangles)), tool(scenes::ball(12, 8));
    const Transform pose = at(0.6, 0.5, 1.25);
    const DistanceResult found = distance({floor}, {tool, pose});
    EXPECT_NEAR(found.upper, 0.25, 0x1p-44 * size);
    EXPECT_EQ(found.witness->triangle_a, 0U);
    EXPECT_NEAR(found.witness->point_a.x, 0.6, 1e-6 + 0x1p-44 * size);
    const SurfacePoint point = closest_point({floor}, {0.6, 0.5, 0.25}).closest.value();
    EXPECT_EQ(point.triangle, 0U);
    EXPECT_NEAR(point.distance, 0.25, 0x1p-44 * size);
    EXPECT_FALSE(collide({floor}, {tool, at(0.6, 0.5, 1.0000001)}).is_yes());
    EXPECT_TRUE(collide({floor}, {tool, at(0.6, 0.5, 0.9999999)}).is_yes());
  }
}

// IPC Toolkit PR #225: an absolute threshold takes nearly collinear edges for parallel ones at a distance of 0.
// libuipc PR #361: nearly parallel edges again.
TEST(ScaleAndPlace, EdgesThatAreNearlyParallelOrCollinearKeepTheirDistance) {
  scenes::Rng rng(225);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p = random_point(rng, 1), q = random_point(rng, 1);
    const double gap = std::pow(10.0, rng.uniform(-6, 0)), bend = std::pow(10.0, rng.uniform(-18, -2));
    const Vec3 step = q - p;
    const Vec3 start = i % 2 == 0 ? q + gap * step : p + gap * cross(step, random_point(rng, 1));
    const Segment s{p, q}, t{start, start + step + bend * random_point(rng, 1)};
    const ClosestPoints found = closest_points(s, t);
    expect_exact(found.distance, exact::squared_distance(Triangle{s.p0, s.p1, s.p1}, Triangle{t.p0, t.p1, t.p1}),
                 0x1p-47);
    EXPECT_GT(found.distance, 0);
    // As edges of meshes, and in the list that a solver of such constraints reads.
    const Model a(Mesh::create({s.p0, s.p1}, {{0, 1, 1}}).value()), b(Mesh::create({t.p0, t.p1}, {{0, 1, 1}}).value());
    std::vector<EdgeEdgePair> pair(1);
    ASSERT_EQ(element_pairs({a}, {b}, 5, {}, pair).edge_edge, 1U);
    EXPECT_NEAR(pair[0].distance, found.distance, 0x1p-47);
  }
}

// Scalable-CCD #8: in float32 the promise to miss nothing is lost. Bodies far from the origin, whose gap or overlap no
// float32 can tell, are decided exactly on every instruction set.
TEST(ScaleAndPlace, ContactsBelowTheResolutionOfFloat32AreNotMissed) {
  const Model ball(scenes::ball(8, 6)), brick(box({1, 1, 1}));
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::use_kernels(&set);
    for (const double far : {0.0, 0x1p20, 0x1p30}) {
      for (const int bits : {20, 22}) {
        for (const int sign : {-1, 1}) {
          const double gap = sign * std::ldexp(1.0, -bits);
          const Placed a{brick, at(far, far, far)}, b{ball, at(far + 2 + gap, far, far)};
          const double found = agreed_distance(a, b, 0x1p-44 * (1 + far));
          EXPECT_EQ(found == 0, sign < 0) << far << ' ' << bits;
          if (sign > 0) {
            EXPECT_NEAR(found, gap, 0x1p-44 * (1 + far));
          }
        }
      }
    }
  }
  simd::use_kernels(nullptr);
}

}  // namespace
}  // namespace limber::testing
