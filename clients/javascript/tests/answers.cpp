// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Writes what is asked of the native library and what it answers, for answers.test.js to ask WebAssembly the same: a
// line of JSON for each call, with the names of the JavaScript package.
#include <deque>
#include <fstream>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "json_of.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"

namespace {

using namespace limber;
using namespace limber::web;
using scenes::Rng;

/// What is asked about is a model, by its place; or a shape, by this and its place.
constexpr std::size_t first_shape = 1000;

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// How a query of two bodies is asked beyond its own options. Each first body has a cache.
struct Asked {
  std::uint64_t max_steps = unlimited;
  bool uses_cache = false;
};

json with_budget(json options, std::uint64_t max_steps) {
  if (max_steps < unlimited) options["budget"] = {{"maxSteps", max_steps}};
  return options;
}

/// Asks and writes.
class Recorder {
 public:
  explicit Recorder(const std::string& path) : out_(path) {}

  // --- models and shapes ---

  std::size_t add(const Mesh& mesh, bool is_float32 = false) {
    const std::vector<Vec3> positions = rounded(mesh.positions(), is_float32);
    json faces = json::array();
    for (const Corners& corners : mesh.triangles()) {
      for (const VertexId v : corners) faces.push_back(v);
    }
    write("Model", {}, {numbers_of(positions, is_float32), uint32s(faces)});
    models_.push_back(Model(Mesh::create(positions, mesh.triangles()).value()));
    caches_.emplace_back();
    moving_.emplace_back(models_.back());
    return models_.size() - 1;
  }

  /// A shape that a factory of that name makes of these arguments.
  std::size_t add(const char* factory, const std::vector<json>& args, Shape shape) {
    std::vector<json> all{factory};
    all.insert(all.end(), args.begin(), args.end());
    write("Shape", {}, all);
    shapes_.push_back(std::move(shape));
    return first_shape + shapes_.size() - 1;
  }

  void move_all(std::size_t m, const std::vector<Vec3>& to, bool is_float32) {
    const std::vector<Vec3> positions = rounded(to, is_float32);
    write("moveAll", {m}, {numbers_of(positions, is_float32)});
    models_[m].move_all(positions).value();
    models_[m].commit();
  }
  void move_vertices(std::size_t m, const scenes::VertexMoves& moves, bool is_float32) {
    const std::vector<Vec3> positions = rounded(moves.positions, is_float32);
    write("moveVertices", {m}, {uint32s(moves.ids), numbers_of(positions, is_float32)});
    models_[m].move_vertices(moves.ids, positions).value();
    models_[m].commit();
  }
  void rebuild(std::size_t m) {
    write("rebuild", {m}, {});
    models_[m].rebuild();
  }

  std::vector<Vec3> positions(std::size_t m) const {
    const auto all = models_[m].mesh().positions();
    return {all.begin(), all.end()};
  }

  // --- two bodies ---

  void distance(std::size_t a, std::size_t b, const Transform& pose, DistanceOptions options, Asked asked = {}) {
    options.cache = cache(a, asked), options.budget = {.max_steps = asked.max_steps};
    json given = options_of(pose, asked);
    given["relativeError"] = options.relative_error, given["absoluteError"] = options.absolute_error;
    given["maxDistance"] = of(options.max_distance);
    write("distance", {a, b}, {}, given, of(limber::distance(placed(a), placed(b, pose), options)));
  }
  void collide(std::size_t a, std::size_t b, const Transform& pose, Asked asked = {}) {
    const QueryOptions options{.cache = cache(a, asked), .budget = {.max_steps = asked.max_steps}};
    write("collide", {a, b}, {}, options_of(pose, asked), of(limber::collide(placed(a), placed(b, pose), options)));
  }
  void within(std::size_t a, std::size_t b, const Transform& pose, double max_distance) {
    const CollideResult result = limber::within(placed(a), placed(b, pose), max_distance);
    write("within", {a, b}, {max_distance}, options_of(pose), of(result));
  }
  void contacts(std::size_t a, std::size_t b, const Transform& pose, double margin) {
    const auto visit = [&](ContactVisitor keep) { return visit_contacts(placed(a), placed(b, pose), margin, keep); };
    write("contacts", {a, b}, {margin}, options_of(pose), contacts_of(visit));
  }

