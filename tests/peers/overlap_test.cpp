// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bodies that overlap, touch or contain each other, and their contacts: wrong, repeated, missing or cut off.
#include <cmath>
#include <set>
#include <utility>

#include "limber/points.h"
#include "peers.h"

namespace limber::testing {
namespace {

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
}

// FCL #503: two cubes that share a face get depths of the size of the cubes.
TEST(Overlap, OfCubesThatShareAFaceIsNoDeeperThanRounding) {
  const Model a(box({-2, -1, 0}, {0, 1, 2})), b(box({0, -1, 0}, {2, 1, 2}));
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

std::vector<std::pair<TriangleId, TriangleId>> sorted_pairs(const std::vector<Contact>& found) {
  std::vector<std::pair<TriangleId, TriangleId>> pairs;
  for (const Contact& c : found) pairs.emplace_back(c.triangle_a, c.triangle_b);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

void expect_pairs_of_brute_force(const Placed& a, const Placed& b, double margin) {
  const std::vector<Contact> found = all_contacts(a, b, margin);
  const std::vector<Contact> truth = reference::contacts(in_reference(a), in_reference(b), margin);
  EXPECT_EQ(sorted_pairs(found), sorted_pairs(truth));
}

// FCL #106, DART #860 and PR #2258: two boxes in face contact get 30 contacts where 4 are expected, some of them twice,
// some at corners that do not touch anything.
TEST(ContactLists, OfBoxesInFaceContactLieInTheCommonRectangleOnceEach) {
  const Model red(box({1, 1, 0.5})), green(box({0.25, 0.25, 0.25}));
  const Placed a{red}, b{green, at(0.3, -0.2, 0.75)};
  ASSERT_EQ(agreed_distance(a, b, 0), 0);
  std::vector<Contact> found = all_contacts(a, b, 0);
  expect_pairs_of_brute_force(a, b, 0);
  const auto pairs = sorted_pairs(found);
  EXPECT_EQ(std::set(pairs.begin(), pairs.end()).size(), pairs.size());
  for (const Contact& c : found) {
    EXPECT_NEAR(c.point_a.z, 0.5, 1e-15);
    EXPECT_LE(std::abs(c.point_a.x - 0.3), 0.25 + 1e-15);
    EXPECT_LE(std::abs(c.point_a.y + 0.2), 0.25 + 1e-15);
  }
  const std::size_t kept = reduce_contacts(found, 2, {.max_angle = 3.14, .max_points = 4});
  EXPECT_LE(kept, 4U);
  EXPECT_GE(kept, 1U);
}

// Coal #809: a box of 1000 by 0.001 by 0.001 through a cube gets contacts far off both.
TEST(ContactLists, OfANeedleThroughACubeAreWhereItEntersAndLeaves) {
  const Model cube(box({0.5, 0.5, 0.5})), needle(box({500, 0.0005, 0.0005}));
  for (const bool is_turned : {false, true}) {
    const Transform pose =
        is_turned ? transform_from_quaternion({0.01, 0.1, 0.2}, 1, 0, 0.05, 0.1).value() : at(3, 0.1, 0.2);
    const Placed a{cube}, b{needle, pose};
    ASSERT_EQ(agreed_distance(a, b, 1e-12), 0);
    const std::vector<Contact> found = all_contacts(a, b, 0);
    bool left = false, right = false;
    for (const Contact& c : found) {
      EXPECT_NEAR(max_abs(c.point_a), 0.5, 1e-12);
      EXPECT_LE(closest_points(c.point_a, placed_triangle(b, c.triangle_b)).distance, 1e-12);
      left = left || c.point_a.x < -0.4, right = right || c.point_a.x > 0.4;
    }
    EXPECT_TRUE(left && right);
    expect_pairs_of_brute_force(a, b, 0);
  }
}

// FCL #493, #495, #402, #319, #445, Drake #21673: GJK has boxes touch, EPA has them apart, and the query throws.
// trimesh #284: a collision and a distance above 0.
// The boxes go through contact step by step, down to the last bit of a coordinate; exact arithmetic knows the answer.
TEST(ContactLists, AndDistanceAndCollisionAgreeStepByStepThroughAKiss) {
  Mat3 rotation;
  rotation.row0 = {0.94096063217417758029, 0.29296840037289501035, 0.16959541586174811667};
  rotation.row1 = {-0.23569836841299879326, 0.92661523595848427348, -0.29296840037289506586};
  rotation.row2 = {-0.2429801799032638987, 0.23569836841299884878, 0.94096063217417758029};
  const Model cube(box({0.125, 0.125, 0.125}));
  const Placed b{cube, {rotation, {0, 0, 1.25}}};
  std::size_t meeting = 0, apart = 0;
  for (int step = -40; step <= 40; ++step) {
    // The second box stands above the first along its own z axis, closer by some units in the last place.
    Vec3 place{0.073242100093223821977, 0.2316538089896212349, 1.3089245921032497399};
    if (std::abs(step) <= 20) place = Vec3{0, 0, 1.25} + 0.25 * (rotation * Vec3{0, 0, 1});
    double& z = place.z;
    for (int i = 0; i < std::abs(step) % 21; ++i) z = std::nextafter(z, step > 0 ? 9.0 : -9.0);
    const Placed a{cube, {rotation, place}};
    const exact::Fraction truth = exact_squared_distance(a, b);
    const double found = agreed_distance(a, b, 1e-15);
    ASSERT_EQ(found == 0, truth == 0) << step;
    expect_exact(found, truth, 1e-15);
    (truth == 0 ? meeting : apart) += 1;
  }
  EXPECT_GT(meeting, 5U);
  EXPECT_GT(apart, 5U);
}

// Bullet #4318: triangles that lie behind each other within their boxes count as contacts.
TEST(ContactLists, LeaveOutTrianglesThatOnlyLieBehindEachOther) {
  const Model front(triangles_of({{{0, 0, 0}, {1, 0, 1}, {1, 1, 1}}}));
  for (const double shift : {0.1, 1e-3, 1e-9, 0x1p-50}) {
    const Model behind(triangles_of({{{0, 0, shift}, {1, 0, 1 + shift}, {1, 1, 1 + shift}}}));
    EXPECT_NEAR(agreed_distance({front}, {behind}, 0x1p-50), shift * std::sqrt(0.5), 0x1p-50);
  }
}

}  // namespace
}  // namespace limber::testing
