// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What do all pairs of triangles that intersect or are close cost, of two meshes and of one with
//                 itself, and what do closest points cost, next to other libraries?
// Workload        A cloth that intersects itself, bunny and armadillo, each with itself. Two cloths of 100 000
//                 triangles with a ball of 10 000, and frames in which all their vertices move. The margin is a
//                 thousandth of the size. 10 000 points around the bunny, and 10 000 near it, in one call each.
// Metric          Microseconds a call, medians of up to 15 runs, by the clock and by the processor's time, one thread.
//                 Ratios of other libraries, measured by peers.py as README.md says, to ours.
// Expected shape  Several times faster than other libraries that answer the same question. Where a mesh is close to
//                 itself everywhere, contacts cost what comparing their triangles costs.
// Checked         Pairs of other libraries: each difference has a reason. Our answers with each other. Closest points
//                 lie on their triangles; every hundredth by brute force, and those that other libraries have closer.
#include <oneapi/tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bench/contacts/contact_bench.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/contacts.h"
#include "limber/elements.h"
#include "limber/io.h"

namespace limber::bench {
namespace {

constexpr double margin_of_size = 1e-3;
constexpr Tolerance tolerance_of_ipc{.relative = 1e-9, .absolute = 0, .finds_intersections = false};

void move(Model& model, const std::vector<Vec3>& positions) {
  model.move_all(positions).value();
  model.commit();
}

/// The mesh with a wave through it; every vertex moves.
std::vector<Vec3> waved(const Mesh& mesh) {
  const double size = diagonal(mesh), k = 6 * std::numbers::pi / size;
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) {
    p += 0.01 * size * Vec3{1.5 + std::sin(k * p.y), 1.5 + std::sin(k * p.z), 1.5 + std::sin(k * p.x)};
  }
  return positions;
}

/// Runs a query that calls back for each pair of triangles.
template <typename Query>
IdPairs pairs_of(const Query& query) {
  IdPairs pairs;
  query([&](TriangleId a, TriangleId b) { return pairs.emplace_back(a, b), true; });
  sort_pairs(pairs);
  return pairs;
}

IdPairs self_pairs(const Model& model) {
  return pairs_of(
      [&](const auto& add) { visit_self_intersections(model, [&](const TrianglePair& p) { return add(p.a, p.b); }); });
}

IdPairs self_pairs_within(const Model& model, double margin) {
  return pairs_of([&](const auto& add) {
    visit_self_contacts(model, margin, [&](const Contact& c) { return add(c.triangle_a, c.triangle_b); });
  });
}

IdPairs pairs_within(const Placed& a, const Placed& b, double margin) {
  return pairs_of([&](const auto& add) {
    visit_contacts(a, b, margin, [&](const Contact& c) { return add(c.triangle_a, c.triangle_b); });
  });
}

ElementIds element_pairs_within(const Model& model, double margin) {
  ElementIds found;
  const auto edges = model.edges().vertices();
  visit_self_element_pairs(
      model, margin,
      [&](const VertexFacePair& p) { return found.vertex_face.emplace_back(p.vertex, p.triangle), true; },
      [&](const EdgeEdgePair& p) {
        const std::array<VertexId, 2> a = edges[p.a], b = edges[p.b];
        return found.edge_edge.push_back({a[0], a[1], b[0], b[1]}), true;
      });
  std::sort(found.vertex_face.begin(), found.vertex_face.end());
  std::sort(found.edge_edge.begin(), found.edge_edge.end());
  return found;
}

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

void ContactBench::compare_with_ipc(const std::string& name, MeshView mesh, std::size_t own_triangles, double margin,
                                    const IdPairs& ours) {
  const std::string prefix = "ipctk_" + name;
  const auto elements = read_ipc_elements(answer(prefix + "_edge_edge"), answer(prefix + "_face_vertex"));
  if (!elements) return;
  IdPairs theirs = triangles_of(*elements, mesh);
  std::erase_if(theirs, [&](const auto& pair) { return pair.first >= own_triangles; });
  differences_.push_back(
      compare_within(name, "IPC Toolkit", {mesh, mesh, true}, margin, ours, theirs, tolerance_of_ipc, checker_));
}

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

  if (const auto theirs = read_pairs(answer("meshlib_" + name + "_self_pairs"))) {
    differences_.push_back(compare_crossings(name, "MeshLib", {mesh, mesh, true}, met, *theirs, checker_));
  }
  compare_with_ipc(name, mesh, mesh.triangles().size(), margin, close);
  if (!checker_.all_right()) return;

  const std::string inflated = "inflation=0.0005 of", lbvh = "LBVH; " + inflated;
  const auto count = [](std::size_t pairs) { return std::to_string(pairs); };
  Row build{"build", name, time([&] { const Model made(mesh); }), count(mesh.triangles().size())};
  add_peer(build, "MeshLib", "meshlib", "build");
  add_peer(build, "IPC Toolkit", "ipctk", "build", lbvh);
  rows_.push_back(build);

