// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "limber/motion.h"
#include "support/random_motion.h"

namespace limber::testing {
namespace {

/// The distance at a time, rounded.
double distance_at(const MovingCorners& m, bool is_face, double t) {
  Vec3 p[4];
  for (int i = 0; i < 4; ++i) {
    const Vec3 start = m.start[i] - m.start[0], end = m.end[i] - m.start[0];
    p[i] = start + t * (end - start);
  }
  return is_face ? closest_points(p[0], Triangle{p[1], p[2], p[3]}).distance
                 : closest_points(Segment{p[0], p[1]}, Segment{p[2], p[3]}).distance;
}

double extent_of(const MovingCorners& m) {
  double extent = 0;
  for (int i = 0; i < 4; ++i) {
    extent = std::max({extent, max_abs(m.start[i] - m.start[0]), max_abs(m.end[i] - m.start[0])});
  }
  return extent;
}

TEST(Separation, IsReachedBeforeContact) {
  const Triangle floor{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const MovingPoint falling{{0.25, 0.25, 1}, {0.25, 0.25, -1}};
  const ElementImpact found = time_of_impact(falling, MovingTriangle{floor, floor}, {.min_separation = 0.5});
  EXPECT_EQ(found.status, ImpactStatus::contact);
  EXPECT_NEAR(found.lower, 0.25, 1e-13);
  EXPECT_GE(found.upper, found.lower);
  EXPECT_LE(found.upper - found.lower, 0x1p-53);
  const auto status = [&](double separation) {
    return time_of_impact(falling, MovingTriangle{floor, floor}, {.max_time = 0.25, .min_separation = separation})
        .status;
  };
  EXPECT_EQ(status(0.499), ImpactStatus::clear);
  EXPECT_EQ(status(0.501), ImpactStatus::contact);
  EXPECT_EQ(status(1), ImpactStatus::initial_contact);
}

TEST(Separation, HoldsAtAllTimesBeforeAndIsReachedAtTheEnd) {
  Rng rng(41);
  int statuses[3] = {};
  for (int i = 0; i < 20'000; ++i) {
    const bool is_face = rng.below(2) == 0;
    const auto kind = static_cast<MotionKind>(rng.below(static_cast<std::uint64_t>(MotionKind::count)));
    const MovingCorners m = random_motion(rng, kind, is_face);
    const double extent = extent_of(m);
    const double separation = std::max(extent * std::pow(2, rng.uniform(-60, 0)), 0x1p-1074);
    const double time_error = rng.below(2) == 0 ? 0 : std::pow(2, -rng.uniform(1, 50));
    const double tolerance = 0x1p-43 * extent + 0x1p-1070;
    const ElementImpact found = impact_of(m, is_face, {.time_error = time_error, .min_separation = separation});
    ++statuses[static_cast<std::size_t>(found.status)];
    SCOPED_TRACE(i);
    const ElementImpact contact = impact_of(m, is_face, {});
    if (contact.status != ImpactStatus::clear && separation > 4 * tolerance) {  // it comes no later than contact
      ASSERT_NE(found.status, ImpactStatus::clear);
      ASSERT_LE(found.lower, contact.upper);
    }
    if (found.status == ImpactStatus::initial_contact) {
      ASSERT_LE(distance_at(m, is_face, 0), separation + tolerance);
      continue;
    }
    const bool touches = found.status == ImpactStatus::contact;
    for (int k = 0; k < 20; ++k) {
      const double t = std::min(found.lower, 1.0) * (k == 0 ? 1 : rng.uniform(0, 1));
      ASSERT_GE(distance_at(m, is_face, t), separation - tolerance / 4) << t;
    }
    if (!touches) continue;
    ASSERT_LE(distance_at(m, is_face, found.upper), separation + tolerance);
    ASSERT_LE(found.upper - found.lower, std::max(time_error, 0x1p-53));
  }
  for (const int count : statuses) EXPECT_GT(count, 2000);
}

TEST(Separation, OfElementsThatSlideAtThatDistanceIsDecidedAtOnce) {
  // Just within, just beyond, and off by rounding, all the time.
  const Triangle floor{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
  for (const double height : {0.1, std::nextafter(0.1, 1), 0.1 + 1e-12, 0.1 + 1e-9}) {
    const MovingPoint sliding{{-1, 0.3, height}, {1, 0.1, height}};
    const ElementImpact found = time_of_impact(sliding, MovingTriangle{floor, floor}, {.min_separation = 0.1});
    EXPECT_EQ(found.status, height < 0.1 + 1e-12 ? ImpactStatus::initial_contact : ImpactStatus::clear) << height;
  }
}

/// The status if one of two edges is at rest and the other moves.
ImpactStatus status_of(const Segment& still, const Segment& start, const Segment& end, double separation) {
  return time_of_impact(MovingSegment{still, still}, MovingSegment{start, end}, {.min_separation = separation}).status;
}

TEST(Separation, OfTinyEdgesIsNotMissed) {
  // Vectors perpendicular to the short edge have no squared length in float64.
  const Segment point_like{{0, 0, 0}, {0, 0x1p-300, -0x1p-300}};
  const Segment start{{1, 0.0625, 0.0625}, {1, 0.0625, 0.0625}}, end{{0.0625, 0.5, 0.0625}, {0.0625, 0.5, 0.0625}};
  EXPECT_EQ(status_of(point_like, start, end, 0.495), ImpactStatus::contact);
  EXPECT_EQ(status_of(point_like, start, end, 0.48), ImpactStatus::clear);
}

TEST(Separation, HoldsBesideAFaceThatTilts) {
  // The vertex rises as the face below it tilts: their distance is h / sqrt(1 + t^2).
  for (const double h : {0x1p-30, 0x1p-38}) {
    const MovingPoint rising{{0, 0.5, h}, {0, 0.5, 0.5 + h}};
    const MovingTriangle tilting{{{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{-1, 0, 0}, {1, 0, 0}, {0, 1, 1}}};
    EXPECT_EQ(time_of_impact(rising, tilting, {.min_separation = 0.5 * h}).status, ImpactStatus::clear) << h;
    EXPECT_EQ(time_of_impact(rising, tilting, {.min_separation = 0.8 * h}).status, ImpactStatus::contact) << h;
  }
}

TEST(Separation, OfNearlyParallelEdgesAtRestIsTheirDistance) {
  const Vec3 along{0.3, 0.7, 0.9}, across{0.7, -0.3, 0}, up = cross(along, across);
  const Vec3 turned = along + 0x1p-24 * across, lift = 0x1p-34 * up;
  const Segment low{-along, along}, high{lift - turned, lift + turned};
  EXPECT_EQ(status_of(low, high, high, 0x1p-60), ImpactStatus::clear);
  EXPECT_EQ(status_of(low, high, high, 0x1p-33), ImpactStatus::initial_contact);
}

TEST(Separation, OutOfRangeIsRefused) {
  const Segment s{{0, 0, 0}, {1, 0, 0}}, t{{0, 1, 0}, {1, 1, 0}};
  for (const double bad : {-1.0, std::nan(""), 2 * max_coordinate}) {
    EXPECT_THROW(static_cast<void>(time_of_impact(MovingSegment{s, s}, MovingSegment{t, t}, {.min_separation = bad})),
                 std::invalid_argument);
  }
}

}  // namespace
}  // namespace limber::testing