  /// Bodies that do not turn: sines have other roundings in other C libraries.
  void rigid_impact(std::size_t a, std::size_t b, const Transform& start, const Vec3& to, PathOptions options,
                    Asked asked = {}) {
    const Transform end{start.rotation, to};
    options.cache = cache(a, asked), options.budget = {.max_steps = asked.max_steps};
    json given{{"motions", {{of(start), of(end)}, {of(Transform{})}}},
               {"maxTime", options.max_time},
               {"minSeparation", options.min_separation},
               {"cache", asked.uses_cache}};
    if (options.distance_error) given["distanceError"] = *options.distance_error;
    const PathImpact first = limber::time_of_impact(body(a), RigidMotion(start, end), body(b), {}, options);
    write("rigidTimeOfImpact", {a, b}, {}, with_budget(given, asked.max_steps), of(first));
  }

  // --- one model ---

  /// All questions about a model and itself.
  void of_itself(std::size_t m, double margin, std::uint32_t ring_edges) {
    const Model& model = models_[m];
    const NeighborRings rings(model.mesh(), ring_edges);
    const json ringed{{"rings", ring_edges}};
    write("selfCollide", {m}, {}, {}, of(self_collide(model)));
    write("selfDistance", {m}, {}, ringed, of(self_distance(model, {.filter = rings})));
    for (const double most : {margin, 0.0}) {
      const auto visit = [&](ContactVisitor keep) { return visit_self_contacts(model, most, keep, {.filter = rings}); };
      write("selfContacts", {m}, {most}, ringed, contacts_of(visit));
    }
  }

  void points(std::size_t m, const Transform& pose, const std::vector<Vec3>& points, double max_distance,
              bool is_closed) {
    const json options{{"pose", of(pose)}, {"maxDistance", of(max_distance)}};
    std::vector<PointResult> closest(points.size());
    closest_point_many({models_[m], pose}, points, closest, {max_distance});
    write("closestPointMany", {m}, {numbers_of(points)}, options, each(closest));
    if (!is_closed) return;
    std::vector<SignedDistance> signed_distances(points.size());
    ClosedSurface::create(models_[m]).value().signed_distance_many(points, signed_distances, pose, {max_distance});
    write("signedDistanceMany", {m}, {numbers_of(points)}, options, each(signed_distances));
  }

  // --- moving models ---

  void set_motion(std::size_t m, const std::vector<Vec3>& to, const Transform& start, const Transform& end,
                  bool is_float32) {
    const std::vector<Vec3> positions = rounded(to, is_float32);
    write("setMotion", {m}, {numbers_of(positions, is_float32)}, {{"startPose", of(start)}, {"endPose", of(end)}});
    moving_[m].set_motion(positions, start, end).value();
  }
  /// Of two models, and of the first with itself.
  void impacts(std::size_t a, std::size_t b, ImpactOptions options, std::uint64_t max_steps = unlimited) {
    options.budget = {.max_steps = max_steps};
    const json given{{"maxTime", options.max_time},
                     {"timeError", options.time_error},
                     {"minSeparation", options.min_separation},
                     {"separationFraction", options.separation_fraction},
                     {"ignoreCrossings", options.ignore_crossings},
                     {"anyContact", options.any_contact}};
    const json asked = with_budget(given, max_steps);
    write("timeOfImpact", {a, b}, {}, asked, of(time_of_impact(moving_[a], moving_[b], options)));
    write("selfTimeOfImpact", {a}, {}, asked, of(self_time_of_impact(moving_[a], options)));
  }

  // --- one scene ---

  void add_object(std::size_t m, const Transform& pose) {
    write("sceneAdd", {m}, {of(pose)}, {}, scene_.add(placed(m, pose)));
  }
  void remove_object(ObjectId id) {
    scene_.remove(id);
    write("sceneCall", {}, {"remove", id});
  }
  void set_pose(ObjectId id, const Transform& pose) {
    scene_.set_pose(id, pose);
    write("sceneCall", {}, {"setPose", id, of(pose)});
  }
  void commit_scene() {
    scene_.commit();
    write("sceneCall", {}, {"commit"});
  }

