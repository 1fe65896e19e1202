// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries of shapes and solids next to brute force over the triangles of their cores.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/gradients.h"
#include "limber/points.h"
#include "limber/shapes.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_bodies.h"

namespace limber::testing {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

double from_core(const Placed& body, TriangleId id, const Vec3& point) {
  return closest_points(point, mapped(body.model().mesh().triangle(id), body.pose)).distance;
}

bool is_in(const Placed& body, const Vec3& point) {
  return body.body().is_solid() && reference::contains(core_of(body), point);
}

void check_witness(const Witness& w, const Placed& a, const Placed& b, double distance, const BodiesTruth& truth) {
  const double tolerance = 4 * truth.tolerance;
  const double off_a = from_core(a, w.triangle_a, w.point_a), off_b = from_core(b, w.triangle_b, w.point_b);
  if (distance == 0) {
    EXPECT_EQ(w.point_a, w.point_b);
    EXPECT_TRUE(off_a <= a.body().radius() + tolerance || is_in(a, w.point_a));
    EXPECT_TRUE(off_b <= b.body().radius() + tolerance || is_in(b, w.point_b));
  } else {
    EXPECT_NEAR(off_a, a.body().radius(), tolerance);
    EXPECT_NEAR(off_b, b.body().radius(), tolerance);
    EXPECT_NEAR(length(w.point_b - w.point_a), distance, tolerance);
  }
}

void check_distance(const DistanceResult& r, const DistanceOptions& asked, const Placed& a, const Placed& b,
                    const BodiesTruth& truth) {
  const double distance = truth.distance();
  EXPECT_LE(r.lower, distance + truth.tolerance);
  EXPECT_GE(r.upper, distance - truth.tolerance);
  EXPECT_LE(r.lower, r.upper);
  ASSERT_EQ(r.witness.has_value(), r.status != DistanceStatus::beyond_limit);
  EXPECT_EQ(r.status == DistanceStatus::interrupted, r.stopped_by != StoppedBy::nothing);
  if (r.status == DistanceStatus::beyond_limit) {
    EXPECT_GE(distance, asked.max_distance - truth.tolerance);
    EXPECT_FALSE(distance == 0);
    EXPECT_EQ(r.lower, asked.max_distance);
    return;
  }
  check_witness(*r.witness, a, b, r.upper, truth);
  if (r.status == DistanceStatus::interrupted) return;
  EXPECT_EQ(r.upper == 0, truth.is_contained || truth.cores <= truth.radius);
  EXPECT_EQ(r.status == DistanceStatus::collision, r.upper == 0);
  const double allowed = std::max(distance * asked.relative_error, asked.absolute_error);
  EXPECT_LE(r.upper, distance + allowed + truth.tolerance);
  if (allowed == 0) {
    EXPECT_EQ(r.lower, r.upper);
  }
}

void check_yes_or_no(const CollideResult& r, bool expected, double max_distance, const Placed& a, const Placed& b,
                     const BodiesTruth& truth) {
  ASSERT_EQ(r.answer, expected ? Answer::yes : Answer::no);
  ASSERT_EQ(r.witness.has_value(), expected);
  if (!expected) return;
  const double apart = length(r.witness->point_b - r.witness->point_a);
  EXPECT_LE(apart, max_distance + truth.tolerance);
  check_witness(*r.witness, a, b, apart, truth);
}

void check_queries(const Placed& a, const Placed& b, QueryCache* cache) {
  const BodiesTruth truth = truth_of(a, b);
  const double d = truth.distance();
  const bool meets = truth.is_contained || truth.cores <= truth.radius;
  check_yes_or_no(collide(a, b), meets, 0, a, b, truth);
  check_yes_or_no(collide(a, b, {.cache = cache}), meets, 0, a, b, truth);
  const double limits[] = {endless, d, std::nextafter(d, 0), 0.5 * d, 1.5 * d, 0};
  for (const double limit : limits) {
    const double errors[][2] = {{0, 0}, {0.1, 0}, {0, 0.1}, {1e-3, 1e-3}, {100, 100}};
    for (const auto& error : errors) {
      const DistanceOptions options{error[0], error[1], limit, nullptr, {}};
      DistanceOptions with_cache = options;
      with_cache.cache = cache;
      check_distance(distance(a, b, options), options, a, b, truth);
      check_distance(distance(a, b, with_cache), options, a, b, truth);
    }
    if (limit == endless) continue;
    const bool expected = truth.is_contained || std::max(0.0, truth.cores - truth.radius) <= limit;
    check_yes_or_no(within(a, b, limit), expected, limit, a, b, truth);
    check_yes_or_no(within(a, b, limit, {.cache = cache}), expected, limit, a, b, truth);
  }
  const DistanceResult found = distance(a, b);
  EXPECT_TRUE(within(a, b, found.upper).is_yes());
  EXPECT_EQ(found.upper == 0, collide(a, b).is_yes());
}

void check_budgets(const Placed& a, const Placed& b) {
  const BodiesTruth truth = truth_of(a, b);
  const bool meets = truth.distance() == 0;
  for (const std::uint64_t steps : {0, 1, 2, 3, 5, 10, 100}) {
    const QueryBudget budget{.max_steps = steps};
    const CollideResult yes_or_no = collide(a, b, {.budget = budget});
    if (yes_or_no.answer != Answer::undecided) {
      EXPECT_EQ(yes_or_no.is_yes(), meets);
    }
    EXPECT_EQ(yes_or_no.answer == Answer::undecided, yes_or_no.stopped_by == StoppedBy::max_steps);
    for (const double limit : {endless, 0.01}) {
      const DistanceOptions options{.max_distance = limit, .budget = budget};
      check_distance(distance(a, b, options), options, a, b, truth);
    }
  }
  QueryCache cache;
  for (int i = 0;; ++i) {
    ASSERT_LT(i, 1000);
    const DistanceOptions options{.cache = &cache, .budget = {.max_steps = 200}};
    const DistanceResult found = distance(a, b, options);
    check_distance(found, options, a, b, truth);
    if (found.status != DistanceStatus::interrupted) break;
  }
}

/// What is said of the contact of two swept triangles.
Contact swept(Contact contact, const BodiesTruth& truth) {
  contact.depth = contact.distance <= truth.radius ? contact.depth + (truth.radius - contact.distance) : 0;
  contact.distance = std::max(0.0, contact.distance - truth.radius);
  return contact;
}

void check_contacts(const Placed& a, const Placed& b, double margin) {
  const BodiesTruth truth = truth_of(a, b);
  std::vector<Contact> expected;
  for (const Contact& c : reference::contacts(core_of(a), core_of(b), truth.radius + margin + truth.tolerance)) {
    if (swept(c, truth).distance <= margin) expected.push_back(swept(c, truth));
  }
  const auto by_ids = [](const Contact& s, const Contact& t) {
    return s.triangle_a != t.triangle_a ? s.triangle_a < t.triangle_a : s.triangle_b < t.triangle_b;
  };
  std::vector<Contact> found(expected.size() + 1);
  for (const bool parallel : {false, true}) {
    const PairCount count = contacts(a, b, margin, found, {.parallel = parallel});
    ASSERT_EQ(count.count, expected.size());
    std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count.count), by_ids);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const Contact &f = found[i], &e = expected[i];
      ASSERT_EQ(f.triangle_a, e.triangle_a);
      ASSERT_EQ(f.triangle_b, e.triangle_b);
      EXPECT_EQ(f.distance, e.distance);
      EXPECT_EQ(f.depth, e.depth);
      EXPECT_EQ(f.normal, e.normal);
      check_witness({f.point_a, f.point_b, f.triangle_a, f.triangle_b}, a, b, f.distance, truth);
    }
  }
  std::vector<TrianglePair> pairs(expected.size());
  const auto meeting =
      std::count_if(expected.begin(), expected.end(), [](const Contact& c) { return c.distance == 0; });
  EXPECT_EQ(intersections(a, b, pairs).count, static_cast<std::size_t>(meeting));
  const std::size_t room = std::min<std::size_t>(5, expected.size());
  std::vector<Contact> closest(room);
  ASSERT_EQ(closest_pairs(a, b, closest, {.max_distance = margin}).count, room);
  std::sort(expected.begin(), expected.end(),
            [](const Contact& s, const Contact& t) { return s.distance < t.distance; });
  for (std::size_t i = 0; i < room; ++i) EXPECT_NEAR(closest[i].distance, expected[i].distance, truth.tolerance);
}

