// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question        What do all pairs of triangles that intersect or are close cost, of two meshes and of one with
//                 itself, next to other libraries?
// Workload        A cloth that intersects itself, bunny and armadillo, each with itself. Two cloths of 100 000
//                 triangles with a ball of 10 000, and frames in which all their vertices move. The margin is a
//                 thousandth of the size.
// Metric          Microseconds a call, medians of up to 15 runs, by the clock and by the processor's time, one thread.
//                 Ratios of other libraries, measured by peers.py as README.md says, to ours.
// Expected shape  Several times faster than other libraries that answer the same question. Where a mesh is close to
//                 itself everywhere, contacts cost what comparing their triangles costs.
// Checked         Pairs of other libraries: each difference has a reason. Our answers with each other, and after motion
//                 with those of new models.
#include <oneapi/tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/contacts/peer_answers.h"
#include "bench/contacts/tables.h"
#include "bench/support/report.h"
#include "bench/support/sampling.h"
#include "limber/contacts.h"
#include "limber/elements.h"
#include "limber/io.h"
#include "limber/model.h"

namespace limber::bench {
namespace {

constexpr double margin_of_size = 1e-3;

struct Settings {
  Options options;
  std::filesystem::path meshes, peers, answers;
};

double diagonal(const Mesh& mesh) {
  Vec3 low = mesh.positions().front(), high = low;
  for (const Vec3& p : mesh.positions()) low = min(low, p), high = max(high, p);
  return length(high - low);
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

class ContactBench {
 public:
  explicit ContactBench(const Settings& settings)
      : settings_(settings), rows_of_peers_(read_peer_rows(settings.peers)), runs_(settings.options.quick ? 3 : 15) {}

  void one_mesh(const std::string& name, const Mesh& mesh);
  void elements(const std::string& name, const Mesh& mesh);
  void two_meshes(const std::string& name, const Mesh& a, const Mesh& b, bool with_given_margin);
  void frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved, const Mesh& ball);
  void element_frames(const std::string& name, const Mesh& cloth, const std::vector<Vec3>& moved, const Mesh& ball);
  /// The exit code. Nothing is reported if an answer was wrong.
  int report() const {
    if (checker_.all_right()) write_tables(settings_.options, rows_of_peers_, rows_, differences_);
    return checker_.all_right() ? 0 : 1;
  }

 private:
  /// As peers.py takes times: an untimed call first, then up to 15, fewer of long ones. prepare() is not timed.
  Timed time(const std::function<void()>& call, const std::function<void()>& prepare = {}) const;
  std::optional<IdPairs> pairs_of(const std::string& file) const {
    return settings_.answers.empty() ? std::nullopt : read_pairs(settings_.answers / (file + ".txt"));
  }
  std::optional<IdPairs> ipc_pairs_of(const std::string& mesh, MeshView view) const {
    if (settings_.answers.empty()) return std::nullopt;
    return read_ipc_pairs(settings_.answers / ("ipctk_" + mesh + "_edge_edge.txt"),
                          settings_.answers / ("ipctk_" + mesh + "_face_vertex.txt"), view);
  }
  /// The fastest setting of a peer, if it was asked.
  void add_peer(Row& row, const std::string& library, const std::string& peer, const std::string& mesh,
                const std::string& question, const std::string& part = "") const {
    if (const auto found = fastest(rows_of_peers_, peer, mesh, question, part))
      row.peers.push_back(as_time(library, *found));
  }
  /// IPC's candidates by LBVH and their distances, if it was asked.
  void add_both_parts(Row& row, const std::string& mesh) const {
    const auto candidates = fastest(rows_of_peers_, "ipctk", mesh, "candidates", "LBVH; inflation=0.0005 of");
    const auto distances = fastest(rows_of_peers_, "ipctk", mesh, "distances");
    if (!candidates || !distances) return;
    PeerTime both = as_time("IPC Toolkit, candidates and distances", *distances);
    const PeerTime first = as_time("", *candidates);
    both.setting = "LBVH", both.time.us += first.time.us, both.time.processor_us += first.time.processor_us;
    row.peers.push_back(both);
  }
  static PeerTime as_time(const std::string& library, const PeerRow& row) {
    const std::string key = "processor=";
    const std::size_t at = row.details.find(key);
    const double processor_us = at == std::string::npos ? 0 : std::stod(row.details.substr(at + key.size()));
    return {library, row.setting(), row.count, {row.us, processor_us}};
  }

  Settings settings_;
  std::vector<PeerRow> rows_of_peers_;
  int runs_;
  Checker checker_;
  std::vector<Row> rows_;
  std::vector<Difference> differences_;
};

Timed ContactBench::time(const std::function<void()>& call, const std::function<void()>& prepare) const {
  std::vector<double> us, processor_us;
  double sum = 0;
  for (int run = -1; run < runs_ && (run < 3 || sum < 2e6); ++run) {
    if (prepare) prepare();
    const std::clock_t before = std::clock();
    const Stopwatch watch;
    call();
    const double taken = watch.us();
    if (run < 0) continue;
    us.push_back(taken);
    processor_us.push_back(1e6 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
    sum += taken;
  }
  return {summarize(us).median, summarize(processor_us).median};
}

IdPairs self_pairs(const Model& model) {
  IdPairs pairs;
  visit_self_intersections(model, [&](const TrianglePair& p) { return pairs.emplace_back(p.a, p.b), true; });
  sort_pairs(pairs);
  return pairs;
}

IdPairs self_pairs_within(const Model& model, double margin) {
  IdPairs pairs;
  visit_self_contacts(model, margin,
                      [&](const Contact& c) { return pairs.emplace_back(c.triangle_a, c.triangle_b), true; });
  sort_pairs(pairs);
  return pairs;
}

IdPairs pairs_within(const Placed& a, const Placed& b, double margin) {
  IdPairs pairs;
  visit_contacts(a, b, margin, [&](const Contact& c) { return pairs.emplace_back(c.triangle_a, c.triangle_b), true; });
  sort_pairs(pairs);
  return pairs;
}

void ContactBench::one_mesh(const std::string& name, const Mesh& mesh) {
  fmt::print(stderr, "{}\n", name);
  const double margin = margin_of_size * diagonal(mesh);
  const std::vector<Vec3> there = waved(mesh);
  Model model(mesh);
  const IdPairs met = self_pairs(model), close = self_pairs_within(model, margin);
  checker_.check(self_collide(model).collision == !met.empty(), "{}: self_collide and self_intersections differ", name);
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

/// The same frames with pairs of elements, which is what IPC's are.
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

int run(const Settings& settings) {
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  report_machine(settings.options);
  ContactBench bench(settings);
  bench.one_mesh("cloth", load_mesh(settings.meshes / "cloth_ball_92.ply").value());
  bench.one_mesh("bunny", load_mesh(settings.meshes / "stanford-bunny.obj").value());
  bench.one_mesh("armadillo", load_mesh(settings.meshes / "armadillo.obj").value());
  bench.elements("cloth", load_mesh(settings.meshes / "cloth_ball_92.ply").value());
  bench.elements("bunny", load_mesh(settings.meshes / "stanford-bunny.obj").value());
  bench.elements("armadillo", load_mesh(settings.meshes / "armadillo.obj").value());
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
  return bench.report();
}

}  // namespace
}  // namespace limber::bench

int main(int argc, char** argv) {
  using namespace limber::bench;
  CLI::App app{"What do pairs of triangles that intersect or are close cost, next to other libraries?"};
  Settings settings;
  app.add_option("--meshes", settings.meshes, "folder with cloth_ball_92.ply, stanford-bunny.obj and armadillo.obj")
      ->required();
  app.add_option("--out", settings.options.out, "folder for results; default: only the console");
  app.add_option("--peers", settings.peers, "contact_peers.csv, written by peers.py; default: no other library");
  app.add_option("--answers", settings.answers, "folder of answers and meshes written by peers.py; default: none");
  app.add_flag("--quick", settings.options.quick, "few runs: shows that everything works");
  CLI11_PARSE(app, argc, argv);
  try {
    if (!settings.options.out.empty()) std::filesystem::create_directories(settings.options.out);
    return run(settings);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