  /// All questions about pairs of objects within a margin, and about the closest ones but for a pair.
  void of_scene(double margin, const ObjectPair& ignored, std::uint64_t max_steps) {
    std::vector<ObjectPair> pairs;
    scene_.visit_candidate_pairs(margin, [&](const ObjectPair& pair) { return pairs.push_back(pair), true; });
    json ids = json::array();
    for (const ObjectPair& pair : pairs) ids.push_back(pair.a), ids.push_back(pair.b);
    write("sceneCall", {}, {"candidatePairs", margin}, {}, ids);
    const QueryBudget budget{.max_steps = max_steps};
    json given = with_budget(json::object(), max_steps);
    std::vector<CollideResult> answers(pairs.size());
    scene_.collide(pairs, answers, {.budget = budget});
    write("sceneCall", {}, {"collide", uint32s(ids)}, given, each(answers));
    scene_.within(pairs, 0.5 * margin, answers, {.budget = budget});
    write("sceneCall", {}, {"within", uint32s(ids), 0.5 * margin}, given, each(answers));
    std::vector<DistanceResult> distances(pairs.size());
    scene_.distance(pairs, distances, {.distance = {.relative_error = 0.01, .budget = budget}});
    given["relativeError"] = 0.01;
    write("sceneCall", {}, {"distance", uint32s(ids)}, given, each(distances));
    ObjectPairMatrix counts(scene_.id_bound());
    counts.set(ignored.a, ignored.b, false);
    given["ignoredPairs"] = {ignored.a, ignored.b};
    write("sceneCall", {}, {"closestObjects"}, given,
          of(scene_.closest_objects({.distance = {.relative_error = 0.01, .budget = budget}, .filter = counts})));
  }

  bool close() { return static_cast<bool>(out_.flush()); }

 private:
  void write(const char* call, const std::vector<std::size_t>& bodies, const std::vector<json>& args,
             const json& options = {}, const json& answer = {}) {
    out_ << json{{"call", call}, {"of", bodies}, {"args", args}, {"options", options}, {"answer", answer}} << '\n';
  }
  Body body(std::size_t i) const { return i < first_shape ? Body(models_[i]) : Body(shapes_[i - first_shape]); }
  Placed placed(std::size_t i, const Transform& pose = {}) const { return {body(i), pose}; }
  QueryCache* cache(std::size_t a, Asked asked) { return asked.uses_cache ? &caches_[a] : nullptr; }
  static json options_of(const Transform& pose, Asked asked = {}) {
    return with_budget({{"poseA", nullptr}, {"poseB", of(pose)}, {"cache", asked.uses_cache}}, asked.max_steps);
  }

