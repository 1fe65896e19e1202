// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Closest points that were wrong, in the wrong frame, or not those of the distance, and distances of the wrong sign.
#include <optional>

#include "limber/elements.h"
#include "limber/points.h"
#include "limber/scene.h"
#include "peers.h"
#include "support/rational_winding.h"

namespace limber::testing {
namespace {

void expect_near(const Vec3& found, const Vec3& truth, double tolerance) {
  EXPECT_LE(length(found - truth), tolerance) << found.x << ' ' << found.y << ' ' << found.z;
}

// FCL #127, #227: a ball of radius 1 and a box; the distance is right, the point on the box is not. FCL #275: balls of
// radius 20 and 10 at a distance of 10; the distance found is 25, the points are elsewhere.
TEST(WitnessPoints, AreTheOnesBetweenTheBodies) {
  const Mesh unit = scenes::ball(32, 16);
  const Model ball(unit), brick(box({5, 1, 5})), big(stretched(unit, {20, 20, 20})),
      small(stretched(unit, {10, 10, 10}));
  struct Case {
    Placed a, b;
    Vec3 on_a, on_b;
  };
  for (const auto& [a, b, on_a, on_b] : {Case{{ball}, {brick, at(0, 5, 3)}, {0, 1, 0}, {0, 4, 0}},
                                         Case{{big}, {small, at(0, 40, 0)}, {0, 20, 0}, {0, 30, 0}}}) {
    EXPECT_NEAR(agreed_distance(a, b, 1e-13), length(on_b - on_a), 1e-13);
    const Witness w = distance(a, b).witness.value(), swapped = distance(b, a).witness.value();
    expect_near(w.point_a, on_a, 1e-13), expect_near(w.point_b, on_b, 1e-13);
    expect_near(swapped.point_a, on_b, 1e-13), expect_near(swapped.point_b, on_a, 1e-13);
  }
}

// FCL #525: the points of a robot and an octree are both on the octree. FCL PR #427: there are none for an octree and a
// mesh. FCL #540: a mesh and a box are no pair at all. The cells of the octree are boxes here, in a scene and as one
// mesh.
TEST(WitnessPoints, OfManyCellsAndAnArmLieOnBothWhicheverComesFirst) {
  scenes::Rng rng(525);
  const Model cell(box({0.5, 0.5, 0.5})), arm(stretched(scenes::ball(12, 8), {0.3, 0.3, 2}));
  limber::Scene scene;
  std::vector<Triangle> triangles;
  for (int i = 0; i < 60; ++i) {
    const Vec3 p = random_point(rng, 1);
    const Transform pose = at(std::round(9 * p.x), std::round(9 * p.y), 6 + std::round(3 * p.z));
    const Placed cell_there{cell, pose};
    static_cast<void>(scene.add(cell_there));
    for (TriangleId id = 0; id < 12; ++id) triangles.push_back(placed_triangle(cell_there, id));
  }
  const Model octree(triangles_of(triangles));
  const ObjectId arm_id = scene.add({arm});
  const auto with_arm = [&](ObjectId a, ObjectId b) { return a == arm_id || b == arm_id; };
  for (int i = 0; i < 20; ++i) {
    const Transform pose = random_pose(rng, 1);
    scene.set_pose(arm_id, pose);
    scene.commit();
    const double truth = agreed_distance({octree}, {arm, pose}, 1e-13);
    const ClosestObjectsResult closest = scene.closest_objects({.filter = with_arm});
    EXPECT_NEAR(closest.result.upper, truth, 1e-13);
    EXPECT_EQ(closest.objects.b, arm_id);
    expect_witness(scene.object(closest.objects.a), scene.object(arm_id), closest.result.witness.value(), truth, 1e-13);
  }
}

// FCL #393: the closest point on a flat face jumps from frame to frame. Nearly parallel faces have one closest corner,
// however little they are tilted; a question that is repeated gets the point it got before; and the distance never
// changes by more than the bodies move.
TEST(WitnessPoints, OfNearlyParallelFacesAreTheOnesThatAreLowest) {
  const Model floor(scenes::grid(1, 1, -5, -5, 10, 10)), plate(box({1, 1, 0.25}));
  QueryCache cache;
  double previous = 0;
  for (int i = 0; i <= 100; ++i) {
    const double tilt = 1e-10 * (i - 50.5);
    const Transform pose = transform_from_quaternion({0, 0, 1}, 1, 0.5 * tilt, 0.25 * tilt, 0).value();
    const Placed a{floor}, b{plate, pose};
    const DistanceResult found = distance(a, b, {.cache = &cache});
    const Vec3 lowest = pose({tilt < 0 ? -1.0 : 1.0, tilt < 0 ? 1.0 : -1.0, -0.25});
    ASSERT_NEAR(found.upper, lowest.z, 0x1p-44);
    expect_near(found.witness->point_b, lowest, 1e-12);
    const DistanceResult again = distance(a, b, {.cache = &cache}), cold = distance(a, b), cold_again = distance(a, b);
    EXPECT_EQ(again.witness->point_b, found.witness->point_b);
    EXPECT_EQ(cold.witness->point_b, cold_again.witness->point_b);
    EXPECT_EQ(cold.upper, found.upper);
    if (i > 0) {
      EXPECT_LE(std::abs(found.upper - previous), 2e-10);
    }
    previous = found.upper;
  }
}

// python-fcl #54, #48: a ball of radius 1e-4 on a face of a tetrahedron gets points that are on neither.
TEST(WitnessPoints, OfATinyBallInAFaceIsOnePointOfBoth) {
  const Model tetrahedron(
      Mesh::create({{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}}, {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}}).value());
  for (const double radius : {1e-4, 1e-9, 1e-14}) {
    const Model ball(stretched(scenes::ball(16, 8), {radius, radius, radius}));
    const Placed b{ball, at(1.5, 1.25, 1)};
    EXPECT_EQ(agreed_distance({tetrahedron}, b, 1e-15), 0) << radius;
    const Witness w = distance({tetrahedron}, b).witness.value();
    expect_near(w.point_a, {1.5, 1.25, 1}, radius + 1e-15);
    EXPECT_EQ(w.triangle_a, 0U);
  }
}

// Coal #257: the closest point of a tilted surface is not below the point that was asked about.
TEST(WitnessPoints, OfATiltedSurfaceIsTheFootOfThePerpendicular) {
  const Model surface(scenes::grid(20, 20, -5, -5, 0.5, 0.5));
  const Vec3 left{-0.3, 0.1, 2}, right{0.4, -0.2, 3};
  // A tip that is any corner of its triangle.
  const Model tip0(triangles_of({{{}, left, right}})), tip1(triangles_of({{right, {}, left}})),
      tip2(triangles_of({{left, right, {}}}));
  scenes::Rng rng(257);
  for (int i = 0; i < 100; ++i) {
    const Transform pose = random_pose(rng, 3);
    const Vec3 foot{rng.uniform(-4, 4), rng.uniform(-4, 4), 0};
    const double height = rng.uniform(0.01, 0.9);
    const Transform tip_pose = pose * Transform{{}, foot + Vec3{0, 0, height}};
    const SurfacePoint found = closest_point({surface, pose}, tip_pose.translation).closest.value();
    EXPECT_NEAR(found.distance, height, 1e-14);
    expect_near(found.position, pose(foot), 1e-13);
    for (const Model* tip : std::initializer_list<const Model*>{&tip0, &tip1, &tip2}) {
      const DistanceResult forth = distance({surface, pose}, {*tip, tip_pose});
      const DistanceResult back = distance({*tip, tip_pose}, {surface, pose});
      EXPECT_NEAR(forth.upper, height, 1e-14);
      EXPECT_NEAR(back.upper, height, 1e-14);
      expect_near(forth.witness->point_a, pose(foot), 1e-13);
      expect_near(back.witness->point_b, pose(foot), 1e-13);
    }
  }
}

// Coal #823: the points of bodies that penetrate each other are far from where they do. python-fcl #54 is another one.
// ifc-lite PR #2815: the middle of all corners stands in for a point that is on both triangles.
TEST(WitnessPoints, OfBodiesThatMeetIsWhereTheyDo) {
  const Model ball(scenes::ball(16, 8)), big(triangles_of({{{-900, -900, 0}, {1000, -1, 0}, {1000, 1, 0}}}));
  for (const double x : {0.1, 0.7, 1.3, 1.9, 1.98}) {
    const Placed a{ball}, b{ball, at(x, 0.01, 0.02)};
    ASSERT_EQ(agreed_distance(a, b, 1e-14), 0);
    const Vec3 p = distance(a, b).witness->point_a;
    // Between the spheres around and inside the triangles of either ball.
    for (const double radius : {length(p), length(p - b.pose.translation)}) {
      EXPECT_LE(radius, 1 + 1e-15);
      EXPECT_GE(radius, 0.94);
    }
  }
  const Placed corner{ball, at(1000.5, 0, 0.5)};
  ASSERT_EQ(agreed_distance({big}, corner, 1e-12), 0);
  expect_near(distance({big}, corner).witness->point_a, {1000, 0, 0}, 1.5);
}

// trimesh PR #907, PR #164: of two triangles that are equally close, the point is on one, and the other is named.
// trimesh #1089: a vertex of no triangle is the closest one, and the query fails.
TEST(WitnessPoints, OfATieBelongToTheTriangleThatIsNamed) {
  // A wedge whose edge is closest from everywhere in front of it.
  const Model wedge(
      Mesh::create({{0, 0, -1}, {0, 0, 1}, {-1, 0.1, 0}, {-1, -0.1, 0}, {0.5, 0, 0}}, {{0, 1, 2}, {1, 0, 3}}).value());
  for (const double y : {-0.3, -1e-9, 0.0, 1e-9, 0.3}) {
    const SurfacePoint found = closest_point({wedge}, {0.7, y, 0.25}).closest.value();
    expect_near(found.position, {0, 0, 0.25}, 1e-15);
    EXPECT_EQ(found.triangle, 0U);
    EXPECT_EQ(found.feature.kind, FeatureKind::edge);
    const Triangle t = wedge.mesh().triangle(found.triangle);
    const Vec3 rebuilt = found.weights[0] * t.v0 + found.weights[1] * t.v1 + found.weights[2] * t.v2;
    expect_near(rebuilt, found.position, 1e-15);
  }
}

// three-mesh-bvh #914: two queries give barycentric coordinates in different orders of the corners.
TEST(WitnessPoints, HaveWeightsInTheOrderOfTheCorners) {
  const Model face(triangles_of({{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}})),
      tip(triangles_of({{{1, 2, 1}, {1, 2, 2}, {1, 2, 3}}}));
  const SurfacePoint found = closest_point({face}, {1, 2, 1}).closest.value();
  EXPECT_EQ(found.weights, (Vec3{0.625, 0.125, 0.25}));
  std::vector<VertexFacePair> pairs(9);
  std::vector<EdgeEdgePair> edge_pairs(9);
  const ElementPairCount count = element_pairs({face}, {tip}, 1, pairs, edge_pairs);
  ASSERT_EQ(count.vertex_face, 1U);
  EXPECT_EQ(pairs[0].weights, (Vec3{0.625, 0.125, 0.25}));
  const Model other(triangles_of({{{0, 8, 0}, {0, 0, 0}, {8, 0, 0}}}));
  EXPECT_EQ(closest_point({other}, {1, 2, 1}).closest->weights, (Vec3{0.25, 0.625, 0.125}));
}

// Drake PR #17789: a field of a result keeps what an earlier query has left there.
TEST(WitnessPoints, AreAbsentWhereNothingWasFound) {
  const Model cube(box({1, 1, 1}));
  QueryCache cache;
  EXPECT_TRUE(distance({cube}, {cube, at(1)}, {.cache = &cache}).witness.has_value());
  EXPECT_FALSE(distance({cube}, {cube, at(9)}, {.max_distance = 1, .cache = &cache}).witness.has_value());
  EXPECT_FALSE(closest_point({cube}, {9, 0, 0}, {.max_distance = 1}).closest.has_value());
  // Lists are written as far as something was found, and no further.
  std::vector<Contact> list(100);
  for (Contact& c : list) c.distance = -7;
  const std::size_t count = contacts({cube}, {cube, at(2.5)}, 0.75, list).count;
  ASSERT_LT(count, list.size());
  for (std::size_t i = 0; i < list.size(); ++i) EXPECT_EQ(list[i].distance == -7, i >= count);
}

std::vector<Triangle> all_triangles(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (TriangleId id = 0; id < mesh.triangles().size(); ++id) triangles.push_back(mesh.triangle(id));
  return triangles;
}

/// Signs agree with winding numbers in rational arithmetic, magnitudes with brute force.
void expect_signed_distance(const ClosedSurface& surface, const Vec3& p) {
  const Mesh& mesh = surface.model().mesh();
  const SignedDistance found = surface.signed_distance(p);
  const double truth = reference::closest_point({mesh}, p).closest->distance;
  ASSERT_EQ(std::abs(found.distance()), truth);
  if (truth == 0) {
    EXPECT_FALSE(std::signbit(found.distance()));
    return;
  }
  const int winding = rational_winding(all_triangles(mesh), p);
  ASSERT_EQ(found.is_inside, winding != 0) << p.x << ' ' << p.y << ' ' << p.z;
  EXPECT_EQ(surface.winding_number(p), winding);
}

// Open3D #5105: a point outside a cube is inside, because a ray from it meets an edge.
TEST(Inside, IsRightWhereRaysMeetEdgesAndCorners) {
  const Model cube(box({0, 0, 0}, {1, 1, 1}));
  const ClosedSurface surface = ClosedSurface::create(cube).value();
  EXPECT_EQ(surface.signed_distance({-1, -1, 0}).distance(), std::sqrt(2));
  EXPECT_EQ(surface.signed_distance({-1, -1, -1}).distance(), std::sqrt(3));
  EXPECT_EQ(surface.signed_distance({0.5, 0.5, 0.5}).distance(), -0.5);
  // Two cubes as one surface, so that rays go on, and points between the cubes lie in the planes of faces.
  const Model two(joined(cube.mesh(), box({2, 2, 2}, {3, 3, 3})));
  const ClosedSurface both = ClosedSurface::create(two).value();
  const auto is_between = [](int low, int high, const Vec3& p) {
    return std::min({p.x, p.y, p.z}) >= low && std::max({p.x, p.y, p.z}) <= high;
  };
  for (int i = 0; i < 17 * 17 * 17; ++i) {
    const Vec3 p = 0.25 * Vec3{i % 17 - 2.0, i / 17 % 17 - 2.0, i / (17 * 17) - 2.0};
    ASSERT_EQ(surface.contains(p), is_between(0, 1, p)) << i;
    ASSERT_EQ(both.contains(p), is_between(0, 1, p) || is_between(2, 3, p)) << i;
  }
}

// axom #703, PR #706, CGAL #1288: wrong signs of points that are closest to an edge or a corner.
TEST(Inside, IsRightWhereAnEdgeOrACornerIsClosest) {
  scenes::Rng rng(703);
  const Model tetrahedron(hull({{0, 0, 0}, {1, 0, 0.1}, {0.2, 1, 0}, {0.1, 0.3, 1}}));
  const ClosedSurface surface = ClosedSurface::create(tetrahedron).value();
  for (int i = 0; i < 1500; ++i) {
    const Triangle t = tetrahedron.mesh().triangle(static_cast<TriangleId>(rng.below(4)));
    const double u = rng.below(3) == 0 ? 0 : rng.uniform();
    const Vec3 on_edge = t.v0 + u * (t.v1 - t.v0);
    expect_signed_distance(surface, on_edge + std::pow(10.0, rng.uniform(-16, -0.5)) * random_point(rng, 1));
  }
}

// axom #783, PR #784: wrong signs next to an edge with an acute angle between triangles of very different areas.
// libigl #906: bumps where triangles are slivers.
TEST(Inside, IsRightNextToSharpEdgesOfUnequalTriangles) {
  scenes::Rng rng(783);
  for (const double angle : {0.3, 1e-2, 1e-5, 1e-9}) {
    for (const double small : {0.1, 1e-4, 1e-8}) {
      // A blade along the y axis with its edge at the origin: two long sides that include the angle, a thin back.
      const double h = 0.5 * angle;
      const Model blade(
          Mesh::create({{0, 0, 0}, {0, small, 0}, {10, 0, -h}, {10, 0, h}, {10, small, -h}, {10, small, h}},
                       {{0, 1, 2}, {1, 4, 2}, {0, 3, 1}, {1, 3, 5}, {2, 4, 3}, {3, 4, 5}, {0, 2, 3}, {1, 5, 4}})
              .value());
      const ClosedSurface surface = ClosedSurface::create(blade).value();
      for (int i = 0; i < 60; ++i) {
        const double size = std::pow(10.0, rng.uniform(-12, 0));
        const Vec3 along{i % 2 == 0 ? 0 : rng.uniform(0, 10), rng.uniform(0, small), 0};
        expect_signed_distance(surface, along + size * random_point(rng, 1));
      }
    }
  }
}

}  // namespace
}  // namespace limber::testing
