// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The tool is a point, and the tissue everything below a plane: distances are known, and so is where a proxy should be.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "haptics/haptic_proxy.h"
#include "limber/distance.h"
#include "scenes/scenes.h"

namespace limber::program {
namespace {

const Vec3 up{0, 0, 1};

/// What an exact query says of a point at `place` above the plane z == 0.
DistanceResult above_plane(const Vec3& place) {
  const Witness witness{{place.x, place.y, 0}, place};
  if (place.z <= 0) return {0, 0, DistanceStatus::collision, Witness{place, place}};
  return {place.z, place.z, DistanceStatus::exact, witness};
}

DistanceResult interrupted(double lower, const Vec3& tissue, const Vec3& tool) {
  return {lower, length(tool - tissue), DistanceStatus::interrupted, Witness{tissue, tool}};
}

constexpr double retreat_mm = 0.075;

DistanceResult far_away(double lower) {
  return {lower, std::numeric_limits<double>::infinity(), DistanceStatus::beyond_limit, std::nullopt};
}

/// Where the proxy comes to rest.
Vec3 settled(Proxy& proxy, const Vec3& device) {
  for (int tick = 0; tick < 1000; ++tick) proxy.follow(device, above_plane(proxy.place()));
  return proxy.place();
}

TEST(Proxy, IsWhereTheDeviceIsInFreeMotion) {
  Proxy proxy({0, 0, 9}, retreat_mm);
  EXPECT_EQ(proxy.follow({0.3, 0, 9}, far_away(1)), Vec3{});
  EXPECT_EQ(proxy.place(), (Vec3{0.3, 0, 9}));
  EXPECT_EQ(length(proxy.follow({0, 0, 8.7}, above_plane(proxy.place()))), 0);
}

TEST(Proxy, StopsInFrontOfTheTissueAndPullsTheDeviceBack) {
  Proxy proxy({0, 0, 5}, retreat_mm);
  const Vec3 device{5, -3, -2};
  const Vec3 place = settled(proxy, device);
  EXPECT_LE(length(place - Vec3{5, -3, standoff_mm}), 1e-9);
  const Vec3 force = proxy.follow(device, above_plane(proxy.place()));
  EXPECT_NEAR(force.z, stiffness_n_per_mm * (2 + standoff_mm), 1e-9);
  EXPECT_NEAR(force.x, 0, 1e-12);
}

TEST(Proxy, TakesNoStepThatIsNotCertifiedExceptBack) {
  scenes::Rng rng(5);
  const auto anywhere = [&rng](double size) {
    return Vec3{rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
  };
  int shorter_than_wanted = 0, back = 0;
  for (int i = 0; i < 10'000; ++i) {
    Proxy proxy(anywhere(1), retreat_mm);
    const Vec3 before = proxy.place(), device = before + anywhere(2);
    const double lower = rng.uniform(0.001, 1);
    const Vec3 apart = anywhere(1) * 2;
    if (length(apart) < lower) continue;
    const bool is_interrupted = i % 2 == 0;
    DistanceResult found = interrupted(lower, before - apart, before);
    if (!is_interrupted) found.status = DistanceStatus::within_error;
    proxy.follow(device, found);
    const Vec3 step = proxy.place() - before, away = apart * (1 / length(apart));
    if (length(step) > lower / 2 + 1e-12) {
      ++back;
      EXPECT_LE(length(step - dot(step, away) * away), 1e-12);
      EXPECT_GT(dot(step, away), 0);
      EXPECT_LE(length(step), retreat_mm + 1e-12);
    }
    if (length(step) < 0.99 * length(device - before)) ++shorter_than_wanted;
  }
  EXPECT_GT(shorter_than_wanted, 1000);
  EXPECT_GT(back, 10);
}

TEST(Proxy, GoesBackTheKnownWayWhereNothingIsCertified) {
  Proxy proxy({0, 0, 1}, retreat_mm);
  settled(proxy, {0, 0, -1});
  const Vec3 rest = proxy.place(), device{0, 0, -1};
  // What an interrupted query has found is no closest point, so it does not tell the way.
  proxy.follow(device, interrupted(1e-6, rest - Vec3{0.7, 0, 0}, rest));
  Vec3 before = proxy.place();
  proxy.follow(device, interrupted(0, before + Vec3{0, 0.5, 0}, before));
  EXPECT_NEAR(length(proxy.place() - before - retreat_mm * up), 0, 1e-12);
  before = proxy.place();
  const Vec3 force = proxy.follow(device, {0, 0, DistanceStatus::collision, Witness{before, before}});
  EXPECT_NEAR(length(proxy.place() - before - retreat_mm * up), 0, 1e-12);
  EXPECT_NEAR(length(force - stiffness_n_per_mm * (proxy.place() - device)), 0, 1e-12);
}

TEST(Proxy, IsNotCaughtByTissueThatComesUp) {
  Proxy proxy({0, 0, 1}, retreat_mm);
  settled(proxy, {0, 0, -1});
  double height = 0;  // of the tissue
  for (int tick = 0; tick < 500; ++tick) {
    height += 0.02;
    const Vec3 over{0, 0, height};
    DistanceResult found = above_plane(proxy.place() - over);
    ASSERT_NE(found.status, DistanceStatus::collision) << tick;
    found.witness->point_a += over;
    found.witness->point_b += over;
    proxy.follow({50, 0, -1}, found);  // a device that has run far ahead
  }
}

}  // namespace
}  // namespace limber::program