  std::ofstream out_;
  std::deque<Model> models_;  // stay where they are, as moving models refer to them
  std::deque<Shape> shapes_;
  std::deque<MovingModel> moving_;
  std::vector<QueryCache> caches_;
  Scene scene_;
};

std::vector<Vec3> points_around(Rng& rng, std::size_t count, double size) {
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
  return points;
}

Transform random_pose(Rng& rng, double distance) {
  const Mat3 rotation = scenes::random_rotation(rng);
  return {rotation, points_around(rng, 1, distance)[0]};
}

/// Two rigid bodies in many poses, every query.
void ask_of_poses(Recorder& record, std::size_t a, std::size_t b, std::size_t poses, double distance, Rng& rng) {
  const bool is_model = a < first_shape;  // models alone have caches here
  for (std::size_t i = 0; i < poses; ++i) {
    const Transform pose = random_pose(rng, distance);
    const Vec3 to = points_around(rng, 1, distance)[0];
    record.distance(a, b, pose, {});
    record.distance(a, b, pose, {.relative_error = 0.1}, {.uses_cache = is_model});
    record.distance(a, b, pose, {.absolute_error = 0.05 * distance, .max_distance = distance});
    record.distance(a, b, pose, {}, {.max_steps = 1 + rng.below(40)});
    record.collide(a, b, pose);
    record.collide(a, b, pose, {.max_steps = 1 + rng.below(10), .uses_cache = is_model});
    record.within(a, b, pose, 0.2 * distance);
    record.rigid_impact(a, b, pose, to, {});
    record.rigid_impact(a, b, pose, to, {.max_time = 0.75, .min_separation = 0.3, .distance_error = 0.01},
                        {.max_steps = 1 + rng.below(12), .uses_cache = is_model});
    if (i % 4 != 0) continue;
    record.contacts(a, b, pose, 0);
    record.contacts(a, b, pose, 0.02);
  }
}

/// A deforming mesh next to a ball, which moves too, and next to itself.
void ask_of_motion(Recorder& record, const scenes::Motion& motion, std::size_t ball, int frames, double step,
                   Rng& rng) {
  const std::size_t m = record.add(motion.mesh, false);
  for (int frame = 1; frame <= frames; ++frame) {
    const std::vector<Vec3> positions = motion.positions(step * frame);
    if (frame % 4 == 0) {
      const Transform start = random_pose(rng, 1), end{start.rotation, points_around(rng, 1, 2)[0]};
      record.set_motion(m, positions, start, frame % 3 == 0 ? random_pose(rng, 2) : end, frame % 8 == 0);
      record.set_motion(ball, record.positions(ball), {}, {Mat3{}, points_around(rng, 1, 1)[0]}, false);
      const double separation = 0.01 * rng.uniform();
      record.impacts(m, ball, {.time_error = 1e-6});
      record.impacts(m, ball, {.max_time = 0.7, .ignore_crossings = true});
      record.impacts(m, ball, {.min_separation = separation, .separation_fraction = 0.5, .ignore_crossings = true});
      record.impacts(m, ball, {.ignore_crossings = true, .any_contact = true});
      record.impacts(m, ball, {.ignore_crossings = true}, 1 + rng.below(60));
    }
    record.move_all(m, positions, frame % 2 == 0);
    const Transform pose = random_pose(rng, 1);
    record.distance(m, ball, pose, {}, {.uses_cache = true});
    record.contacts(m, ball, pose, 0.01);
    if (frame % 5 == 0) record.of_itself(m, 0.002, static_cast<std::uint32_t>(frame / 5 % 3));
  }
}

std::vector<std::size_t> add_shapes(Recorder& record, Rng& rng) {
  const Vec3 start{-0.5, 0.25, 0}, end{0.75, 0, 0.5}, extents{0.5, 0.75, 0.25};
  const std::vector<Vec3> rough = rounded(points_around(rng, 60, 1), true);
  return {record.add("sphere", {0.375}, Shape::sphere(0.375)),
          record.add("capsule", {of(start), of(end), 0.1}, Shape::capsule(start, end, 0.1)),
          record.add("box", {of(extents), 0.3}, Shape::box(extents, 0.3)),
          record.add("convexHull", {numbers_of(rough, true), 0.2}, Shape::convex_hull(rough, 0.2))};
}

/// Objects that move, come and go.
void ask_of_scenes(Recorder& record, const std::vector<std::size_t>& bodies, Rng& rng) {
  constexpr ObjectId count = 24;
  for (ObjectId id = 0; id < count; ++id) record.add_object(bodies[id % bodies.size()], random_pose(rng, 6));
  for (int frame = 0; frame < 12; ++frame) {
    for (ObjectId id = 0; id < count; ++id) record.set_pose(id, random_pose(rng, frame % 2 == 0 ? 6 : 20));
    if (frame % 4 == 3) {
      record.remove_object(5);
      record.add_object(bodies[static_cast<std::size_t>(frame) % bodies.size()], random_pose(rng, 6));
    }
    record.commit_scene();
    const ObjectPair ignored{static_cast<ObjectId>(frame), 20};
    record.of_scene(1, ignored, frame % 3 == 1 ? 1 + rng.below(20) : unlimited);
  }
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
    record.distance(lattice, lattice, shift, {});
    record.contacts(lattice, lattice, shift, 0.5);
  }
  ask_of_motion(record, scenes::waving_sheet(40, 40), ball, 40, 1, rng);
  ask_of_motion(record, scenes::crumpling_cloth(30), ball, 40, 6, rng);
  ask_of_motion(record, scenes::twisting_bar(5), ball, 60, 4, rng);
  ask_of_motion(record, scenes::shuffled_soup(600), ball, 60, 20, rng);

  const std::size_t dented = record.add(scenes::thesis_sheet());
  std::vector<Vec3> positions = scenes::thesis_sheet().positions();
  for (int i = 0; i < 60; ++i) {
    const scenes::VertexMoves moves = scenes::dent_moves(scenes::random_dent(rng), positions);
    for (std::size_t k = 0; k < moves.ids.size(); ++k) positions[moves.ids[k]] = moves.positions[k];
    record.move_vertices(dented, moves, i % 3 == 0);
    if (i % 20 == 10) record.rebuild(dented);
    record.distance(dented, ball, random_pose(rng, 30), {}, {.uses_cache = true});
  }
  for (int i = 0; i < 5; ++i) {
    const double max_distance = i % 2 == 0 ? infinity : 1;
    record.points(ball, random_pose(rng, 2), points_around(rng, 200, 4), max_distance, true);
    record.points(soup, random_pose(rng, 2), points_around(rng, 200, 50), infinity, false);
  }

  std::vector<std::size_t> bodies = add_shapes(record, rng);
  for (const std::size_t a : bodies) {
    for (const std::size_t b : bodies) ask_of_poses(record, a, b, 1, 3, rng);
    ask_of_poses(record, ball, a, 8, 3, rng);
  }
  bodies.insert(bodies.end(), {ball, soup});
  ask_of_scenes(record, bodies, rng);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: limber_web_answers FILE\n";
    return 2;
  }
  Recorder record(argv[1]);
  ask(record);
  return record.close() ? 0 : 1;
}
