// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A sheet is thrown at a ball, so fast that it would be through within one step. The line search of a solver: of the
// way to where the solver would like the vertices, each step goes only as far as nothing comes nearer than a
// separation. What stopped it gives way, and the solver tries again.
#include <algorithm>
#include <cstdio>
#include <vector>

#include "limber/limber.h"
#include "shapes.h"

namespace {

using limber::Vec3;

constexpr double separation = 1e-3;  // that is kept between sheet and ball, and in the sheet
constexpr double share = 0.9;        // of the way to a contact that a step takes

/// A body and its motion.
struct Body {
  limber::Model model;
  limber::MovingModel moving;

  explicit Body(const limber::Mesh& mesh) : model(mesh), moving(model) {}
};

/// The largest part of the moves that keeps the separation from the ball, and within the sheet.
double safe_part(Body& sheet, const Body& ball, const std::vector<Vec3>& moves) {
  std::vector<Vec3> end = sheet.model.mesh().positions();
  for (std::size_t v = 0; v < end.size(); ++v) end[v] += moves[v];
  sheet.moving.set_motion(end).value();
  const limber::ImpactOptions options{.min_separation = separation, .separation_fraction = 0.5};
  return std::min({1.0, share * limber::time_of_impact(sheet.moving, ball.moving, options).lower,
                   share * limber::self_time_of_impact(sheet.moving, options).lower});  // infinite if nothing touches
}

}  // namespace

int main() {
  Body ball(shapes::ball(32));
  ball.moving.set_motion(ball.model.mesh().positions()).value();  // it stands still
  std::vector<Vec3> start = shapes::sheet(32, 3).positions();
  for (Vec3& p : start) p.z += 3;
  Body sheet(limber::Mesh::create(start, shapes::sheet(32, 3).triangles()).value());

  std::size_t meeting = 0, steps = 0;
  std::vector<Vec3> left(start.size(), Vec3{0, 0, -8});  // of the way of the throw
  for (double longest = 8; longest > 0 && steps < 400; ++steps) {
    const double part = safe_part(sheet, ball, left);
    std::vector<Vec3> positions = sheet.model.mesh().positions();
    for (std::size_t v = 0; v < left.size(); ++v) positions[v] += part * left[v], left[v] *= 1 - part;
    sheet.model.move_all(positions).value();
    sheet.model.commit();
    meeting += limber::intersections({sheet.model}, {ball.model}, {}).count +
               limber::self_intersections(sheet.model, {}).count;
    if (part == 1) break;
    // Vertices of elements that are within twice the separation stop; the others go on. So the next step finds nothing
    // at its own separation.
    std::vector<Vec3> end = positions;
    for (std::size_t v = 0; v < end.size(); ++v) end[v] += 0.01 * left[v];
    sheet.moving.set_motion(end).value();
    const limber::ImpactOptions near{.min_separation = 2 * separation};
    const auto stop_near_ball = [&](const limber::ElementPair& pair) {
      const limber::ElementState state = limber::state_of(sheet.moving, ball.moving, pair, 0);
      for (std::size_t i = 0; i < state.count_of_a; ++i) left[state.vertices[i]] = {};
      return true;
    };
    const auto stop_near_itself = [&](const limber::ElementPair& pair) {
      for (const limber::VertexId v : limber::self_state_of(sheet.moving, pair, 0).vertices) left[v] = {};
      return true;
    };
    limber::visit_impact_candidates(sheet.moving, ball.moving, stop_near_ball, near);
    limber::visit_self_impact_candidates(sheet.moving, stop_near_itself, near);
    longest = 0;
    for (const Vec3& move : left) longest = std::max(longest, length(move));
  }
  const double apart = limber::distance({sheet.model}, {ball.model}).upper;
  std::printf("%zu steps, %zu intersections, %.4f apart\n", steps, meeting, apart);
  return meeting == 0 && apart >= separation * (1 - 1e-6) ? 0 : 1;
}
