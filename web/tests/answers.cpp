// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Writes what is asked of the native library and what it answers, to the bit, for answers.test.js to ask WebAssembly
// the same. The format is private to the two: blocks of 8 bytes, see Writer; each question begins with its number.
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/io.h"
#include "limber/model.h"
#include "limber/points.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"

namespace {

using namespace limber;
using scenes::Rng;

class Writer {
 public:
  void number(double x) { append(&x, sizeof(x)); }
  void vec(const Vec3& v) { number(v.x), number(v.y), number(v.z); }
  /// The number of bytes, then the bytes, filled up with zeros.
  template <typename T>
  void array(std::span<const T> values) {
    number(static_cast<double>(values.size_bytes()));
    append(values.data(), values.size_bytes());
    bytes_.resize((bytes_.size() + 7) / 8 * 8);
  }
  template <typename T>
  void array(const std::vector<T>& values) {
    array(std::span<const T>(values));
  }
  void text(const std::string& text) { array(std::span<const char>(text)); }
  const std::vector<char>& bytes() const { return bytes_; }

 private:
  void append(const void* from, std::size_t size) {
    const auto* const first = static_cast<const char*>(from);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  std::vector<char> bytes_;
};

/// Questions, by the numbers that answers.test.js knows them by.
enum class Question {
  model,
  move_all,
  move_vertices,
  commit,
  distance,
  collide,
  within,
  contacts,
  intersections,
  closest_pairs,
  self_collide,
  self_distance,
  self_contacts,
  self_intersections,
  self_closest_pairs,
  closest_points,
  signed_distances,
  tree,
  file,
  error
};

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Asks and writes.
class Recorder {
 public:
  std::size_t add(const Mesh& mesh, bool is_float32 = false) {
    begin(Question::model);
    const PositionsView written = positions(mesh.positions(), is_float32);
    out_.array(mesh.triangles());
    models_.push_back(Model(Mesh::create(written, mesh.triangles()).value()));
    caches_.emplace_back();
    return models_.size() - 1;
  }

  void move_all(std::size_t m, const std::vector<Vec3>& to, bool is_float32) {
    begin(Question::move_all), id(m);
    models_[m].move_all(positions(to, is_float32)).value();
    commit(m);
  }
  void move_vertices(std::size_t m, const scenes::VertexMoves& moves, bool is_float32) {
    begin(Question::move_vertices), id(m);
    const PositionsView written = positions(moves.positions, is_float32);
    out_.array(moves.ids);
    models_[m].move_vertices(moves.ids, written).value();
    commit(m);
  }

  void distance(std::size_t a, std::size_t b, const Transform& pose, DistanceOptions options, std::uint64_t max_steps,
                bool uses_cache) {
    begin(Question::distance), pair(a, b, pose);
    out_.number(options.relative_error), out_.number(options.absolute_error), out_.number(options.max_distance);
    budget(max_steps, uses_cache);
    options.cache = uses_cache ? &caches_[a] : nullptr, options.budget = {.max_steps = max_steps};
    write(limber::distance(Placed(models_[a]), Placed(models_[b], pose), options));
  }
  void collide(std::size_t a, std::size_t b, const Transform& pose, std::uint64_t max_steps, bool uses_cache) {
    begin(Question::collide), pair(a, b, pose), budget(max_steps, uses_cache);
    const QueryBudget budget{.max_steps = max_steps};
    const Placed of_a(models_[a]), of_b(models_[b], pose);
    write(limber::collide(of_a, of_b, {.cache = uses_cache ? &caches_[a] : nullptr, .budget = budget}));
  }
  void within(std::size_t a, std::size_t b, const Transform& pose, double max_distance) {
    begin(Question::within), pair(a, b, pose), out_.number(max_distance);
    write(limber::within(Placed(models_[a]), Placed(models_[b], pose), max_distance));
  }

