// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bodies that overlap, touch or contain each other: cases from reports about other libraries, which answered wrongly.
#include "limber/points.h"
#include "peers.h"
#include "support/rational_geometry.h"

namespace limber::testing {
namespace {

Rational exact_dot(const Vec3& a, const Vec3& b) { return dot(rational(a), rational(b)); }

/// How far the triangles overlap along a direction: how far b has to move along it to be in front of a.
Rational exact_overlap(const Triangle& a, const Triangle& b, const Vec3& direction) {
  Rational highest = exact_dot(a.v0, direction), lowest = exact_dot(b.v0, direction);
  for (std::size_t i = 1; i < 3; ++i) {
    highest = std::max(highest, exact_dot(a[i], direction)), lowest = std::min(lowest, exact_dot(b[i], direction));
  }
  return highest - lowest;
}

/// The least overlap of two triangles along the normals of faces and the common perpendiculars of edges.
double least_overlap(const Triangle& a, const Triangle& b) {
  std::vector<Vec3> axes{cross(a.v1 - a.v0, a.v2 - a.v0), cross(b.v1 - b.v0, b.v2 - b.v0)};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) axes.push_back(cross(a[(i + 1) % 3] - a[i], b[(j + 1) % 3] - b[j]));
  }
  double least = HUGE_VAL;
  for (const Vec3& axis : axes) {
    if (length(axis) < 1e-9) continue;
    for (const double sign : {1.0, -1.0}) {
      least = std::min(least, exact_overlap(a, b, sign * axis).get_d() / length(axis));
    }
  }
  return least;
}

/// Moving b by the depth parts the pair, in exact arithmetic, and no shorter way along a normal or a perpendicular of
/// edges does.
void expect_depths_part_pairs(const Placed& a, const Placed& b, double tolerance) {
  const std::vector<Contact> found = all_contacts(a, b, 0);
  EXPECT_FALSE(found.empty());
  for (const Contact& c : found) {
    const Triangle t = placed_triangle(a, c.triangle_a), u = placed_triangle(b, c.triangle_b);
    EXPECT_EQ(c.distance, 0);
    EXPECT_NEAR(length(c.normal), 1, 1e-15);
    EXPECT_LE(c.depth, least_overlap(t, u) + tolerance);
    // The normal of a closed mesh is the way out of the body, not the shortest way for the triangles.
    const TriangleContact plain = contact(t, u);
    EXPECT_NEAR(c.depth, plain.depth, tolerance);
    const Rational moved = (Rational(plain.depth) + Rational(0x1p-900)) * exact_dot(plain.normal, plain.normal);
    EXPECT_LE(exact_overlap(t, u, plain.normal), moved);
  }
}

// FCL #491: the distance of overlapping meshes stays 0 although a signed one was asked for.
TEST(Overlap, IsDistanceZeroWithAStatusOfItsOwnAndOneSharedPoint) {
  const Model a(box({1, 1, 1})), b(box({1, 1, 1}));
  for (const double depth : {0x1p-52, 1e-12, 1e-6, 0.01, 0.5, 1.0, 1.5, 2.0}) {
    const Placed here{a}, there{b, at(2 - depth, 0.3, 0.1)};
    EXPECT_EQ(agreed_distance(here, there, 1e-14), 0) << depth;
    EXPECT_EQ(distance(here, there, {.relative_error = 1, .absolute_error = 5}).status, DistanceStatus::collision)
        << depth;
    EXPECT_EQ(distance(here, there, {.max_distance = 0}).status, DistanceStatus::collision) << depth;
  }
  // No error that is asked for hides a contact, however few triangles meet.
  const Model ring(scenes::ring(24, 12, 0.3));
  scenes::Rng rng(491);
  std::size_t meeting = 0;
  for (int i = 0; i < 400; ++i) {
    const Placed there{ring, random_pose(rng, 1.5)};
    if (!collide({ring}, there).is_yes()) continue;
    ++meeting;
    for (const double error : {0.01, 0.3, 5.0}) {
      EXPECT_EQ(distance({ring}, there, {.relative_error = error}).upper, 0) << i;
      EXPECT_EQ(distance({ring}, there, {.absolute_error = error}).upper, 0) << i;
    }
  }
  EXPECT_GT(meeting, 100U);
}