  std::size_t turn = 0;
  rows_.push_back({"move all and commit", name, time([&] { move(model, ++turn % 2 == 1 ? there : mesh.positions()); }),
                   count(mesh.triangles().size())});
  move(model, there), move(model, mesh.positions());

  std::vector<TrianglePair> room(met.size());
  Row pairs{"self_intersections", name, time([&] { self_intersections(model, room); }), count(met.size())};
  add_peer(pairs, "MeshLib, strict", "meshlib", "self_pairs");
  add_peer(pairs, "MeshLib, touching", "meshlib", "self_pairs_touching");
  rows_.push_back(pairs);

  Row any{"self_collide", name, time([&] { static_cast<void>(self_collide(model)); }), met.empty() ? "no" : "yes"};
  add_peer(any, "IPC Toolkit, with build", "ipctk", "has_intersections");
  for (PeerTime& peer : any.peers) peer.count = peer.count == "0" ? "no" : "yes";
  rows_.push_back(any);

  std::vector<Contact> contacts(close.size());
  rows_.push_back({"self_contacts", name, time([&] { self_contacts(model, margin, contacts); }), count(close.size())});
  Row moved{
      "move all, commit, self_contacts", name,
      time([&] { move(model, mesh.positions()), self_contacts(model, margin, contacts); }, [&] { move(model, there); }),
      count(close.size())};
  add_peer(moved, "IPC Toolkit, candidates alone", "ipctk", "candidates", inflated);
  add_both_parts(moved);
  rows_.push_back(moved);
  rows_.push_back({"self_distance", name, time([&] { static_cast<void>(self_distance(model)); }), ""});
}

void ContactBench::two_meshes(const std::string& name, const Mesh& a, const Mesh& b, bool with_given_margin) {
  fmt::print(stderr, "{} and its ball\n", name);
  const Model cloth(a), ball(b);
  const Placed one{cloth}, other{ball};
  const IdPairs met = pairs_of(
      [&](const auto& add) { visit_intersections(one, other, [&](const TrianglePair& p) { return add(p.a, p.b); }); });
  checker_.check(pairs_within(one, other, 0) == met, "{}: contacts with a margin of 0 and intersections differ", name);
  if (const auto theirs = read_pairs(answer("meshlib_" + name + "_pairs"))) {
    differences_.push_back(compare_crossings(name, "MeshLib", {a, b}, met, *theirs, checker_));
  }
  std::vector<TrianglePair> room(met.size());
  Row pairs{"intersections", name, {}, std::to_string(met.size())};
  add_peer(pairs, "MeshLib", "meshlib", "pairs");
  add_peer(pairs, "Coal", "coal", "pairs_0");

  std::vector<std::pair<std::string, double>> margins{{"0", 0}, {"margin", margin_of_size * diagonal(a)}};
  if (with_given_margin) margins.emplace_back("0.01", 0.01);
  std::vector<Row> rows;
  for (const auto& [label, margin] : margins) {
    const IdPairs close = pairs_within(one, other, margin);
    for (const std::string volume : {"OBB", "OBBRSS"}) {
      const auto theirs = read_pairs(answer("coal_" + name + "_pairs_" + label + "_" + volume));
      if (!theirs) continue;
      const Tolerance tolerance{.relative = 1e-3, .absolute = 1e-6};  // of its GJK and EPA
      differences_.push_back(
          compare_within(name, "Coal, " + volume, {a, b}, margin, close, *theirs, tolerance, checker_));
    }
    if (margin == 0 || !checker_.all_right()) continue;
    std::vector<Contact> found(close.size());
    Row row{fmt::format("contacts within {:.4g}", margin), name, time([&] { contacts(one, other, margin, found); }),
            std::to_string(close.size())};
    add_peer(row, "Coal", "coal", "pairs_" + label);
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
  const ElementIds found = element_pairs_within(model, margin);
  const std::string prefix = "ipctk_" + name;
  const auto theirs = read_ipc_elements(answer(prefix + "_edge_edge"), answer(prefix + "_face_vertex"));
  if (theirs) differences_.push_back(compare_elements(name, mesh, margin, found, *theirs, checker_));
  if (!checker_.all_right()) return;

  std::vector<VertexFacePair> vertex_face(found.vertex_face.size());
  std::vector<EdgeEdgePair> edge_edge(found.edge_edge.size());
  const std::string count = fmt::format("{} + {}", vertex_face.size(), edge_edge.size());
  const auto ask = [&] { self_element_pairs(model, margin, vertex_face, edge_edge); };
  rows_.push_back({"self_element_pairs", name, time(ask), count});
  Row moved{"move all, commit, self_element_pairs", name,
            time([&] { move(model, mesh.positions()), ask(); }, [&] { move(model, there); }), count};
  add_peer(moved, "IPC Toolkit, candidates alone", "ipctk", "candidates", "inflation=0.0005 of");
  add_peer(moved, "IPC Toolkit, candidates alone, twice the inflation", "ipctk", "candidates", "inflation=0.001 of");
  add_both_parts(moved);
  rows_.push_back(moved);
}

void ContactBench::frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved,
                          const Mesh& ball) {
  fmt::print(stderr, "{}\n", name);
  const double margin = margin_of_size * diagonal(cloth);
  Model model(cloth);
  const Model body(ball);
  IdPairs first = self_pairs_within(model, margin);
  for (const auto& [a, b] : pairs_within({model}, {body}, margin)) {
    first.emplace_back(a, b + static_cast<TriangleId>(cloth.triangles().size()));
  }
  sort_pairs(first);
  const Mesh both = joined(cloth, ball);
  compare_with_ipc(name, both, cloth.triangles().size(), margin, first);
  if (!checker_.all_right()) return;

  std::vector<Contact> room(2 * first.size());
  std::vector<double> parts[3];
  std::size_t turn = 0;
  Row frame{"frame", name, {}, std::to_string(first.size())};
  frame.time = time([&] {
    const Stopwatch watch;
    move(model, ++turn % 2 == 1 ? moved : cloth.positions());
    const double at_commit = watch.us();
    contacts({model}, {body}, margin, room);
    const double at_ball = watch.us();
    self_contacts(model, margin, room);
    parts[0].push_back(at_commit), parts[1].push_back(at_ball - at_commit), parts[2].push_back(watch.us() - at_ball);
  });
  add_ipc_frames(frame);
  rows_.push_back(frame);
  const char* names[] = {"of it: move all, commit", "of it: contacts with the ball", "of it: self_contacts"};
  for (std::size_t i = 0; i < 3; ++i) rows_.push_back({names[i], name, {median(parts[i]), 0}, ""});
}