  void contacts(std::size_t a, std::size_t b, const Transform& pose, double margin) {
    begin(Question::contacts), pair(a, b, pose), out_.number(margin);
    std::vector<Contact> found;
    const auto keep = [&](const Contact& contact) { return found.push_back(contact), true; };
    write(found, visit_contacts(Placed(models_[a]), Placed(models_[b], pose), margin, keep).stats);
  }
  void intersections(std::size_t a, std::size_t b, const Transform& pose) {
    begin(Question::intersections), pair(a, b, pose);
    std::vector<TrianglePair> found;
    const auto keep = [&](const TrianglePair& one) { return found.push_back(one), true; };
    const PairCount count = visit_intersections(Placed(models_[a]), Placed(models_[b], pose), keep);
    out_.array(found), write(count.stats);
  }
  void closest_pairs(std::size_t a, std::size_t b, const Transform& pose, std::size_t most) {
    begin(Question::closest_pairs), pair(a, b, pose), id(most);
    std::vector<Contact> found(most);
    const PairCount count = limber::closest_pairs(Placed(models_[a]), Placed(models_[b], pose), found);
    found.resize(count.count);
    write(found, count.stats);
  }

  /// All questions about a model and itself.
  void of_itself(std::size_t m, double margin, std::uint32_t ring_edges) {
    begin(Question::self_collide), id(m);
    write(self_collide(models_[m]));
    const NeighborRings rings(models_[m].mesh(), ring_edges);
    begin(Question::self_distance), id(m), id(ring_edges);
    write(self_distance(models_[m], {.filter = rings}));
    begin(Question::self_contacts), id(m), out_.number(margin), id(ring_edges);
    std::vector<Contact> found;
    const auto keep = [&](const Contact& contact) { return found.push_back(contact), true; };
    write(found, visit_self_contacts(models_[m], margin, keep, {.filter = rings}).stats);
    begin(Question::self_intersections), id(m);
    std::vector<TrianglePair> pairs;
    const auto keep_pair = [&](const TrianglePair& one) { return pairs.push_back(one), true; };
    const PairCount count = visit_self_intersections(models_[m], keep_pair);
    out_.array(pairs), write(count.stats);
    begin(Question::self_closest_pairs), id(m), id(10);
    found.resize(10);
    const PairCount closest = self_closest_pairs(models_[m], found);
    found.resize(closest.count);
    write(found, closest.stats);
  }

  void closest_points(std::size_t m, const Transform& pose, const std::vector<Vec3>& points, double max_distance) {
    begin(Question::closest_points), id(m), matrix(pose), out_.array(points), out_.number(max_distance);
    std::vector<PointResult> results(points.size());
    limber::closest_points(Placed(models_[m], pose), points, results, {max_distance});
    for (const PointResult& result : results) write(result.closest, false);
  }
  void signed_distances(std::size_t m, const Transform& pose, const std::vector<Vec3>& points) {
    begin(Question::signed_distances), id(m), matrix(pose), out_.array(points);
    std::vector<SignedDistance> results(points.size());
    ClosedSurface::create(models_[m]).value().signed_distances(points, results, pose);
    for (const SignedDistance& result : results) write(result.closest, result.is_inside);
  }

  /// Bounds and statistics.
  void tree(std::size_t m) {
    begin(Question::tree), id(m);
    const Box box = models_[m].bounding_box();
    out_.vec(box.low), out_.vec(box.high);
    const MaintenanceStats stats = models_[m].maintenance_stats();
    for (const double x :
         {static_cast<double>(stats.moved_vertices), static_cast<double>(stats.refits),
          static_cast<double>(stats.whole_passes), static_cast<double>(stats.rebuilt_triangles), stats.rebuild_us}) {
      out_.number(x);
    }
    const std::uint32_t levels = models_[m].tree_stats().levels;
    out_.number(levels);
    for (std::uint32_t level = 0; level < levels; ++level) out_.array(models_[m].node_spheres(level));
  }

