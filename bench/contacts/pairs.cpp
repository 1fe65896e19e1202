// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs of triangles and of elements, of one mesh with itself and of two meshes.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bench/contacts/contact_bench.h"
#include "limber/contacts.h"
#include "limber/elements.h"

namespace limber::bench {
namespace {

/// The mesh with a wave through it; every vertex moves.
std::vector<Vec3> waved(const Mesh& mesh) {
  const double size = diagonal(mesh), k = 6 * std::numbers::pi / size;
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) {
    p += 0.01 * size * Vec3{1.5 + std::sin(k * p.y), 1.5 + std::sin(k * p.z), 1.5 + std::sin(k * p.x)};
  }
  return positions;
}

IdPairs self_pairs(const Model& model) {
  IdPairs pairs;
  visit_self_intersections(model, [&](const TrianglePair& p) { return pairs.emplace_back(p.a, p.b), true; });
  sort_pairs(pairs);
  return pairs;
}

ElementIds element_pairs_within(const Model& model, const MeshEdges& edges, double margin) {
  ElementIds found;
  visit_self_element_pairs(
      model, edges, margin,
      [&](const VertexFacePair& p) { return found.vertex_face.emplace_back(p.vertex, p.triangle), true; },
      [&](const EdgeEdgePair& p) {
        const std::array<VertexId, 2> a = edges.vertices()[p.a], b = edges.vertices()[p.b];
        return found.edge_edge.push_back({a[0], a[1], b[0], b[1]}), true;
      });
  std::sort(found.vertex_face.begin(), found.vertex_face.end());
  std::sort(found.edge_edge.begin(), found.edge_edge.end());
  return found;
}

}  // namespace

void ContactBench::one_mesh(const std::string& name, const Mesh& mesh) {
  fmt::print(stderr, "{}\n", name);
  const double margin = margin_of_size * diagonal(mesh);
  const std::vector<Vec3> there = waved(mesh);
  Model model(mesh);
  const IdPairs met = self_pairs(model), close = self_pairs_within(model, margin);
  checker_.check(self_collide(model).is_yes() == !met.empty(), "{}: self_collide and self_intersections differ", name);
  const DistanceResult distance = self_distance(model);
  checker_.check((distance.upper == 0) == !met.empty(), "{}: self_distance and self_intersections differ", name);
  checker_.check(std::includes(close.begin(), close.end(), met.begin(), met.end()), "{}: not all that meets is close",
                 name);
  const auto move = [&](const std::vector<Vec3>& positions) {
    model.move_all(positions).value();
    model.commit();
  };
  move(there), move(mesh.positions());
  checker_.check(self_pairs(model) == met, "{}: self_intersections differ after motion", name);
  checker_.check(self_pairs_within(model, margin) == close, "{}: self_contacts differ after motion", name);

  const MeshPair itself{mesh, mesh, true};
  if (const auto theirs = pairs_of("meshlib_" + name + "_self_pairs")) {
    differences_.push_back(compare_crossings(name, "MeshLib", itself, met, *theirs, checker_));
  }
  if (const auto theirs = ipc_pairs_of(name, mesh)) {
    const Tolerance tolerance{.relative = 1e-9, .absolute = 0, .finds_intersections = false};
    differences_.push_back(compare_within(name, "IPC Toolkit", itself, margin, close, *theirs, tolerance, checker_));
  }
  if (!checker_.all_right()) return;

  const std::string inflated = "inflation=0.0005 of", lbvh = "LBVH; " + inflated;
  const auto count = [](std::size_t pairs) { return std::to_string(pairs); };
  Row build{"build", name, time([&] { const Model made(mesh); }), count(mesh.triangles().size()), {}};
  add_peer(build, "MeshLib", "meshlib", name, "build");
  add_peer(build, "IPC Toolkit", "ipctk", name, "build", lbvh);
  rows_.push_back(build);

  std::size_t turn = 0;
  rows_.push_back({"move all and commit",
                   name,
                   time([&] { move(++turn % 2 == 1 ? there : mesh.positions()); }),
                   count(mesh.triangles().size()),
                   {}});
  move(there), move(mesh.positions());

  std::vector<TrianglePair> room(met.size());
  Row pairs{"self_intersections", name, time([&] { self_intersections(model, room); }), count(met.size()), {}};
  add_peer(pairs, "MeshLib, strict", "meshlib", name, "self_pairs");
  add_peer(pairs, "MeshLib, touching", "meshlib", name, "self_pairs_touching");
  rows_.push_back(pairs);

  Row any{"self_collide", name, time([&] { self_collide(model); }), met.empty() ? "no" : "yes", {}};
  add_peer(any, "IPC Toolkit, with build", "ipctk", name, "has_intersections");
  for (PeerTime& peer : any.peers) peer.count = peer.count == "0" ? "no" : "yes";
  rows_.push_back(any);

  std::vector<Contact> contacts(close.size());
  rows_.push_back(
      {"self_contacts", name, time([&] { self_contacts(model, margin, contacts); }), count(close.size()), {}});
  Row moved{"move all, commit, self_contacts",
            name,
            time([&] { move(mesh.positions()), self_contacts(model, margin, contacts); }, [&] { move(there); }),
            count(close.size()),
            {}};
  add_peer(moved, "IPC Toolkit, candidates alone", "ipctk", name, "candidates", inflated);
  add_both_parts(moved, name);
  rows_.push_back(moved);
  rows_.push_back({"self_distance", name, time([&] { self_distance(model); }), "", {}});
}

