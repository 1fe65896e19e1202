// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A sheet sinks onto a ball and hangs down around it. It passes neither through the ball nor through itself: after
// every step the program asks for all intersections, and fails if there is one.
//
// Each step asks for all pairs of triangles that are close. They bound how far each vertex may move: triangles that are
// d apart, and whose vertices move by less than d / 2, cannot meet. These are the displacement bounds of Offset
// Geometric Contact [Chen2025].
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "limber/limber.h"
#include "shapes.h"

namespace {

using limber::Vec3;

constexpr std::uint32_t squares = 32;
constexpr double margin = 0.06;  // pairs that are farther apart allow as much motion as those at this distance
constexpr double gap = 0.02;     // at which the ball stops the sheet
constexpr double share = 0.45;   // of a gap that either side may use up in a step

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

/// Takes what goes into the body out of the moves, and shortens them until nothing can meet. Triangles that share a
/// vertex are no pairs unless they meet: what keeps them apart here is that the sheet hardly folds.
void limit(const limber::Model& sheet, const limber::Model& body, std::vector<Vec3>& moves) {
  const limber::Mesh& mesh = sheet.mesh();
  std::vector<double> reach(moves.size(), share * margin);
  const auto bound = [&](limber::TriangleId triangle, double most) {
    for (const limber::VertexId v : mesh.triangles()[triangle]) reach[v] = std::min(reach[v], most);
  };
  limber::visit_contacts({sheet}, {body}, margin, [&](const limber::Contact& contact) {
    bound(contact.triangle_a, 2 * share * contact.distance);  // the body stands still
    if (contact.distance > gap) return true;
    for (const limber::VertexId v : mesh.triangles()[contact.triangle_a]) {
      moves[v] -= std::max(0.0, dot(moves[v], contact.normal)) * contact.normal;
    }
    return true;
  });
  limber::visit_self_contacts(sheet, margin, [&](const limber::Contact& contact) {
    bound(contact.triangle_a, share * contact.distance);
    bound(contact.triangle_b, share * contact.distance);
    return true;
  });
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
  const bool lies_on_the_ball = limber::within({sheet}, {ball}, margin).is_yes() && positions.front().z < 0.5;
  return meeting == 0 && lies_on_the_ball ? 0 : 1;
}
