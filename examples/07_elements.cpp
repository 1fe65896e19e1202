// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Vertices with faces and edges with edges, as a solver with a barrier for each pair wants them: the energy of a sheet
// that sinks onto a ball, and of one that is folded onto itself.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "limber/limber.h"
#include "shapes.h"

namespace {

constexpr double barrier_distance = 0.02;

/// The barrier of incremental potential contact: 0 from barrier_distance on, without bound towards distance 0.
double barrier(double distance) {
  const double x = distance * distance, d = barrier_distance * barrier_distance;
  return -(x - d) * (x - d) * std::log(x / d) / (d * d);
}

/// The flat sheet after its right half was folded over the left, `gap` above it.
std::vector<limber::Vec3> folded(const limber::Mesh& flat, double gap) {
  std::vector<limber::Vec3> positions = flat.positions();
  for (limber::Vec3& p : positions) {
    if (p.x > 0) p = {-p.x, p.y, gap};
  }
  return positions;
}

}  // namespace

int main() {
  limber::Model sheet(shapes::sheet(48, 4));
  const limber::Model ball(shapes::ball(48));

  double energy = 0;
  const auto add_vertex_face = [&](const limber::VertexFacePair& p) { return energy += barrier(p.distance), true; };
  const auto add_edge_edge = [&](const limber::EdgeEdgePair& p) { return energy += barrier(p.distance), true; };

  bool is_as_expected = true;
  double last = -1;
  for (const double gap : {0.03, 0.015, 0.005}) {
    energy = 0;
    const limber::Placed above{sheet, {{}, {0, 0, 1 + gap}}};
    const limber::ElementPairCount found =
        limber::visit_element_pairs(above, {ball}, barrier_distance, add_vertex_face, add_edge_edge);
    std::printf("sheet %g above the ball: %zu vertex-face pairs, %zu edge-edge pairs, energy %g\n", gap,
                found.vertex_face, found.edge_edge, energy);
    is_as_expected = is_as_expected && (energy > 0) == (gap < barrier_distance) && energy > last;
    last = energy;
  }

  const limber::Mesh flat = sheet.mesh();
  for (const double gap : {0.03, 0.015}) {
    sheet.move_all(folded(flat, gap)).value();
    sheet.commit();
    // Into arrays, as far as there is room. The counts are those of all pairs.
    std::vector<limber::VertexFacePair> vertex_face(20'000);
    std::vector<limber::EdgeEdgePair> edge_edge(20'000);
    const limber::ElementPairCount found = limber::self_element_pairs(sheet, barrier_distance, vertex_face, edge_edge);
    energy = 0;
    for (std::size_t i = 0; i < std::min(found.vertex_face, vertex_face.size()); ++i) add_vertex_face(vertex_face[i]);
    for (std::size_t i = 0; i < std::min(found.edge_edge, edge_edge.size()); ++i) add_edge_edge(edge_edge[i]);
    std::printf("sheet folded to %g: %zu vertex-face pairs, %zu edge-edge pairs, energy %g\n", gap, found.vertex_face,
                found.edge_edge, energy);
    is_as_expected = is_as_expected && (found.vertex_face > 1000) == (gap < barrier_distance);
  }
  return is_as_expected ? 0 : 1;
}