// FCL #221, #574, #575, #245, exotica #364: the penetration depth of meshes is always 0 or odd. Coal #357: it is
// inconsistent. Jolt #529: the axis along which a shape should leave a mesh is unreliable, the more the deeper it is.
TEST(Overlap, HasADepthForEachPairOfTrianglesThatPartsThem) {
  const Model cube(box({1, 1, 1})), ball(scenes::ball(12, 8)), floor(scenes::grid(5, 5, -2.5, -2.5, 1, 1));
  const Transform turned = transform_from_quaternion({1.3, 0.4, 0.2}, 0.9, 0.1, -0.3, 0.2).value();
  expect_depths_part_pairs({cube}, {cube, turned}, 1e-12);
  expect_depths_part_pairs({cube, turned}, {ball}, 1e-12);
  for (const double depth : {1e-9, 0.01, 0.3, 0.9})
    expect_depths_part_pairs({floor}, {ball, at(0.1, 0.2, 1 - depth)}, 1e-12);
}

// FCL #503: two cubes that share a face get depths of the size of the cubes.
TEST(Overlap, OfCubesThatShareAFaceIsNoDeeperThanRounding) {
  const Mesh left =
      Mesh::create({{-2, -1, 0}, {-2, -1, 2}, {-2, 1, 0}, {-2, 1, 2}, {0, -1, 0}, {0, -1, 2}, {0, 1, 0}, {0, 1, 2}},
                   {{1, 2, 0},
                    {3, 6, 2},
                    {7, 4, 6},
                    {5, 0, 4},
                    {6, 0, 2},
                    {3, 5, 7},
                    {1, 3, 2},
                    {3, 7, 6},
                    {7, 5, 4},
                    {5, 1, 0},
                    {6, 4, 0},
                    {3, 1, 5}})
          .value();
  const Mesh right =
      Mesh::create({{0, -1, 0}, {0, -1, 2}, {0, 1, 0}, {0, 1, 2}, {2, 1, 2}, {2, -1, 2}, {2, -1, 0}, {2, 1, 0}},
                   {{4, 2, 3},
                    {7, 0, 2},
                    {6, 4, 5},
                    {6, 1, 0},
                    {5, 3, 1},
                    {3, 0, 1},
                    {4, 7, 2},
                    {7, 6, 0},
                    {6, 7, 4},
                    {6, 5, 1},
                    {5, 4, 3},
                    {3, 2, 0}})
          .value();
  const Model a(left), b(right);
  EXPECT_EQ(agreed_distance({a}, {b}, 0), 0);
  for (const Contact& c : all_contacts({a}, {b}, 0)) {
    EXPECT_LE(c.depth, 0x1p-45);
    EXPECT_NEAR(c.point_a.x, 0, 0x1p-45);
  }
  // One step to the right they are apart by that step.
  EXPECT_EQ(agreed_distance({a}, {b, at(0x1p-40)}, 0), 0x1p-40);
}

// trimesh #1875 asks whether a mesh is a surface or a solid; ncollide #241 and #263, Parry #4, KrisLibrary #12 and
// lovr #672 are bodies that do not collide while wholly inside another; trimesh #2223 is a cube in a ball in a cone of
// which two do.
TEST(Overlap, OfNestedBodiesIsNoneForSurfacesAndSolidsAreAskedByName) {
  std::vector<Vec3> rim{{0, 0, 9}};
  const std::uint32_t count = 24;
  std::vector<Corners> sides;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * 3.14159265358979323846 * i / count;
    rim.push_back({6 * scenes::cosine(angle), 6 * scenes::sine(angle), -3});
    sides.push_back({0, 1 + i, 1 + (i + 1) % count});
    if (i >= 2) sides.push_back({1, 1 + i, i});
  }
  const Model cone(Mesh::create(rim, sides).value()), ball(scenes::ball(32, 16)), cube(box({0.25, 0.25, 0.25}));
  EXPECT_GT(agreed_distance({cone}, {ball}, 1e-13), 1.5);
  EXPECT_NEAR(agreed_distance({ball}, {cube}, 1e-13), 0.5475, 0.02);
  EXPECT_GT(agreed_distance({cone}, {cube}, 1e-13), 2);
  const ClosedSurface solid = ClosedSurface::create(ball).value(), outer = ClosedSurface::create(cone).value();
  for (const Vec3& p : cube.mesh().positions()) EXPECT_TRUE(solid.contains(p) && outer.contains(p));
  for (const Vec3& p : ball.mesh().positions()) EXPECT_TRUE(outer.contains(p));
  for (const Vec3& p : cone.mesh().positions()) EXPECT_FALSE(solid.contains(p));
}

