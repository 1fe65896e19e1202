// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A sheet sinks onto a ball and hangs down around it. It passes neither through the ball nor through itself: after
// every step the program asks for all intersections, and fails if there is one.
//
// Each step limits how far each vertex may go: elements that are d apart, and of which one's vertices go no farther
// than x and the other's no farther than d - x, cannot meet. These are the displacement bounds of Offset Geometric
// Contact [Chen2025].
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "limber/limber.h"
#include "shapes.h"

namespace {

using limber::Vec3;

constexpr std::uint32_t squares = 32;
constexpr double gap = 0.02;         // at which the ball stops the sheet
constexpr double separation = 1e-4;  // that is always kept

/// Where vertices would go without contacts: down, and to the distances that neighbors in the grid have in the flat
/// sheet.
std::vector<Vec3> wanted_moves(const std::vector<Vec3>& flat, const std::vector<Vec3>& positions) {
  std::vector<Vec3> moves(positions.size(), {0, 0, -0.004});
  const auto pull = [&](std::size_t v, std::size_t w) {
    const Vec3 between = positions[w] - positions[v];
    const Vec3 move = (0.15 * (1 - length(flat[w] - flat[v]) / length(between))) * between;
    moves[v] += move, moves[w] -= move;
  };
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (v % (squares + 1) < squares) pull(v, v + 1);
    if (v + squares + 1 < positions.size()) pull(v, v + squares + 1);
  }
  return moves;
}

/// Takes what goes into the ball out of the moves, and shortens them until nothing can meet.
void limit(const limber::Model& sheet, const limber::Model& ball, std::vector<Vec3>& moves) {
  limber::visit_contacts({sheet}, {ball}, gap, [&](const limber::Contact& contact) {
    for (const limber::VertexId v : sheet.mesh().triangles()[contact.triangle_a]) {
      moves[v] -= std::max(0.0, dot(moves[v], contact.normal)) * contact.normal;
    }
    return true;
  });
  std::vector<double> reach(moves.size());
  std::transform(moves.begin(), moves.end(), reach.begin(), [](const Vec3& move) { return length(move); });
  limber::limit_displacements({sheet}, {ball}, separation, reach);
  limber::limit_self_displacements(sheet, separation, reach);
  for (std::size_t v = 0; v < moves.size(); ++v) {
    const double wanted = length(moves[v]);
    if (wanted > reach[v]) moves[v] *= reach[v] / wanted;
  }
}

}  // namespace

int main() {
  const limber::Mesh flat = shapes::sheet(squares, 3);
  const limber::Model ball(shapes::ball(32));
  std::vector<Vec3> positions = flat.positions();
  for (Vec3& p : positions) p.z += 1.2;
  limber::Model sheet(limber::Mesh::create(positions, flat.triangles()).value());

  std::size_t meeting = 0;
  for (int step = 1; step <= 400; ++step) {
    std::vector<Vec3> moves = wanted_moves(flat.positions(), positions);
    limit(sheet, ball, moves);
    for (std::size_t v = 0; v < positions.size(); ++v) positions[v] += moves[v];
    sheet.move_all(positions).value();
    sheet.commit();
    meeting += limber::intersections({sheet}, {ball}, {}).count + limber::self_intersections(sheet, {}).count;
    if (step % 100 == 0) {
      std::printf("step %d: a corner is %.3f high, %.4f above the ball, %zu intersections so far\n", step,
                  positions.front().z, limber::distance({sheet}, {ball}).upper, meeting);
    }
  }
  const bool lies_on_the_ball = limber::within({sheet}, {ball}, 2 * gap).is_yes() && positions.front().z < 0.5;
  return meeting == 0 && lies_on_the_ball ? 0 : 1;
}
