// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/haptic_models.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "scenes/scenes.h"

namespace limber::program {
namespace {

constexpr double side_mm = 120, thickness_mm = 20;
constexpr double wave_mm = 2, wave_length_mm = 40;
constexpr double relaxation_s = 0.05;       // after which a dent has a third of its depth
constexpr double shallowest_dent = 0.02;    // mm; what is left of a dent then comes back at once
constexpr double least_move = 0.005;        // mm; less is handed over later, with what is added to it by then
constexpr double part_that_gives = 2. / 3;  // of the depth to which a tool is commanded
constexpr double dent_radius_mm = 12;       // of curvature, at the lowest point

/// The most squares along a side for which 4 n^2 + 8 n triangles are not too many.
std::uint32_t squares_along_side(std::uint64_t at_most) {
  return static_cast<std::uint32_t>(std::sqrt(static_cast<double>(at_most) / 4 + 1)) - 1;
}

constexpr double turn = 2 * std::numbers::pi;

// The path. Its numbers have no common period, so that the tool hardly comes the same way twice.
constexpr double reach_mm = 42;
constexpr double x_period_s = 13, y_period_s = 9.7, tilt_period_s = 17;
constexpr double mean_height_mm = 1, height_amplitude_mm = 4;  // of the tip above the resting tissue
constexpr double tilt = 0.3;                                   // radians off the vertical

}  // namespace

double resting_height(double x, double y) {
  constexpr double k = 2 * std::numbers::pi / wave_length_mm;
  return wave_mm * scenes::sine(k * x) * scenes::cosine(k * y);
}

Tissue::Tissue(std::uint64_t at_most, double tick_s)
    : n_(squares_along_side(at_most)), spacing_(side_mm / n_), kept_a_tick_(std::exp(-tick_s / relaxation_s)) {
  const std::size_t count = (std::size_t{n_} + 1) * (n_ + 1);
  for (std::size_t v = 0; v < count; ++v) {
    const std::size_t column = v % (n_ + 1), row = v / (n_ + 1);
    const double x = static_cast<double>(column) * spacing_ - side_mm / 2;
    const double y = static_cast<double>(row) * spacing_ - side_mm / 2;
    resting_z_.push_back(resting_height(x, y));
  }
  depth_.resize(count);
  handed_over_.resize(count);
  // Written once, so that no page is missing when the first dent comes.
  for (std::vector<VertexId>* ids : {&dented_, &moved_ids_}) ids->assign(count, 0), ids->clear();
  moved_positions_.assign(count, {}), moved_positions_.clear();
}

Mesh Tissue::mesh() const {
  const Mesh grid = scenes::grid(n_, n_, -side_mm / 2, -side_mm / 2, spacing_, spacing_);
  const auto face = static_cast<VertexId>(grid.positions().size());  // the lower face's first vertex
  std::vector<Vec3> positions = grid.positions();
  for (VertexId v = 0; v < face; ++v) positions[v].z = resting_z_[v];
  for (VertexId v = 0; v < face; ++v) positions.push_back({positions[v].x, positions[v].y, -thickness_mm});
  std::vector<Corners> triangles = grid.triangles();
  for (const Corners& c : grid.triangles()) triangles.push_back({face + c[0], face + c[2], face + c[1]});
  // Walls, all four run through with the sheet to their left.
  const auto wall = [&](VertexId from, VertexId to) {
    triangles.push_back({face + from, face + to, to});
    triangles.push_back({face + from, to, from});
  };
  const std::uint32_t row = n_ + 1;
  for (std::uint32_t i = 0; i < n_; ++i) {
    wall(i, i + 1);
    wall(i * row + n_, (i + 1) * row + n_);
    wall(n_ * row + i + 1, n_ * row + i);
    wall((i + 1) * row, i * row);
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

template <typename Function>
void Tissue::for_each_above(const Vec3& tip, const Function& f) const {
  if (tip.z >= wave_mm) return;
  const double radius = std::sqrt(2 * dent_radius_mm * (wave_mm - tip.z));
  const auto first_after = [this](double x) {
    return static_cast<std::uint32_t>(
        std::clamp(std::ceil((x + side_mm / 2) / spacing_), 0., static_cast<double>(n_ + 1)));
  };
  const std::uint32_t i_begin = first_after(tip.x - radius), i_end = first_after(tip.x + radius);
  const std::uint32_t j_begin = first_after(tip.y - radius), j_end = first_after(tip.y + radius);
  for (std::uint32_t j = j_begin; j < j_end; ++j) {
    for (std::uint32_t i = i_begin; i < i_end; ++i) {
      const VertexId v = j * (n_ + 1) + i;
      const double dx = i * spacing_ - side_mm / 2 - tip.x, dy = j * spacing_ - side_mm / 2 - tip.y;
      const double depth = resting_z_[v] - tip.z - (dx * dx + dy * dy) / (2 * dent_radius_mm);
      if (depth > 0) f(v, depth);
    }
  }
}

void Tissue::relax() {
  for (const VertexId v : dented_) depth_[v] *= kept_a_tick_;
}

void Tissue::dent(const Vec3& tip) {
  double deepest = 0;
  for_each_above(tip, [&](VertexId, double depth) { deepest = std::max(deepest, depth); });
  const Vec3 held_back = tip + Vec3{0, 0, (1 - part_that_gives) * deepest};
  for_each_above(held_back, [&](VertexId v, double depth) {
    if (depth <= depth_[v]) return;
    if (depth_[v] == 0) dented_.push_back(v);
    depth_[v] = depth;
  });
}

void Tissue::list_moves() {
  moved_ids_.clear();
  moved_positions_.clear();
  for (std::size_t i = dented_.size(); i-- > 0;) {
    const VertexId v = dented_[i];
    if (depth_[v] < shallowest_dent) {
      depth_[v] = 0;
      dented_[i] = dented_.back();
      dented_.pop_back();
    }
    if (depth_[v] > 0 && std::abs(depth_[v] - handed_over_[v]) < least_move) continue;
    handed_over_[v] = depth_[v];
    moved_ids_.push_back(v);
    const VertexId column = v % (n_ + 1), row = v / (n_ + 1);
    moved_positions_.push_back(
        {column * spacing_ - side_mm / 2, row * spacing_ - side_mm / 2, resting_z_[v] - depth_[v]});
  }
}

Tissue::Moves Tissue::press(const Vec3& tip) {
  relax();
  dent(tip);
  list_moves();
  return {moved_ids_, moved_positions_};
}

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
  // Where the tip is.
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