// MuJoCo #1857: a capsule under a disk; #1784: a ball over a height field. Both are apart and got negative distances.
TEST(Overlap, OfBodiesThatAreApartIsNeverReported) {
  const Model rod(box({-0.11, -0.01, -0.06}, {-0.09, 0.01, 0.06})), disk(hull([] {
    std::vector<Vec3> rims;
    scenes::Rng rng(1857);
    for (int i = 0; i < 20; ++i) {
      const double angle = 0.314 * i;
      rims.push_back({0.2 * scenes::cosine(angle), 0.2 * scenes::sine(angle), i % 2 == 0 ? 0.095 : 0.105});
    }
    return rims;
  }()));
  EXPECT_NEAR(agreed_distance({rod}, {disk}, 1e-15), 0.035, 1e-15);
  const Model field(scenes::wave_sheet(12, 12, 3)), ball(stretched(scenes::ball(16, 8), {0.2, 0.2, 0.2}));
  for (int i = 0; i < 20; ++i) {
    const Transform pose = at(0.2 * i, 2, 0.305 - 1e-4 * i);
    const double apart = agreed_distance({field}, {ball, pose}, 1e-14);
    EXPECT_GT(apart, 0) << i;
    EXPECT_GE(apart, pose.translation.z - 0.2 - 0.1 - 1e-14) << i;  // no wave is higher than 0.1
  }
}

// MuJoCo #3383: exactly 0 for 103 of 3,000 pairs of convex meshes that are apart. #2688: negative distances of such.
// The plane between convex bodies that the witness suggests proves the distance from below, by support functions alone.
TEST(Overlap, OfConvexBodiesIsExcludedByThePlaneBetweenThem) {
  scenes::Rng rng(3383);
  for (int i = 0; i < 3000; ++i) {
    std::vector<Vec3> p(8), q(8);
    for (Vec3& v : p) v = random_point(rng, 1);
    for (Vec3& v : q) v = random_point(rng, i % 3 == 0 ? 1 : 0.05);
    const Model a(hull(p)), b(hull(q));
    // They are parted along a random direction by a gap between 1e-9 and 1.
    const Vec3 direction = scenes::random_rotation(rng).row0;
    const double gap = std::pow(10.0, rng.uniform(-9, 0));
    double highest = -HUGE_VAL, lowest = HUGE_VAL;
    for (const Vec3& v : p) highest = std::max(highest, dot(v, direction));
    for (const Vec3& v : q) lowest = std::min(lowest, dot(v, direction));
    const Vec3 sideways = cross(direction, random_point(rng, 1));
    const Transform pose{{}, (highest - lowest + gap) * direction + sideways};
    const DistanceResult found = distance({a}, {b, pose});
    ASSERT_GE(found.upper, gap - 1e-14) << i;
    const Vec3 u = (1 / found.upper) * (found.witness->point_b - found.witness->point_a);
    double top = -HUGE_VAL, bottom = HUGE_VAL;
    for (const Vec3& v : p) top = std::max(top, dot(v, u));
    for (const Vec3& v : q) bottom = std::min(bottom, dot(pose(v), u));
    // A normal that is off by rounding over the distance tilts the plane. A witness that is not the closest pair does
    // that by far more.
    ASSERT_NEAR(bottom - top, found.upper, 1e-14 + 1e-15 / found.upper) << i;
  }
}

