// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Contacts that were wrong, repeated, missing or silently cut off.
#include <cmath>
#include <set>
#include <utility>

#include "limber/contacts.h"
#include "limber/elements.h"
#include "limber/scene.h"
#include "peers.h"

namespace limber::testing {
namespace {

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

// Coal #755: with a security margin of 1, boxes whose gap is smaller do not collide. Coal #625: the manager of the
// broad phase forgets the margin.
TEST(ContactLists, WithAMarginHoldAllPairsUpToIt) {
  const Model cube(box({0.5, 0.5, 0.5}));
  for (const double gap : {0.25, 0.7, 0.9999, 1.0, 1.0001, 1.5}) {
    const Placed a{cube}, b{cube, at(0, 0, 1 + gap)};
    const double exact_gap = b.pose.translation.z - 1;
    EXPECT_EQ(within(a, b, 1).is_yes(), exact_gap <= 1) << gap;
    EXPECT_EQ(contacts(a, b, 1, {}).count > 0, exact_gap <= 1) << gap;
    EXPECT_EQ(distance(a, b, {.max_distance = 1}).status == DistanceStatus::exact, exact_gap <= 1) << gap;
    expect_pairs_of_brute_force(a, b, 1);
    limber::Scene scene;
    for (const Placed& object : {a, b}) static_cast<void>(scene.add(object));
    scene.commit();
    if (exact_gap <= 1) {
      EXPECT_EQ(scene.candidate_pairs(1, {}).count, 1U) << gap;
    }
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

// Jolt #1016: a vertex of a soft body collides with one body at most.
TEST(ContactLists, HaveOneVertexWithAsManyFacesAsAreNear) {
  std::vector<Triangle> walls;
  for (int i = 0; i < 40; ++i) {  // the tangential planes of a small ball around the vertex
    scenes::Rng rng(static_cast<std::uint64_t>(i));
    const Mat3 r = scenes::random_rotation(rng);
    const Vec3 m = 0.01 * r.row0;
    walls.push_back({m + r.row1, m - 0.5 * r.row1 + r.row2, m - 0.5 * r.row1 - r.row2});
  }
  const Model around(triangles_of(walls)), body(triangles_of({{{0, 0, 0}, {0, 0, 50}, {0, 1, 50}}}));
  std::set<TriangleId> faces;
  visit_element_pairs(
      {around}, {body}, 0.011,
      [&](const VertexFacePair& p) {
        if (!p.is_vertex_of_b || p.vertex != 0) return true;
        EXPECT_NEAR(p.distance, 0.01, 1e-15);
        faces.insert(p.triangle);
        return true;
      },
      [](const EdgeEdgePair&) { return true; });
  EXPECT_EQ(faces.size(), walls.size());
}

}  // namespace
}  // namespace limber::testing