  void file(const std::string& name, const std::string& bytes) {
    begin(Question::file), out_.text(name), out_.text(bytes);
    const Result<MeshFile> read = read_mesh_bytes(std::as_bytes(std::span(bytes)), name);
    out_.number(read ? 1 : 0);
    if (!read) return error(read.error());
    out_.array(read->mesh.positions()), out_.array(read->mesh.triangles()), out_.array(read->face_of_triangle);
    out_.number(static_cast<double>(read->face_count));
  }

  /// Positions that a move refuses.
  void refused(std::size_t m, const std::vector<Vec3>& to) {
    begin(Question::error), id(m), positions(to, false);
    error(models_[m].move_all(to).error());
  }

  const Writer& out() const { return out_; }

 private:
  void begin(Question question) { out_.number(static_cast<double>(question)); }
  void id(std::size_t i) { out_.number(static_cast<double>(i)); }
  void matrix(const Transform& pose) {
    for (const double x : matrix_of(pose, MatrixOrder::column_major)) out_.number(x);
  }
  void pair(std::size_t a, std::size_t b, const Transform& pose) { id(a), id(b), matrix(pose); }
  void budget(std::uint64_t max_steps, bool uses_cache) {
    const bool is_limited = max_steps < std::numeric_limits<std::uint64_t>::max();
    out_.number(is_limited ? static_cast<double>(max_steps) : infinity), out_.number(uses_cache ? 1 : 0);
  }
  void commit(std::size_t m) {
    begin(Question::commit), id(m);
    models_[m].commit();
  }

  /// Writes positions, and gives them as they are written.
  PositionsView positions(const std::vector<Vec3>& positions, bool is_float32) {
    out_.number(is_float32 ? 1 : 0);
    float64_.clear(), float32_.clear();
    for (const Vec3& p : positions) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        float64_.push_back(p[axis]), float32_.push_back(static_cast<float>(p[axis]));
      }
    }
    if (is_float32) return out_.array(float32_), PositionsView::packed(float32_);
    return out_.array(float64_), PositionsView::packed(float64_);
  }

  void write(const QueryStats& stats) {
    out_.number(static_cast<double>(stats.node_tests)), out_.number(static_cast<double>(stats.triangle_tests));
  }
  void write(const std::optional<Witness>& witness) {
    out_.number(witness ? 1 : 0);
    if (!witness) return;
    out_.vec(witness->point_a), out_.vec(witness->point_b), id(witness->triangle_a), id(witness->triangle_b);
  }
  void write(const DistanceResult& r) {
    out_.number(r.lower), out_.number(r.upper), id(static_cast<std::size_t>(r.status));
    id(static_cast<std::size_t>(r.stopped_by)), write(r.witness), write(r.stats);
  }
  void write(const CollideResult& r) {
    id(static_cast<std::size_t>(r.answer)), id(static_cast<std::size_t>(r.stopped_by)), write(r.witness);
    write(r.stats);
  }
  void write(const Feature& feature) { id(static_cast<std::size_t>(feature.kind)), id(feature.index); }
  void write(const std::vector<Contact>& contacts, const QueryStats& stats) {
    id(contacts.size());
    for (const Contact& c : contacts) {
      out_.number(c.distance), out_.number(c.depth), out_.vec(c.point_a), out_.vec(c.point_b), out_.vec(c.normal);
      id(c.triangle_a), id(c.triangle_b), write(c.feature_a), write(c.feature_b);
      id(static_cast<std::size_t>(c.normal_side));
    }
    write(stats);
  }
  void write(const std::optional<SurfacePoint>& closest, bool is_inside) {
    out_.number(closest ? 1 : 0), out_.number(is_inside ? 1 : 0);
    if (!closest) return;
    out_.number(closest->distance), out_.vec(closest->position), id(closest->triangle);
    for (const double weight : closest->barycentric) out_.number(weight);
    write(closest->feature);
  }
  void error(const Error& error) {
    id(static_cast<std::size_t>(error.code)), out_.text(error.text);
    out_.number(error.where ? static_cast<double>(*error.where) : -1);
  }

