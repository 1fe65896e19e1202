// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Frames: all vertices of a cloth move, then its pairs with a ball and with itself are found.
#include <string>
#include <utility>
#include <vector>

#include "bench/contacts/contact_bench.h"
#include "bench/support/sampling.h"
#include "limber/contacts.h"
#include "limber/elements.h"

namespace limber::bench {
namespace {

/// Both as one mesh: vertices and triangles of b follow those of a.
Mesh joined(const Mesh& a, const Mesh& b) {
  std::vector<Vec3> positions = a.positions();
  std::vector<Corners> triangles = a.triangles();
  positions.insert(positions.end(), b.positions().begin(), b.positions().end());
  for (Corners corners : b.triangles()) {
    for (VertexId& v : corners) v += static_cast<VertexId>(a.positions().size());
    triangles.push_back(corners);
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

}  // namespace

void ContactBench::frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved,
                          const Mesh& ball) {
  fmt::print(stderr, "{}\n", name);
  const double margin = margin_of_size * diagonal(cloth);
  Model model(cloth);
  const Model body(ball);
  const auto move = [&](const std::vector<Vec3>& positions) {
    model.move_all(positions).value();
    model.commit();
  };
  const auto all_pairs = [&](const Model& m) {
    IdPairs pairs = self_pairs_within(m, margin);
    for (const auto& [a, b] : pairs_within({m}, {body}, margin)) {
      pairs.emplace_back(a, b + static_cast<TriangleId>(cloth.triangles().size()));
    }
    sort_pairs(pairs);
    return pairs;
  };
  const IdPairs first = all_pairs(model);
  move(moved);
  checker_.check(all_pairs(model) == all_pairs(Model(model.mesh())), "{}: contacts differ after motion", name);
  move(cloth.positions());
  checker_.check(all_pairs(model) == first, "{}: contacts differ after motion and back", name);
  const Mesh both = joined(cloth, ball);
  if (auto theirs = ipc_pairs_of(name, both)) {
    std::erase_if(*theirs, [&](const auto& pair) { return pair.first >= cloth.triangles().size(); });  // in the ball
    const Tolerance tolerance{.relative = 1e-9, .absolute = 0, .finds_intersections = false};
    differences_.push_back(
        compare_within(name, "IPC Toolkit", {both, both, true}, margin, first, *theirs, tolerance, checker_));
  }
  if (!checker_.all_right()) return;

  std::vector<Contact> room(2 * first.size());
  std::vector<double> parts[3];
  std::size_t turn = 0;
  Row frame{"frame", name, {}, std::to_string(first.size()), {}};
  frame.time = time([&] {
    const Stopwatch watch;
    move(++turn % 2 == 1 ? moved : cloth.positions());
    const double at_commit = watch.us();
    contacts({model}, {body}, margin, room);
    const double at_ball = watch.us();
    self_contacts(model, margin, room);
    parts[0].push_back(at_commit), parts[1].push_back(at_ball - at_commit), parts[2].push_back(watch.us() - at_ball);
  });
  add_peer(frame, "IPC Toolkit, candidates alone", "ipctk", name, "frame_candidates");
  add_peer(frame, "IPC Toolkit", "ipctk", name, "frame");
  rows_.push_back(frame);
  const char* names[] = {"of it: move all, commit", "of it: contacts with the ball", "of it: self_contacts"};
  for (std::size_t i = 0; i < 3; ++i) rows_.push_back({names[i], name, {summarize(parts[i]).median, 0}, "", {}});
}

void ContactBench::element_frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved,
                                  const Mesh& ball) {
  const double margin = margin_of_size * diagonal(cloth);
  Model model(cloth);
  const Model body(ball);
  const MeshEdges edges(cloth), edges_of_body(ball);
  const auto count = [&] {
    const ElementPairCount with_body = element_pairs({model}, edges, {body}, edges_of_body, margin, {}, {});
    const ElementPairCount with_itself = self_element_pairs(model, edges, margin, {}, {});
    return std::pair(with_body.vertex_face + with_itself.vertex_face, with_body.edge_edge + with_itself.edge_edge);
  };
  const auto [vertex_faces, edge_edges] = count();
  std::vector<VertexFacePair> vertex_face(2 * vertex_faces);
  std::vector<EdgeEdgePair> edge_edge(2 * edge_edges);
  std::size_t turn = 0;
  Row frame{"frame of elements", name, {}, fmt::format("{} + {}", vertex_faces, edge_edges), {}};
  frame.time = time([&] {
    model.move_all(++turn % 2 == 1 ? moved : cloth.positions()).value();
    model.commit();
    element_pairs({model}, edges, {body}, edges_of_body, margin, vertex_face, edge_edge);
    self_element_pairs(model, edges, margin, vertex_face, edge_edge);
  });
  add_peer(frame, "IPC Toolkit, candidates alone", "ipctk", name, "frame_candidates");
  add_peer(frame, "IPC Toolkit", "ipctk", name, "frame");
  rows_.push_back(frame);
}

}  // namespace limber::bench