/// The hull of six vertices of the report, and where its two bodies stand.
const std::vector<Vec3> warp_vertices{
    {-0.0611590669, -0.13801524, -0.158372656}, {0.0620514415, 0.135089189, -0.159879193},
    {-0.105518319, -0.100999095, -0.188289702}, {-0.107238553, -0.102976903, 0.1569262},
    {-0.0851279497, -0.122304708, 0.156887323}, {-0.0590926372, -0.104567274, -0.242715642}};

Transform warp_pose(const Vec3& place) {
  return transform_from_quaternion(place, 0.5425650813, 0.0029009761, 0.0001424328, 0.8400087479).value();
}

// mujoco_warp #1527: overlapping hulls get a small positive distance, and no constraint. #1546: they do after both were
// moved by 1.
TEST(Overlap, OfHullsIsFoundWhereverBothAreMovedTogether) {
  const Model body(hull(warp_vertices));
  const auto contacts_at = [&](const Vec3& place) {
    const Placed a{body, warp_pose(place + Vec3{-0.141666584, 0, 0})};
    const Placed b{body, warp_pose(place + Vec3{0.141666584, 0, 0})};
    EXPECT_EQ(exact_squared_distance(a, b) == 0, agreed_distance(a, b, 1e-8) == 0);
    return intersections(a, b, {}).count;
  };
  const std::size_t count = contacts_at({});
  for (const double far : {1.0, 64.0, 1e4, 1e6}) EXPECT_EQ(contacts_at({0, far, -far}), count) << far;
  EXPECT_GT(count, 0U);
}

// mujoco_warp #1649 and MuJoCo PR #2689: a margin falsifies the distance that is reported.
TEST(Overlap, AndDistanceDoNotDependOnTheMarginThatWasAskedFor) {
  const Model cube(box({0.5, 0.5, 0.5})), probe(box({0.05, 0.05, 0.05}));
  for (const double gap : {0.001, 0.01, 0.1}) {
    const Placed a{cube}, b{probe, at(0.1, 0.2, 0.55 + gap)};
    for (const double margin : {0.1, 0.2, 0.5, 3.0}) {
      const std::vector<Contact> found = all_contacts(a, b, margin);
      const auto closest = std::min_element(found.begin(), found.end(),
                                            [](const Contact& c, const Contact& d) { return c.distance < d.distance; });
      ASSERT_NE(closest, found.end());
      EXPECT_NEAR(closest->distance, gap, 1e-15) << margin;
      EXPECT_EQ(closest->depth, 0);
      EXPECT_NEAR(distance(a, b, {.max_distance = margin}).upper, gap, 1e-15);
    }
  }
}

// PhysX #568: a box and the mesh of that box give different penetrations. PhysX #564 and IfcOpenShell #4594: no overlap
// of bodies whose side faces lie in the same planes; a shift of 2 mm brings it back.
TEST(Overlap, OfABoxDoesNotDependOnItsTrianglesOrOnAlignedFaces) {
  const Model coarse(box({0.1, 0.1, 0.1}));
  std::vector<Triangle> finer;
  for (TriangleId id = 0; id < 12; ++id) {
    const Triangle t = coarse.mesh().triangle(id);
    const Vec3 m = 0.5 * (t.v1 + t.v2);
    finer.push_back({t.v0, t.v1, m}), finer.push_back({t.v0, m, t.v2});
  }
  const Model fine(triangles_of(finer));
  for (const double shift : {0.0, 0.002}) {
    for (const double x : {0.1, 0.15, 0.199, 0.2, 0.201, 0.25}) {
      const Placed there{coarse, at(x, shift, 0)};
      const double found = agreed_distance({coarse}, there, 1e-15);
      EXPECT_EQ(agreed_distance({fine}, there, 1e-15), found);
      EXPECT_EQ(found == 0, x <= 0.2) << x;
    }
  }
}

}  // namespace
}  // namespace limber::testing