  std::vector<Model> models_;
  std::vector<QueryCache> caches_;
  std::vector<double> float64_;
  std::vector<float> float32_;
  Writer out_;
};

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

std::vector<Vec3> points_around(Rng& rng, std::size_t count, double size) {
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
  return points;
}

Transform random_pose(Rng& rng, double distance) {
  const Mat3 rotation = scenes::random_rotation(rng);
  return {rotation, points_around(rng, 1, distance)[0]};
}

/// Two rigid models in many poses, every query.
void ask_of_poses(Recorder& record, std::size_t a, std::size_t b, std::size_t poses, double distance, Rng& rng) {
  for (std::size_t i = 0; i < poses; ++i) {
    const Transform pose = random_pose(rng, distance);
    record.distance(a, b, pose, {}, unlimited, false);
    record.distance(a, b, pose, {.relative_error = 0.1}, unlimited, true);
    record.distance(a, b, pose, {.absolute_error = 0.05 * distance, .max_distance = distance}, unlimited, false);
    record.distance(a, b, pose, {}, 1 + rng.below(40), false);
    record.collide(a, b, pose, unlimited, false);
    record.collide(a, b, pose, 1 + rng.below(10), true);
    record.within(a, b, pose, 0.2 * distance);
    if (i % 4 != 0) continue;
    record.intersections(a, b, pose);
    record.contacts(a, b, pose, 0.02);
    record.closest_pairs(a, b, pose, 20);
  }
}

/// A deforming mesh: moves, commits, queries against another model and of itself.
void ask_of_motion(Recorder& record, const scenes::Motion& motion, std::size_t other, int frames, double step,
                   Rng& rng) {
  const std::size_t m = record.add(motion.mesh, false);
  for (int frame = 1; frame <= frames; ++frame) {
    record.move_all(m, motion.positions(step * frame), frame % 2 == 0);
    const Transform pose = random_pose(rng, 1);
    record.distance(m, other, pose, {}, unlimited, true);
    record.contacts(m, other, pose, 0.01);
    if (frame % 5 != 0) continue;
    record.tree(m);
    record.of_itself(m, 0.002, static_cast<std::uint32_t>(frame / 5 % 3));
  }
}

std::string obj_of(const Mesh& mesh, int digits) {
  std::string text = "# a comment\n";
  char line[160];
  for (const Vec3& p : mesh.positions()) {
    std::snprintf(line, sizeof(line), "v %.*g %.*e %.*g\n", digits, p.x, digits, p.y, digits, p.z);
    text += line;
  }
  for (const Corners& c : mesh.triangles()) {
    std::snprintf(line, sizeof(line), "f %u/1 %u/2/3 %u\n", c[0] + 1, c[1] + 1, c[2] + 1);
    text += line;
  }
  return text;
}

std::string binary_stl_of(const Mesh& mesh) {
  std::string bytes(80, ' ');
  const auto append = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  append(static_cast<std::uint32_t>(mesh.triangles().size()));
  for (const Corners& c : mesh.triangles()) {
    for (int i = 0; i < 3; ++i) append(0.0F);
    for (const VertexId v : c) {
      const Vec3& p = mesh.positions()[v];
      for (const double x : {p.x, p.y, p.z}) append(static_cast<float>(x));
    }
    append(std::uint16_t{0});
  }
  return bytes;
}

