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