/// A contact that contact_of() makes of a witness says what the distance says.
void check_contact_of(const Placed& a, const Placed& b) {
  const BodiesTruth truth = truth_of(a, b);
  const DistanceResult near = distance(a, b);
  if (truth.is_contained) return;
  const TriangleContact contact = contact_of(a, b, *near.witness);
  EXPECT_EQ(contact.distance, near.upper);
  EXPECT_NEAR(length(contact.point_a - near.witness->point_a), 0, truth.tolerance);
  EXPECT_NEAR(length(contact.point_b - near.witness->point_b), 0, truth.tolerance);
}

class BodyKinds : public ::testing::TestWithParam<bool> {};

TEST_P(BodyKinds, AgreeWithBruteForceInAllQueries) {
  Rng rng(20261);
  QueryCache cache;
  for (std::uint64_t i = 0; i < body_kinds; ++i) {
    for (std::uint64_t j = 0; j < body_kinds; ++j) {
      for (int round = 0; round < 4; ++round) {
        SCOPED_TRACE(::testing::Message() << i << " and " << j << ", round " << round);
        const OwnedBody a = random_body(rng, i, GetParam()), b = random_body(rng, j, GetParam());
        const Transform pose_a = some_pose(rng, GetParam(), 1), pose_b = some_pose(rng, GetParam(), 1.5);
        const Placed placed_a(a.body(), pose_a), placed_b(b.body(), pose_b);
        check_queries(placed_a, placed_b, &cache);
        check_contacts(placed_a, placed_b, 0.25);
        check_contacts(placed_a, placed_b, 0);
        check_contact_of(placed_a, placed_b);
        if (round == 0) check_budgets(placed_a, placed_b);
        if (HasFailure()) return;
      }
    }
  }
}