void ask_of_files(Recorder& record, Rng& rng) {
  const Mesh soup = scenes::random_soup(rng, 300, 0.3);
  for (const int digits : {1, 5, 9, 16, 17, 19, 25, 40}) record.file("soup.obj", obj_of(soup, digits));
  record.file("soup.STL", binary_stl_of(soup));
  record.file("numbers.obj",
              "v 1e308 -2.5E-308 4.9e-324\nv 1e-400 -1e-400 +7\nv .5 5. 0.1e1\nv 9007199254740993 "
              "0.000000000000000000000000000000000000000000001e45 1e22\nf 1 2 3\nf 3 2 4\n");
  record.file("sheet.ply",
              "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
              "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0.1\n1 1 0.3\n0 1 0\n"
              "4 0 1 2 3\n");
  record.file("square.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  for (const char* coordinate :
       {"nan", "inf", "-Infinity", "1e999", "nan(1)", "nan(", "0x10", "1e", "--1", "1.2.3", ""})
    record.file("bad.obj", std::string("v 0 0 ") + coordinate + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  record.file("empty.obj", "");
  record.file("none.obj", "v 0 0 0\n");
  record.file("far.obj", "v 0 0 0\nf 1 2 3\n");
  record.file("mesh.xyz", "0 0 0\n");
  record.file("broken.ply", "ply\nformat");
}

void ask(Recorder& record) {
  Rng rng(20240611);
  const std::size_t ball = record.add(scenes::ball(24, 16));
  const std::size_t sheet = record.add(scenes::wave_sheet(40, 40, 3), true);
  const std::size_t soup = record.add(scenes::random_soup(rng, 800, 0.2));
  const std::size_t lattice = record.add(scenes::lattice_soup(rng, 200, 4));
  ask_of_poses(record, ball, sheet, 60, 4, rng);
  ask_of_poses(record, soup, ball, 60, 2, rng);
  ask_of_poses(record, lattice, soup, 40, 6, rng);
  for (int i = 0; i < 30; ++i) {  // exact contacts and near misses
    const Transform shift{Mat3{}, {static_cast<double>(i % 4), static_cast<double>(i / 4 % 4), 1}};
    record.distance(lattice, lattice, shift, {}, unlimited, false);
    record.intersections(lattice, lattice, shift);
    record.contacts(lattice, lattice, shift, 0.5);
  }
  ask_of_motion(record, scenes::waving_sheet(50, 50), ball, 40, 1, rng);
  ask_of_motion(record, scenes::crumpling_cloth(30), ball, 40, 6, rng);
  ask_of_motion(record, scenes::twisting_bar(5), soup, 60, 4, rng);
  ask_of_motion(record, scenes::shuffled_soup(1500), ball, 60, 20, rng);

  const std::size_t dented = record.add(scenes::thesis_sheet());
  std::vector<Vec3> positions = scenes::thesis_sheet().positions();
  for (int i = 0; i < 60; ++i) {
    const scenes::VertexMoves moves = scenes::dent_moves(scenes::random_dent(rng), positions);
    for (std::size_t k = 0; k < moves.ids.size(); ++k) positions[moves.ids[k]] = moves.positions[k];
    record.move_vertices(dented, moves, i % 3 == 0);
    record.distance(dented, ball, random_pose(rng, 30), {}, unlimited, true);
  }
  record.tree(dented);

  for (int i = 0; i < 5; ++i) {
    const Transform pose = random_pose(rng, 2);
    record.closest_points(ball, pose, points_around(rng, 200, 4), i % 2 == 0 ? infinity : 1);
    record.closest_points(soup, pose, points_around(rng, 200, 50), infinity);
    record.signed_distances(ball, pose, points_around(rng, 200, 2));
  }

  std::vector<Vec3> bad = positions;
  bad[77].y = std::numeric_limits<double>::quiet_NaN();
  record.refused(dented, bad);
  bad.resize(50);
  record.refused(dented, bad);
  ask_of_files(record, rng);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: limber_web_answers FILE\n";
    return 2;
  }
  Recorder record;
  ask(record);
  const std::vector<char>& bytes = record.out().bytes();
  std::ofstream file(argv[1], std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file.flush() ? 0 : 1;
}
