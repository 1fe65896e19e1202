// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/haptic_tool.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "haptics/haptic_tissue.h"
#include "scenes/scenes.h"

namespace limber::program {
namespace {

constexpr double turn = 2 * std::numbers::pi;

// The path. Its numbers have no common period, so that the tool hardly comes the same way twice.
constexpr double reach_mm = 42;
constexpr double x_period_s = 13, y_period_s = 9.7, tilt_period_s = 17;
constexpr double mean_height_mm = 1, height_amplitude_mm = 4;  // of the tip above the resting tissue
constexpr double tilt = 0.3;                                   // radians off the vertical

}  // namespace

Vec3 tip_at(const Transform& pose) {
  // The point of the ellipsoid that is farthest along a direction d is S S d / |S d|, with the semi-axes as S.
  const Vec3 down = transpose(pose.rotation) * Vec3{0, 0, -1};
  const Vec3& s = tool_semi_axes;
  const Vec3 scaled{s.x * down.x, s.y * down.y, s.z * down.z};
  return pose(Vec3{s.x * scaled.x, s.y * scaled.y, s.z * scaled.z} * (1 / length(scaled)));
}

Mesh tool_mesh(std::uint64_t at_most) {
  // 2 slices (stacks - 1) triangles, with twice as many slices as there are rows of squares and half rows.
  const auto rows = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(at_most) / 4));
  const Mesh ball = scenes::ball(2 * rows, rows + 1);
  std::vector<Vec3> positions = ball.positions();
  for (Vec3& p : positions) p = {tool_semi_axes.x * p.x, tool_semi_axes.y * p.y, tool_semi_axes.z * p.z};
  return Mesh::create(std::move(positions), ball.triangles()).value();
}

Transform device_pose(double seconds) {
  const auto at = [seconds](double period) { return turn * seconds / period; };
  // Of the tip.
  const double x = reach_mm * scenes::sine(at(x_period_s)), y = reach_mm * scenes::sine(at(y_period_s) + 0.7);
  const double height = mean_height_mm + height_amplitude_mm * scenes::cosine(at(press_period_s));
  const double s = scenes::sine(tilt / 2), axis = at(tilt_period_s);
  const Transform turned =
      transform_from_quaternion({}, scenes::cosine(tilt / 2), s * scenes::cosine(axis), s * scenes::sine(axis), 0)
          .value();
  const Vec3 tip = tip_at(turned);
  return {turned.rotation, Vec3{x, y, resting_height(x, y) + height} - tip};
}

}  // namespace limber::program