/// What all queries of a point with a radius, next to a mesh, have to say.
void check_sphere(const Placed& mesh, const Placed& sphere, double least, bool is_first) {
  const Placed &a = is_first ? sphere : mesh, &b = is_first ? mesh : sphere;
  const double truth = std::max(0.0, least - sphere.body().radius());
  EXPECT_EQ(distance(a, b).upper, truth);
  EXPECT_EQ(distance(a, b).lower, truth);
  QueryCache cache;
  EXPECT_EQ(distance(a, b, {.cache = &cache}).upper, truth);
  EXPECT_EQ(distance(a, b, {.cache = &cache}).upper, truth);
  const DistanceResult about = distance(a, b, {.relative_error = 0.5});
  EXPECT_TRUE(about.lower <= truth && truth <= about.upper && about.upper <= 1.5 * truth);
  EXPECT_EQ(distance(a, b, {.max_distance = truth}).upper, truth);
  EXPECT_TRUE(within(a, b, truth).is_yes());
  EXPECT_EQ(collide(a, b).is_yes(), truth == 0);
  if (truth < 1e-100) return;
  EXPECT_TRUE(within(a, b, std::nextafter(truth, 0)).is_no());
  EXPECT_EQ(distance(a, b, {.max_distance = std::nextafter(truth, 0)}).status, DistanceStatus::beyond_limit);
}

// Points have a search of their own, which must not miss what a comparison of all pairs finds.
TEST(Shapes, SpheresAreAsFarAsTheClosestOfAllTrianglesToTheBit) {
  Rng rng(20263);
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    const bool is_on_lattice = i % 2 == 0;
    const double scale = i % 7 == 3 ? 0x1p-120 : i % 7 == 5 ? 0x1p60 : 1, away = i % 11 == 4 ? 1e5 : 3;
    std::vector<Triangle> triangles;
    for (std::uint64_t n = 1 + rng.below(i % 3 == 0 ? 12 : 300); n > 0; --n) {
      const auto corner = [&] { return scale * some_point(rng, is_on_lattice); };
      triangles.push_back({corner(), corner(), corner()});
    }
    const Model model(soup(triangles));
    Transform pose = some_pose(rng, is_on_lattice, 1), at = some_pose(rng, is_on_lattice, away);
    pose.translation *= scale, at.translation *= scale;
    const Shape sphere = Shape::sphere(i % 5 == 0 ? 0 : scale * some_size(rng, is_on_lattice));
    const Vec3 p = at(Vec3{});
    double least = endless;
    for (const Triangle& t : triangles) {
      const Triangle placed = mapped(t, pose);
      least = std::min(least, closest_points(i % 4 < 2 ? Triangle{p, p, p} : placed,  //
                                             i % 4 < 2 ? placed : Triangle{p, p, p})
                                  .distance);
    }
    check_sphere({model, pose}, {sphere, at}, least, i % 4 < 2);
    if (HasFailure()) return;
  }
}

TEST(Shapes, SpheresCostWhatPointsCost) {
  const Model ring(scenes::ring(300, 120, 0.25));
  const Shape sphere = Shape::sphere(0.05);
  Rng rng(20264);
  for (int i = 0; i < 50; ++i) {
    const Transform at = random_pose(rng, 3);
    const QueryStats of_point = closest_point(ring, at.translation).stats,
                     of_sphere = distance({ring}, {sphere, at}).stats;
    EXPECT_LE(of_sphere.node_tests, of_point.node_tests + 1);
    EXPECT_LE(of_sphere.primitive_tests, 2 * of_point.primitive_tests);
    EXPECT_EQ(distance({sphere, at}, {sphere}).stats.primitive_tests, 1U);
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, BodyKinds, ::testing::Bool(),
                         [](const auto& asked) { return asked.param ? "OnLattices" : "Anywhere"; });

}  // namespace
}  // namespace limber::testing