void ContactBench::two_meshes(const std::string& name, const Mesh& a, const Mesh& b, bool with_given_margin) {
  fmt::print(stderr, "{} and its ball\n", name);
  const Model cloth(a), ball(b);
  const Placed one{cloth}, other{ball};
  IdPairs met;
  visit_intersections(one, other, [&](const TrianglePair& p) { return met.emplace_back(p.a, p.b), true; });
  sort_pairs(met);
  checker_.check(pairs_within(one, other, 0) == met, "{}: contacts with a margin of 0 and intersections differ", name);
  if (const auto theirs = pairs_of("meshlib_" + name + "_pairs")) {
    differences_.push_back(compare_crossings(name, "MeshLib", {a, b}, met, *theirs, checker_));
  }
  std::vector<TrianglePair> room(met.size());
  Row pairs{"intersections", name, {}, std::to_string(met.size()), {}};
  add_peer(pairs, "MeshLib", "meshlib", name, "pairs");
  add_peer(pairs, "Coal", "coal", name, "pairs_0");

  std::vector<std::pair<std::string, double>> margins{{"0", 0}, {"margin", margin_of_size * diagonal(a)}};
  if (with_given_margin) margins.emplace_back("0.01", 0.01);
  std::vector<Row> rows;
  for (const auto& [label, margin] : margins) {
    const IdPairs close = pairs_within(one, other, margin);
    for (const std::string volume : {"OBB", "OBBRSS"}) {
      const auto theirs = pairs_of("coal_" + name + "_pairs_" + label + "_" + volume);
      if (!theirs) continue;
      const Tolerance tolerance{.relative = 1e-3, .absolute = 1e-6};  // of its GJK and EPA
      differences_.push_back(
          compare_within(name, "Coal, " + volume, {a, b}, margin, close, *theirs, tolerance, checker_));
    }
    if (margin == 0 || !checker_.all_right()) continue;
    std::vector<Contact> found(close.size());
    Row row{fmt::format("contacts within {:.4g}", margin),
            name,
            time([&] { contacts(one, other, margin, found); }),
            std::to_string(close.size()),
            {}};
    add_peer(row, "Coal", "coal", name, "pairs_" + label);
    rows.push_back(row);
  }
  if (!checker_.all_right()) return;
  pairs.time = time([&] { intersections(one, other, room); });
  rows_.push_back(pairs);
  rows_.insert(rows_.end(), rows.begin(), rows.end());
}

void ContactBench::elements(const std::string& name, const Mesh& mesh) {
  const double margin = margin_of_size * diagonal(mesh);
  const std::vector<Vec3> there = waved(mesh);
  Model model(mesh);
  const MeshEdges edges(mesh);
  const ElementIds found = element_pairs_within(model, edges, margin);
  const auto move = [&](const std::vector<Vec3>& positions) {
    model.move_all(positions).value();
    model.commit();
  };
  move(there), move(mesh.positions());
  const ElementIds again = element_pairs_within(model, edges, margin);
  checker_.check(again.vertex_face == found.vertex_face && again.edge_edge == found.edge_edge,
                 "{}: self_element_pairs differ after motion", name);
  const auto theirs = read_ipc_elements(settings_.answers / ("ipctk_" + name + "_edge_edge.txt"),
                                        settings_.answers / ("ipctk_" + name + "_face_vertex.txt"));
  if (theirs) differences_.push_back(compare_elements(name, mesh, margin, found, *theirs, checker_));
  if (!checker_.all_right()) return;

  std::vector<VertexFacePair> vertex_face(found.vertex_face.size());
  std::vector<EdgeEdgePair> edge_edge(found.edge_edge.size());
  const std::string count = fmt::format("{} + {}", vertex_face.size(), edge_edge.size());
  rows_.push_back({"edges", name, time([&] { const MeshEdges made(mesh); }), std::to_string(edges.size()), {}});
  const auto ask = [&] { self_element_pairs(model, edges, margin, vertex_face, edge_edge); };
  rows_.push_back({"self_element_pairs", name, time(ask), count, {}});
  Row moved{"move all, commit, self_element_pairs",
            name,
            time([&] { move(mesh.positions()), ask(); }, [&] { move(there); }),
            count,
            {}};
  add_peer(moved, "IPC Toolkit, candidates alone", "ipctk", name, "candidates", "inflation=0.0005 of");
  add_peer(moved, "IPC Toolkit, candidates alone, twice the inflation", "ipctk", name, "candidates",
           "inflation=0.001 of");
  add_both_parts(moved, name);
  rows_.push_back(moved);
}

}  // namespace limber::bench