void ContactBench::element_frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved,
                                  const Mesh& ball) {
  const double margin = margin_of_size * diagonal(cloth);
  Model model(cloth);
  const Model body(ball);
  const auto count = [&] {
    const ElementPairCount with_body = element_pairs({model}, {body}, margin, {}, {});
    const ElementPairCount with_itself = self_element_pairs(model, margin, {}, {});
    return std::pair(with_body.vertex_face + with_itself.vertex_face, with_body.edge_edge + with_itself.edge_edge);
  };
  const auto [vertex_faces, edge_edges] = count();
  std::vector<VertexFacePair> vertex_face(2 * vertex_faces);
  std::vector<EdgeEdgePair> edge_edge(2 * edge_edges);
  std::size_t turn = 0;
  Row frame{"frame of elements", name, {}, fmt::format("{} + {}", vertex_faces, edge_edges)};
  frame.time = time([&] {
    move(model, ++turn % 2 == 1 ? moved : cloth.positions());
    element_pairs({model}, {body}, margin, vertex_face, edge_edge);
    self_element_pairs(model, margin, vertex_face, edge_edge);
  });
  add_ipc_frames(frame);
  rows_.push_back(frame);
}

namespace {

void ask_for_pairs(ContactBench& bench, const Settings& settings) {
  const std::pair<const char*, Mesh> scans[] = {{"cloth", load_mesh(settings.meshes / "cloth_ball_92.ply").value()},
                                                {"bunny", load_mesh(settings.meshes / "stanford-bunny.obj").value()},
                                                {"armadillo", load_mesh(settings.meshes / "armadillo.obj").value()}};
  for (const auto& [name, mesh] : scans) bench.one_mesh(name, mesh);
  for (const auto& [name, mesh] : scans) bench.elements(name, mesh);
  for (const std::string name : {"drape", "folded"}) {
    if (settings.answers.empty() || !std::filesystem::exists(settings.answers / (name + ".ply"))) {
      fmt::print(stderr, "{} is left out: peers.py, which makes it, has not run\n", name);
      continue;
    }
    const MeshSequence cloths = MeshSequence::open(settings.answers / (name + ".ply")).value();
    const Mesh &cloth = cloths.first().mesh, ball = load_mesh(settings.answers / (name + "_ball.ply")).value();
    if (name == "folded") bench.one_mesh(name, cloth);
    bench.two_meshes(name, cloth, ball, name == "drape");
    const std::vector<Vec3> moved = cloths.read_positions(settings.answers / (name + "_moved.ply"), 1).value();
    bench.frames("frame_" + name, cloth, moved, ball);
    bench.element_frames("frame_" + name, cloth, moved, ball);
  }
}

void run(const Settings& settings, const Options& options, Checker& checker) {
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  ContactBench bench(settings, checker);
  ask_for_pairs(bench, settings);
  const Mesh bunny = load_mesh(settings.meshes / "stanford-bunny.obj").value();
  for (const std::string kind : {"anywhere", "near"}) bench.points("bunny", bunny, kind);
  if (!checker.all_right()) return;
  Table text(options, "contacts.md");
  bench.write(text);
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  std::filesystem::path peers, answers;
  return run_bench(
      argc, argv, "What do pairs of triangles and closest points cost, next to other libraries?",
      [&](const Options& options, Checker& checker) {
        run({options.meshes, peers, answers, options.quick}, options, checker);
      },
      [&](CLI::App& app) {
        app.add_option("--peers", peers, "contact_peers.csv, written by peers.py; default: no other library");
        app.add_option("--answers", answers, "folder of answers and meshes written by peers.py; default: none");
      });
}
