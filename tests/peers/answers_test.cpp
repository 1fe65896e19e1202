// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Answers that other libraries got wrong, by the geometry of their reports. The table of all cases is docs/peers.md.
#include <bit>

#include "bodies.h"
#include "limber/points.h"
#include "support/exact_distance.h"
#include "support/rational_winding.h"

namespace limber::testing {
namespace {

void expect_near(const Vec3& found, const Vec3& truth, double tolerance) {
  EXPECT_LE(length(found - truth), tolerance) << found.x << ' ' << found.y << ' ' << found.z;
}

// FCL #127, #227: a ball of radius 1 and a box. FCL #275: balls of radius 20 and 10. python-fcl #54, #48: a ball of
// radius 1e-4 on a face of a tetrahedron. Distances or points are wrong. Coal #823, ifc-lite PR #2815: so they are
// where bodies meet.
TEST(WitnessPoints, OfTwoBodiesAreWhereTheyAreClosest) {
  const Model ball(scenes::ball(32, 16)), brick(box({5, 1, 5})), big(scaled(ball.mesh(), 20));
  const Model small(scaled(ball.mesh(), 10)), tiny(scaled(ball.mesh(), 1e-4));
  const Model tetrahedron(
      Mesh::create({{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}}, {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}}).value());
  struct Known {
    Placed a, b;
    Vec3 point_a, point_b;
    double tolerance;
  };
  for (const Known& k : {Known{{ball}, {brick, at(0, 5, 3)}, {0, 1, 0}, {0, 4, 0}, 1e-14},
                         Known{{big}, {small, at(0, 40, 0)}, {0, 20, 0}, {0, 30, 0}, 1e-13},
                         Known{{tetrahedron}, {tiny, at(1.5, 1.25, 1)}, {1.5, 1.25, 1}, {1.5, 1.25, 1}, 1e-4}}) {
    const Witness forth = distance(k.a, k.b).witness.value(), back = distance(k.b, k.a).witness.value();
    for (const auto& [point_a, point_b] : {std::pair(forth.point_a, forth.point_b), {back.point_b, back.point_a}}) {
      expect_near(point_a, k.point_a, k.tolerance);
      expect_near(point_b, k.point_b, k.tolerance);
    }
    EXPECT_EQ(collide(k.a, k.b).is_yes(), k.point_a == k.point_b);
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
    const DistanceResult found = distance(a, b, {.cache = &cache}), again = distance(a, b, {.cache = &cache});
    const Vec3 lowest = pose({tilt < 0 ? -1.0 : 1.0, tilt < 0 ? 1.0 : -1.0, -0.25});
    ASSERT_NEAR(found.upper, lowest.z, 0x1p-44);
    expect_near(found.witness->point_b, lowest, 1e-12);
    EXPECT_EQ(again.witness->point_b, found.witness->point_b);
    EXPECT_EQ(distance(a, b).witness->point_b, distance(a, b).witness->point_b);
    EXPECT_EQ(distance(a, b).upper, found.upper);
    EXPECT_LE(std::abs(found.upper - previous), i > 0 ? 2e-10 : 1);
    previous = found.upper;
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
    for (int i = 0; i < std::abs(step) % 21; ++i) place.z = std::nextafter(place.z, step > 0 ? 9.0 : -9.0);
    const Placed a{cube, {rotation, place}};
    const exact::Fraction truth = exact_squared_distance(a, b);
    const double found = distance(a, b).upper;
    ASSERT_EQ(found == 0, truth == 0) << step;
    ASSERT_EQ(collide(a, b).is_yes(), truth == 0) << step;
    ASSERT_EQ(contacts(a, b, 0, {}).count > 0, truth == 0) << step;
    EXPECT_TRUE(exact::is_at_most(found, truth, 1e-15) && exact::is_at_least(found, truth, 1e-15)) << step;
    (truth == 0 ? meeting : apart) += 1;
  }
  EXPECT_GT(meeting, 5U);
  EXPECT_GT(apart, 5U);
}

// FCL #503: two cubes that share a face, each triangulated in its own way, get depths of the size of the cubes.
TEST(ContactLists, OfCubesThatShareAFaceAreNoDeeperThanRounding) {
  const Model left(box({-2, -1, 0}, {0, 1, 2})), right(box({0, -1, 0}, {2, 1, 2}));
  for (const Transform& turn : {Transform{}, Transform{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {0, 1, 1}}}) {
    const Placed a{left}, b{right, turn};
    EXPECT_EQ(distance(a, b).upper, 0);
    std::vector<Contact> found(contacts(a, b, 0, {}).count);
    contacts(a, b, 0, found);
    for (const Contact& c : found) EXPECT_LE(c.depth, 0x1p-45);
    EXPECT_EQ(distance(a, {right, at(0x1p-40) * turn}).upper,
              0x1p-40);  // one step to the right, they are that far apart
  }
}

// FCL and Coal give one contact unless they are asked for more, trimesh at most 100,000 for a pair of meshes.
TEST(ContactLists, AreCompleteForHundredsOfThousandsOfPairs) {
  const std::uint32_t n = 256;
  std::vector<Triangle> along_y, along_x;
  const double low = -0.5, high = n - 0.5;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double k = i;
    along_y.push_back({{k, low, 0}, {k, high, 0}, {k, high, 1}});
    along_y.push_back({{k, low, 0}, {k, high, 1}, {k, low, 1}});
    along_x.push_back({{low, k, 0}, {high, k, 0}, {high, k, 1}});
    along_x.push_back({{low, k, 0}, {high, k, 1}, {low, k, 1}});
  }
  const Model a(soup(along_y)), b(soup(along_x));
  // Any two strips cross in a vertical segment, of which each strip's diagonal leaves a part to either triangle.
  const std::size_t all = 3 * std::size_t{n} * n + n;
  std::vector<TrianglePair> found(all);
  const PairCount count = intersections({a}, {b}, found);
  EXPECT_EQ(count.count, all);
  EXPECT_TRUE(count.is_complete);
  std::sort(found.begin(), found.end(),
            [](const TrianglePair& p, const TrianglePair& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
  EXPECT_EQ(std::unique(found.begin(), found.end()), found.end());
  EXPECT_EQ(intersections({a}, {b}, std::span(found).first(1)).count, all);
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
      const std::vector<Triangle> triangles = placed_triangles({blade});
      for (int i = 0; i < 60; ++i) {
        const Vec3 along{i % 2 == 0 ? 0 : rng.uniform(0, 10), rng.uniform(0, small), 0};
        const Vec3 p = along + std::pow(10.0, rng.uniform(-12, 0)) * uniform_point(rng);
        const SignedDistance found = surface.signed_distance(p);
        ASSERT_EQ(std::abs(found.distance()), reference::closest_point({blade.mesh()}, p).closest->distance);
        if (found.distance() == 0) continue;
        ASSERT_EQ(found.is_inside, rational_winding(triangles, p) != 0) << p.x << ' ' << p.y << ' ' << p.z;
      }
    }
  }
}

// avian #1030: answers differ between processor architectures. The number is that of this scene on all of them:
// FNV-1a of distances of bodies and of points.
TEST(Determinism, DistancesHaveTheBitsThatAreWrittenHere) {
  const Model a(scenes::ring(24, 12, 0.3)), b(scenes::ball(20, 12));
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](double value) { hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3; };
  scenes::Rng rng(1030);
  for (int i = 0; i < 50; ++i) {
    const Transform pose = random_pose(rng, 3);
    add(distance({a}, {b, pose}).upper);
    add(closest_point({b, pose}, uniform_point(rng, -2, 2)).closest->distance);
  }
  EXPECT_EQ(hash, 0x560921f492b44d3cU);
}

}  // namespace
}  // namespace limber::testing
