// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Writes what is asked of the native library and what it answers, for answers.test.js to ask WebAssembly the same: a
// line of JSON for each call, with the names of the JavaScript package. Decimals give back the bits of the numbers.
#include <array>
#include <deque>
#include <fstream>
#include <iostream>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "json_of.h"
#include "limber/elements.h"
#include "limber/limber.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"

namespace {

using namespace limber;
using namespace limber::web;
using scenes::Rng;

/// What is asked about is a model, by its place; or a shape, by this and its place.
constexpr std::size_t first_shape = 1000;

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// How a query is asked beyond its models.
struct Asked {
  std::uint64_t max_steps = unlimited;
  bool uses_cache = false;
};

/// Asks and writes.
class Recorder {
 public:
  explicit Recorder(const std::string& path) : out_(path) {}

  std::size_t add(const Mesh& mesh, bool is_float32 = false) {
    const std::vector<Vec3> positions = rounded(mesh.positions(), is_float32);
    write("Model", {}, {numbers_of(positions, is_float32), uint32s(ids_of(mesh.triangles()))});
    models_.push_back(Model(Mesh::create(positions, mesh.triangles()).value()));
    caches_.emplace_back();
    moving_.emplace_back(models_.back());
    write("edges", {models_.size() - 1}, {}, {}, ids_of(models_.back().edges().vertices()));
    return models_.size() - 1;
  }

  /// A shape that a factory of that name makes of these arguments.
  std::size_t add(const char* factory, const std::vector<json>& args, Shape shape) {
    std::vector<json> all{factory};
    all.insert(all.end(), args.begin(), args.end());
    write("Shape", {}, all, {}, of(shape));
    shapes_.push_back(std::move(shape));
    return first_shape + shapes_.size() - 1;
  }

  void move_all(std::size_t m, const std::vector<Vec3>& to, bool is_float32) {
    const std::vector<Vec3> positions = rounded(to, is_float32);
    write("moveAll", {m}, {numbers_of(positions, is_float32)});
    models_[m].move_all(positions).value();
    commit(m);
  }
  void move_vertices(std::size_t m, const scenes::VertexMoves& moves, bool is_float32) {
    const std::vector<Vec3> positions = rounded(moves.positions, is_float32);
    write("moveVertices", {m}, {uint32s(moves.ids), numbers_of(positions, is_float32)});
    models_[m].move_vertices(moves.ids, positions).value();
    commit(m);
  }

  void distance(std::size_t a, std::size_t b, const Transform& pose, DistanceOptions options, Asked asked = {}) {
    options.cache = cache(a, asked), options.budget = {.max_steps = asked.max_steps};
    json given = options_of(pose, asked);
    given["relativeError"] = options.relative_error, given["absoluteError"] = options.absolute_error;
    given["maxDistance"] = of(options.max_distance);
    write("distance", {a, b}, {}, given, of(limber::distance(placed(a), placed(b, pose), options)));
  }
  void collide(std::size_t a, std::size_t b, const Transform& pose, Asked asked = {}) {
    const CollideResult result = limber::collide(placed(a), placed(b, pose),
                                                 {.cache = cache(a, asked), .budget = {.max_steps = asked.max_steps}});
    write("collide", {a, b}, {}, options_of(pose, asked), of(result));
  }
  void within(std::size_t a, std::size_t b, const Transform& pose, double max_distance) {
    const CollideResult result = limber::within(placed(a), placed(b, pose), max_distance);
    write("within", {a, b}, {max_distance}, options_of(pose), of(result));
  }

  void contacts(std::size_t a, std::size_t b, const Transform& pose, double margin) {
    std::vector<Contact> found;
    const auto keep = [&](const Contact& contact) { return found.push_back(contact), true; };
    const PairCount count = visit_contacts(placed(a), placed(b, pose), margin, keep);
    write("contacts", {a, b}, {margin}, options_of(pose), contacts_of(found, count));
  }
  void intersections(std::size_t a, std::size_t b, const Transform& pose) {
    std::vector<TrianglePair> found;
    const auto keep = [&](const TrianglePair& one) { return found.push_back(one), true; };
    const PairCount count = visit_intersections(placed(a), placed(b, pose), keep);
    write("intersections", {a, b}, {}, options_of(pose), pairs_of(found, count));
  }
  void closest_pairs(std::size_t a, std::size_t b, const Transform& pose, std::size_t most, double max_distance) {
    std::vector<Contact> found(most);
    const PairCount count = limber::closest_pairs(placed(a), placed(b, pose), found, {.max_distance = max_distance});
    found.resize(count.count);
    json given{{"poseB", of(pose)}, {"maxDistance", of(max_distance)}};
    write("closestPairs", {a, b}, {most}, given, contacts_of(found, count));
  }

  /// All questions about a model and itself.
  void of_itself(std::size_t m, double margin, std::uint32_t ring_edges) {
    const Model& model = models_[m];
    const NeighborRings rings(model.mesh(), ring_edges);
    const json ringed{{"rings", ring_edges}};
    write("selfCollide", {m}, {}, {}, of(self_collide(model)));
    write("selfDistance", {m}, {}, ringed, of(self_distance(model, {.filter = rings})));
    std::vector<Contact> found;
    const auto keep = [&](const Contact& contact) { return found.push_back(contact), true; };
    const PairCount close = visit_self_contacts(model, margin, keep, {.filter = rings});
    write("selfContacts", {m}, {margin}, ringed, contacts_of(found, close));
    std::vector<TrianglePair> pairs;
    const auto keep_pair = [&](const TrianglePair& one) { return pairs.push_back(one), true; };
    const PairCount meeting = visit_self_intersections(model, keep_pair);
    write("selfIntersections", {m}, {}, {}, pairs_of(pairs, meeting));
    found.resize(10);
    const PairCount closest = self_closest_pairs(model, found);
    found.resize(closest.count);
    write("selfClosestPairs", {m}, {10}, {}, contacts_of(found, closest));
  }

  void closest_point_many(std::size_t m, const Transform& pose, const std::vector<Vec3>& points, double max_distance) {
    std::vector<PointResult> results(points.size());
    static_cast<void>(limber::closest_point_many({models_[m], pose}, points, results, {max_distance}));
    const json options{{"pose", of(pose)}, {"maxDistance", of(max_distance)}};
    write("closestPointMany", {m}, {numbers_of(points)}, options, each(results));
  }
  void signed_distance_many(std::size_t m, const Transform& pose, const std::vector<Vec3>& points,
                            double max_distance) {
    std::vector<SignedDistance> results(points.size());
    ClosedSurface::create(models_[m]).value().signed_distance_many(points, results, pose, {max_distance});
    const json options{{"pose", of(pose)}, {"maxDistance", of(max_distance)}};
    write("signedDistanceMany", {m}, {numbers_of(points)}, options, each(results));
  }

  /// All questions about two bodies.
  void solids(std::size_t a, std::size_t b, const Transform& pose, const Vec3& direction, std::uint64_t max_steps) {
    const ClosedSurface first = ClosedSurface::create(models_[a]).value();
    const ClosedSurface second = ClosedSurface::create(models_[b]).value();
    const Transform none;
    json given{{"poseA", nullptr}, {"poseB", of(pose)}};
    write("solidRelation", {a, b}, {}, given, of(solid_relation({first, none}, {second, pose})));
    const QueryBudget budget{.max_steps = max_steps};
    if (max_steps < unlimited) given["budget"] = {{"maxSteps", max_steps}};
    write("deepestVertices", {a, b}, {}, given, of(deepest_vertices({first, none}, {second, pose}, {budget})));
    write("separatingTranslation", {a, b}, {of(direction)}, given,
          of(separating_translation({first, none}, {second, pose}, direction, {budget})));
    given["relativeError"] = 0.1;
    write("signedDistance", {a, b}, {}, given,
          of(limber::signed_distance({first, none}, {second, pose}, {.relative_error = 0.1, .budget = budget})));
  }

  /// The contact of the closest triangles, and all its gradients.
  void gradients(std::size_t a, std::size_t b, const Transform& pose, const Vec3& center) {
    const Placed first = placed(a), second = placed(b, pose);
    const Witness witness = limber::distance(first, second).witness.value();
    Contact contact;
    contact.triangle_a = witness.triangle_a, contact.triangle_b = witness.triangle_b;
    static_cast<TriangleContact&>(contact) = contact_of(first, second, witness);
    const json given{{"poseA", nullptr}, {"poseB", of(pose)}}, described = of(contact);
    write("contactOf", {a, b}, {of(std::optional(witness))}, given, described);
    write("poseGradientA", {}, {described, of(center)}, {}, of(pose_gradient_a(contact, center)));
    write("poseGradientB", {}, {described, of(center)}, {}, of(pose_gradient_b(contact, center)));
    write("vertexGradientsA", {}, {described}, {}, of(vertex_gradients_a(contact)));
    write("vertexGradientsB", {}, {described}, {}, of(vertex_gradients_b(contact)));
  }

  /// A mesh whose triangles have corners of their own, and what it is when welded.
  void weld(const Mesh& mesh) {
    std::vector<Vec3> positions;
    std::vector<Corners> triangles;
    for (const Corners& corners : mesh.triangles()) {
      const auto first = static_cast<VertexId>(positions.size());
      triangles.push_back({first, first + 1, first + 2});
      for (const VertexId v : corners) positions.push_back(mesh.positions()[v]);
    }
    const WeldedMesh welded = limber::weld(Mesh::create(positions, triangles).value());
    write("weld", {}, {numbers_of(positions), uint32s(ids_of(triangles))}, {},
          {{"vertices", numbers_of(welded.mesh.positions())["Float64Array"]},
           {"faces", ids_of(welded.mesh.triangles())},
           {"weldedOf", welded.vertices.welded_of}});
  }

  // --- one scene ---

  void add_object(std::size_t m, const Transform& pose) {
    write("sceneAdd", {m}, {of(pose)}, {}, scene_.add(placed(m, pose)));
  }
  void remove_object(ObjectId id) {
    scene_.remove(id);
    write("sceneCall", {}, {"remove", id});
  }
  void commit_scene(const std::vector<ObjectId>& ids, const std::vector<Transform>& poses) {
    scene_.set_poses(ids, poses);
    write("sceneCall", {}, {"setPoses", uint32s(ids), matrices_of(poses)});
    scene_.commit();
    write("sceneCall", {}, {"commit"});
  }

  /// All questions about pairs of objects within a margin.
  void pairs_of_scene(double margin, std::uint64_t max_steps, bool uses_cache) {
    std::vector<ObjectPair> pairs;
    scene_.visit_candidate_pairs(margin, [&](const ObjectPair& pair) { return pairs.push_back(pair), true; });
    json ids = json::array();
    for (const ObjectPair& pair : pairs) ids.push_back(pair.a), ids.push_back(pair.b);
    write("sceneCall", {}, {"candidatePairs", margin}, {}, ids);
    SceneCache* const cache = uses_cache ? &scene_cache_ : nullptr;
    const QueryBudget budget{.max_steps = max_steps};
    json given{{"sceneCache", uses_cache}};
    if (max_steps < unlimited) given["budget"] = {{"maxSteps", max_steps}};
    std::vector<CollideResult> answers(pairs.size());
    scene_.collide(pairs, answers, {.cache = cache, .budget = budget});
    write("sceneCall", {}, {"collide", uint32s(ids)}, given, each(answers));
    scene_.within(pairs, 0.5 * margin, answers, {.cache = cache, .budget = budget});
    write("sceneCall", {}, {"within", uint32s(ids), 0.5 * margin}, given, each(answers));
    std::vector<DistanceResult> distances(pairs.size());
    scene_.distance(pairs, distances, {.distance = {.relative_error = 0.01, .budget = budget}, .cache = cache});
    given["relativeError"] = 0.01;
    write("sceneCall", {}, {"distance", uint32s(ids)}, given, each(distances));
    ObjectContacts found;
    scene_.contacts(pairs, 0.1 * margin, found);
    write("sceneCall", {}, {"contacts", uint32s(ids), 0.1 * margin}, json::object(),
          {{"contacts", each(found.contacts)}, {"offsets", found.offsets}});
  }

  /// All questions about all pairs, but one that the matrix leaves out, and about some configurations.
  void all_of_scene(ObjectId a, ObjectId b, const std::vector<ObjectId>& ids, const std::vector<Transform>& poses) {
    ObjectPairMatrix counts(scene_.id_bound());
    counts.set(a, b, false);
    json given{{"leftOut", {a, b}}, {"sceneCache", true}};
    write("sceneCall", {}, {"closestObjects"}, given,
          of(scene_.closest_objects({.filter = counts, .cache = &scene_cache_})));
    given.erase("sceneCache");
    write("sceneCall", {}, {"anyWithin", 0.25}, given, of(scene_.any_within(0.25, {.filter = counts})));
    const std::size_t configurations = poses.size() / ids.size();
    std::vector<AnyWithinResult> close(configurations);
    scene_.any_within_many(ids, poses, 0.25, close, {.filter = counts});
    write("sceneCall", {}, {"anyWithinMany", uint32s(ids), matrices_of(poses), 0.25}, given, each(close));
    std::vector<ClosestObjectsResult> closest(configurations);
    scene_.closest_objects_many(ids, poses, closest, {.distance = {.max_distance = 2}, .filter = counts});
    given["maxDistance"] = 2;
    write("sceneCall", {}, {"closestObjectsMany", uint32s(ids), matrices_of(poses)}, given, each(closest));
  }

  /// All questions about one body next to all objects but one.
  void next_to_scene(std::size_t m, const Transform& pose, ObjectId left_out, const DistanceOptions& options) {
    std::vector<ObjectId> ids;
    scene_.visit_candidates(placed(m, pose), 1, [&](ObjectId id) { return ids.push_back(id), true; });
    write("sceneNextTo", {m}, {"candidates", 1}, {{"pose", of(pose)}}, ids);
    const auto counts = [&](ObjectId id) { return id != left_out; };
    json given{{"pose", of(pose)}, {"leftOut", left_out}, {"relativeError", options.relative_error}};
    given["maxDistance"] = of(options.max_distance);
    if (options.budget.max_steps < unlimited) given["budget"] = {{"maxSteps", options.budget.max_steps}};
    write("sceneNextTo", {m}, {"closestObject"}, given, of(scene_.closest_object(placed(m, pose), {options, counts})));
  }

  /// A vertex and a face, or two edges, by four points at the start and four at the end.
  void elements(bool are_edges, const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                const ElementImpactOptions& options) {
    const auto found = are_edges ? limber::time_of_impact({{from[0], from[1]}, {to[0], to[1]}},
                                                          {{from[2], from[3]}, {to[2], to[3]}}, options)
                                 : limber::time_of_impact(
                                       {from[0], to[0]}, {{from[1], from[2], from[3]}, {to[1], to[2], to[3]}}, options);
    const json given{
        {"maxTime", options.max_time}, {"timeError", options.time_error}, {"minSeparation", options.min_separation}};
    write(are_edges ? "edgeEdgeImpact" : "vertexFaceImpact", {}, {numbers_of(from), numbers_of(to)}, given, of(found));
  }

  void set_motion(std::size_t m, const std::vector<Vec3>& to, const Transform& start, const Transform& end,
                  bool is_float32) {
    const std::vector<Vec3> positions = rounded(to, is_float32);
    write("setMotion", {m}, {numbers_of(positions, is_float32)}, {{"startPose", of(start)}, {"endPose", of(end)}});
    moving_[m].set_motion(positions, start, end).value();
  }
  void time_of_impact(std::size_t a, std::size_t b, ImpactOptions options, std::uint64_t max_steps = unlimited) {
    options.budget = {.max_steps = max_steps};
    const ImpactResult result = limber::time_of_impact(moving_[a], moving_[b], options);
    write("timeOfImpact", {a, b}, {}, options_of(options), of(result));
  }
  void self_time_of_impact(std::size_t m, ImpactOptions options, std::uint64_t max_steps = unlimited) {
    options.budget = {.max_steps = max_steps};
    write("selfTimeOfImpact", {m}, {}, options_of(options), of(limber::self_time_of_impact(moving_[m], options)));
  }
  /// Of two models, and of the first with itself.
  void impacts(std::size_t a, std::size_t b, const ImpactOptions& options) {
    std::vector<Impact> found;
    const auto keep = [&](const Impact& impact) { return found.push_back(impact), true; };
    const PairCount of_both = visit_impacts(moving_[a], moving_[b], keep, options);
    write("impacts", {a, b}, {}, options_of_all(options), impacts_of(found, of_both));
    found.clear();
    const PairCount of_one = visit_self_impacts(moving_[a], keep, options);
    write("selfImpacts", {a}, {}, options_of_all(options), impacts_of(found, of_one));
  }

  /// Bodies that do not turn: sines have other roundings in other C libraries.
  void path(std::size_t a, std::size_t b, const Transform& start, const Vec3& to, PathOptions options,
            Asked asked = {}) {
    const Transform end{start.rotation, to};
    options.cache = cache(a, asked), options.budget = {.max_steps = asked.max_steps};
    json given{{"motions", {{of(start), of(end)}, {of(Transform{})}}},
               {"maxTime", options.max_time},
               {"cache", asked.uses_cache}};
    if (options.distance_error) given["distanceError"] = *options.distance_error;
    if (asked.max_steps < unlimited) given["budget"] = {{"maxSteps", asked.max_steps}};
    const PathDistance nearest = min_distance(body(a), RigidMotion(start, end), body(b), {}, options);
    write("minDistance", {a, b}, {}, given, of(nearest));
    given["minSeparation"] = options.min_separation;
    const PathImpact first = limber::time_of_impact(body(a), RigidMotion(start, end), body(b), {}, options);
    write("pathImpact", {a, b}, {}, given, of(first));
  }

  /// Bounds and statistics.
  void tree(std::size_t m) {
    const Model& model = models_[m];
    const Box box = model.bounding_box();
    const MaintenanceStats stats = model.maintenance_stats();
    json spheres = json::array();
    for (std::uint32_t level = 0; level < model.tree_stats().levels; ++level) {
      json& numbers = spheres.emplace_back(json::array());
      for (const Sphere& sphere : model.node_spheres(level)) {
        for (const double x : {sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius}) numbers.push_back(x);
      }
    }
    write("tree", {m}, {}, {},
          {{"box", {{"low", of(box.low)}, {"high", of(box.high)}}},
           {"maintenance",
            {{"movedVertices", stats.moved_vertices},
             {"refits", stats.refits},
             {"wholePasses", stats.whole_passes},
             {"rebuiltTriangles", stats.rebuilt_triangles},
             {"rebuildUs", stats.rebuild_us}}},
           {"spheres", spheres}});
  }

  void file(const std::string& name, const std::string& bytes) {
    json given = json::array();
    for (const char c : bytes) given.push_back(static_cast<unsigned char>(c));
    const Result<MeshFile> read = read_mesh_bytes(std::as_bytes(std::span(bytes)), name);
    json answer;
    if (read) {
      answer = {{"vertices", numbers_of(read->mesh.positions())["Float64Array"]},
                {"faces", ids_of(read->mesh.triangles())},
                {"faceOfTriangle", read->face_of_triangle},
                {"faceCount", read->face_count}};
    } else {
      answer = of(read.error());
    }
    write("readMeshBytes", {}, {{{"Uint8Array", given}}, name}, {}, answer);
  }

  /// Positions that a move refuses.
  void refused(std::size_t m, const std::vector<Vec3>& to) {
    write("moveAll", {m}, {numbers_of(to)}, {}, of(models_[m].move_all(to).error()));
  }

  bool close() { return static_cast<bool>(out_.flush()); }

 private:
  void write(const char* call, const std::vector<std::size_t>& of_models, const std::vector<json>& args,
             const json& options = {}, const json& answer = {}) {
    out_ << json{{"call", call}, {"of", of_models}, {"args", args}, {"options", options}, {"answer", answer}} << '\n';
  }
  void commit(std::size_t m) {
    write("commit", {m}, {});
    models_[m].commit();
  }
  Body body(std::size_t i) const { return i < first_shape ? Body(models_[i]) : Body(shapes_[i - first_shape]); }
  Placed placed(std::size_t i, const Transform& pose = {}) const { return {body(i), pose}; }
  QueryCache* cache(std::size_t a, Asked asked) { return asked.uses_cache ? &caches_[a] : nullptr; }

  static json options_of(const Transform& pose, Asked asked = {}) {
    json options{{"poseA", nullptr}, {"poseB", of(pose)}, {"cache", asked.uses_cache}};
    if (asked.max_steps < unlimited) options["budget"] = {{"maxSteps", asked.max_steps}};
    return options;
  }
  static json options_of_all(const ImpactOptions& options) {
    return {{"maxTime", options.max_time},
            {"timeError", options.time_error},
            {"minSeparation", options.min_separation},
            {"separationFraction", options.separation_fraction}};
  }
  static json options_of(const ImpactOptions& options) {
    json given = options_of_all(options);
    given["ignoreCrossings"] = options.ignore_crossings, given["anyContact"] = options.any_contact;
    if (options.budget.max_steps < unlimited) given["budget"] = {{"maxSteps", options.budget.max_steps}};
    return given;
  }
  static json uint32s(const json& ids) { return {{"Uint32Array", ids}}; }
  static json matrices_of(const std::vector<Transform>& poses) {
    json numbers = json::array();
    for (const Transform& pose : poses) {
      for (const double x : matrix_of(pose, MatrixOrder::column_major)) numbers.push_back(x);
    }
    return {{"Float64Array", numbers}};
  }
  static json contacts_of(const std::vector<Contact>& found, const PairCount& count) {
    return {{"count", found.size()}, {"contacts", each(found)}, {"stats", of(count.stats)}};
  }
  static json impacts_of(const std::vector<Impact>& found, const PairCount& count) {
    return {{"count", found.size()}, {"isComplete", true}, {"impacts", each(found)}, {"stats", of(count.stats)}};
  }
  static json pairs_of(const std::vector<TrianglePair>& found, const PairCount& count) {
    json ids = json::array();
    for (const TrianglePair& pair : found) ids.push_back(pair.a), ids.push_back(pair.b);
    return {{"count", found.size()}, {"isComplete", true}, {"triangles", ids}, {"stats", of(count.stats)}};
  }

  std::ofstream out_;
  std::deque<Model> models_;  // stay where they are, as moving models refer to them
  std::deque<Shape> shapes_;
  std::deque<MovingModel> moving_;
  std::vector<QueryCache> caches_;
  Scene scene_;
  SceneCache scene_cache_;
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

/// Two rigid models in many poses, every query.
void ask_of_poses(Recorder& record, std::size_t a, std::size_t b, std::size_t poses, double distance, Rng& rng) {
  for (std::size_t i = 0; i < poses; ++i) {
    const Transform pose = random_pose(rng, distance);
    record.distance(a, b, pose, {});
    record.distance(a, b, pose, {.relative_error = 0.1}, {.uses_cache = true});
    record.distance(a, b, pose, {.absolute_error = 0.05 * distance, .max_distance = distance});
    record.distance(a, b, pose, {}, {.max_steps = 1 + rng.below(40)});
    record.collide(a, b, pose);
    record.collide(a, b, pose, {.max_steps = 1 + rng.below(10), .uses_cache = true});
    record.within(a, b, pose, 0.2 * distance);
    if (i % 4 != 0) continue;
    record.intersections(a, b, pose);
    record.contacts(a, b, pose, 0.02);
    record.closest_pairs(a, b, pose, 20, i % 8 == 0 ? infinity : 0.1 * distance);
  }
}

/// A deforming mesh: moves, commits, queries against another model and of itself.
void ask_of_motion(Recorder& record, const scenes::Motion& motion, std::size_t other, int frames, double step,
                   Rng& rng) {
  const std::size_t m = record.add(motion.mesh, false);
  for (int frame = 1; frame <= frames; ++frame) {
    record.move_all(m, motion.positions(step * frame), frame % 2 == 0);
    const Transform pose = random_pose(rng, 1);
    record.distance(m, other, pose, {}, {.uses_cache = true});
    record.contacts(m, other, pose, 0.01);
    if (frame % 5 != 0) continue;
    record.tree(m);
    record.of_itself(m, 0.002, static_cast<std::uint32_t>(frame / 5 % 3));
  }
}

/// Elements in general position, on a lattice, where everything degenerate happens, and with long numbers.
void ask_of_elements(Recorder& record, Rng& rng) {
  const auto lattice_points = [&](double part) {
    std::vector<Vec3> points(4);
    for (Vec3& p : points) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        p[axis] = static_cast<double>(rng.below(3)) + part * static_cast<double>(rng.below(3));
      }
    }
    return points;
  };
  for (int i = 0; i < 600; ++i) {
    const bool are_edges = i % 2 == 0;
    const std::vector<Vec3> from = points_around(rng, 4, 1), to = points_around(rng, 4, 1);
    record.elements(are_edges, from, to, {});
    record.elements(are_edges, from, to, {.max_time = rng.uniform(), .time_error = 1e-3 * rng.uniform()});
    if (i % 4 < 2) record.elements(are_edges, from, to, {.min_separation = 0.2 * rng.uniform()});
    const double part = i % 5 == 0 ? 0x1p-300 : i % 5 == 1 ? 0x1p-40 : 0;
    record.elements(are_edges, lattice_points(part), lattice_points(part), {});
  }
}

/// Steps of a deforming mesh from frame to frame, turned on the way, next to another model that moves, and to itself.
void ask_of_steps(Recorder& record, const scenes::Motion& motion, std::size_t other, const std::vector<Vec3>& of_other,
                  int frames, double step, Rng& rng) {
  const std::size_t m = record.add(motion.mesh, false);
  for (int frame = 0; frame < frames; ++frame) {
    const Transform start = random_pose(rng, 1), end{start.rotation, points_around(rng, 1, 2)[0]};
    record.set_motion(m, motion.positions(step * (frame + 1)), start, frame % 3 == 0 ? random_pose(rng, 2) : end,
                      frame % 2 == 0);
    record.set_motion(other, of_other, {}, {Mat3{}, points_around(rng, 1, 1)[0]}, false);
    const double separation = 0.01 * rng.uniform();
    record.time_of_impact(m, other, {});
    record.time_of_impact(m, other, {.max_time = 0.7, .time_error = 1e-6, .ignore_crossings = true});
    record.time_of_impact(m, other,
                          {.min_separation = separation, .separation_fraction = 0.5, .ignore_crossings = true});
    record.time_of_impact(m, other, {.ignore_crossings = true, .any_contact = true});
    record.time_of_impact(m, other, {.ignore_crossings = true}, 1 + rng.below(60));
    record.self_time_of_impact(m, {.time_error = 1e-6});
    record.self_time_of_impact(m,
                               {.min_separation = separation, .separation_fraction = 0.25, .ignore_crossings = true});
    record.self_time_of_impact(m, {.any_contact = true}, 1 + rng.below(60));
    record.impacts(m, other, {.max_time = 0.1, .time_error = 1e-6});
    record.impacts(m, other,
                   {.max_time = 0.05, .time_error = 1e-6, .min_separation = 0.001, .separation_fraction = 0.5});
    record.move_all(m, motion.positions(step * (frame + 1)), frame % 2 == 0);
  }
}

Mesh cube() {
  std::vector<Vec3> corners(8);
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) corners[i][axis] = (i >> axis & 1) != 0 ? 1 : -1;
  }
  const std::vector<Corners> triangles{{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return Mesh::create(corners, triangles).value();
}

/// Two bodies, apart, in each other, and flush.
void ask_of_bodies(Recorder& record, std::size_t a, std::size_t b, double distance, Rng& rng) {
  for (int i = 0; i < 24; ++i) {
    const Transform pose = random_pose(rng, distance * rng.uniform());
    record.solids(a, b, pose, points_around(rng, 1, 1)[0], i % 3 == 0 ? 1 + rng.below(40) : unlimited);
    record.gradients(a, b, pose, points_around(rng, 1, 1)[0]);
  }
  for (const double shift : {0.0, 0.5, 1.0, 2.0, 3.0}) {
    record.solids(a, a, {Mat3{}, {shift, 0, 0}}, {1, 1, 0}, unlimited);
    record.solids(b, b, {Mat3{}, {0, 0, shift}}, {0, 0, 1}, unlimited);
  }
}

/// Every shape but cylinders: their sines are those of the C library, which may round them otherwise.
std::vector<std::size_t> add_shapes(Recorder& record, Rng& rng) {
  const auto coordinates = [](const Vec3& v) { return of(v); };
  const Vec3 start{-0.5, 0.25, 0}, end{0.75, 0, 0.5}, extents{0.5, 0.75, 0.25}, normal{0.25, -0.5, 1};
  const std::vector<Vec3> points = points_around(rng, 60, 1), rough = rounded(points, true);
  const std::vector<Vec3> flat{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  std::vector<double> heights(35);
  for (double& height : heights) height = rng.uniform();
  const json of_heights{{"Float64Array", heights}};
  return {record.add("sphere", {0.375}, Shape::sphere(0.375)),
          record.add("capsule", {coordinates(start), coordinates(end), 0.1}, Shape::capsule(start, end, 0.1)),
          record.add("box", {coordinates(extents)}, Shape::box(extents)),
          record.add("box", {coordinates(extents), 0.3}, Shape::box(extents, 0.3)),
          record.add("halfSpace", {coordinates(normal), -0.7, 8}, Shape::half_space(normal, -0.7, 8)),
          record.add("convexHull", {numbers_of(points)}, Shape::convex_hull(points)),
          record.add("convexHull", {numbers_of(rough, true), 0.2}, Shape::convex_hull(rough, 0.2)),
          record.add("convexHull", {numbers_of(flat)}, Shape::convex_hull(flat)),
          record.add("heightField", {of_heights, 5, 7, 0.5, 0.25}, Shape::height_field(heights, 5, 7, 0.5, 0.25)),
          record.add("heightField", {of_heights, 7, 5, 0.5, 0.25, 0.05},
                     Shape::height_field(heights, 7, 5, 0.5, 0.25, 0.05)),
          record.add("pointCloud", {numbers_of(rough, true), 0.05}, Shape::point_cloud(rough, 0.05))};
}

/// Shapes next to a model and to each other, every query.
void ask_of_shapes(Recorder& record, std::size_t model, const std::vector<std::size_t>& shapes, Rng& rng) {
  for (const std::size_t a : shapes) {
    for (const std::size_t b : shapes) {
      const Transform pose = random_pose(rng, 3);
      record.distance(a, b, pose, {});
      record.distance(a, b, pose, {.relative_error = 0.1, .max_distance = 2});
      record.collide(a, b, pose);
      record.within(a, b, pose, 0.5);
      record.contacts(a, b, pose, 0.25);
      record.intersections(a, b, pose);
    }
    for (int i = 0; i < 8; ++i) {
      const Transform pose = random_pose(rng, 3);
      record.distance(model, a, pose, {}, {.uses_cache = true});
      record.distance(a, model, pose, {}, {.max_steps = 1 + rng.below(20)});
      record.collide(model, a, pose, {.uses_cache = true});
      record.contacts(a, model, pose, 0.1);
      record.closest_pairs(model, a, pose, 20, infinity);
      record.gradients(model, a, pose, points_around(rng, 1, 1)[0]);
      record.path(a, model, pose, points_around(rng, 1, 3)[0], {.min_separation = 0.1});
    }
  }
}

/// Objects that move, come and go.
void ask_of_scenes(Recorder& record, const std::vector<std::size_t>& models, Rng& rng) {
  constexpr std::size_t count = 24;
  std::vector<ObjectId> ids;
  for (std::size_t i = 0; i < count; ++i) {
    record.add_object(models[i % models.size()], random_pose(rng, 6));
    ids.push_back(static_cast<ObjectId>(i));
  }
  std::vector<Transform> poses(count);
  for (int frame = 0; frame < 12; ++frame) {
    for (Transform& pose : poses) pose = random_pose(rng, frame % 2 == 0 ? 6 : 20);
    if (frame % 4 == 3) {
      record.remove_object(5);
      record.add_object(models[static_cast<std::size_t>(frame) % models.size()], poses[5]);
    }
    record.commit_scene(ids, poses);
    record.pairs_of_scene(1, frame % 3 == 1 ? 1 + rng.below(20) : unlimited, frame % 2 == 0);
    for (Transform& pose : poses) pose = random_pose(rng, 12);
    record.all_of_scene(static_cast<ObjectId>(frame), 20, {3, 7, 7, 11}, {poses.begin(), poses.begin() + 20});
    for (std::size_t i = 0; i < models.size(); ++i) {
      DistanceOptions options{.relative_error = i % 2 == 0 ? 0 : 0.1};
      if (i % 3 == 1) options.max_distance = 1;
      if (i % 3 == 2) options.budget = {.max_steps = 1 + rng.below(20)};
      record.next_to_scene(models[i], poses[i], static_cast<ObjectId>(i), options);
    }
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
    record.distance(lattice, lattice, shift, {});
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
    record.distance(dented, ball, random_pose(rng, 30), {}, {.uses_cache = true});
  }
  record.tree(dented);

  for (int i = 0; i < 5; ++i) {
    const Transform pose = random_pose(rng, 2);
    record.closest_point_many(ball, pose, points_around(rng, 200, 4), i % 2 == 0 ? infinity : 1);
    record.closest_point_many(soup, pose, points_around(rng, 200, 50), infinity);
    record.signed_distance_many(ball, pose, points_around(rng, 200, 2), i % 2 == 0 ? infinity : 0.5);
  }

  ask_of_elements(record, rng);
  const std::vector<Vec3> of_ball = scenes::ball(24, 16).positions();
  ask_of_steps(record, scenes::waving_sheet(20, 20), ball, of_ball, 12, 1, rng);
  ask_of_steps(record, scenes::crumpling_cloth(20), ball, of_ball, 12, 12, rng);
  ask_of_steps(record, scenes::twisting_bar(3), ball, of_ball, 12, 6, rng);
  ask_of_steps(record, scenes::shuffled_soup(200), ball, of_ball, 12, 20, rng);
  for (int i = 0; i < 60; ++i) {
    const Transform start = random_pose(rng, 4);
    const std::size_t b = i % 2 == 0 ? sheet : soup;
    record.path(ball, b, start, points_around(rng, 1, 4)[0], {});
    record.path(ball, b, start, points_around(rng, 1, 4)[0],
                {.max_time = 0.75, .min_separation = 0.3, .distance_error = 0.01}, {.uses_cache = true});
    record.path(ball, b, start, points_around(rng, 1, 4)[0], {}, {.max_steps = 1 + rng.below(12)});
  }

  const std::size_t box = record.add(cube());
  ask_of_bodies(record, ball, box, 3, rng);
  const std::vector<std::size_t> shapes = add_shapes(record, rng);
  ask_of_shapes(record, ball, shapes, rng);
  std::vector<std::size_t> bodies{ball, box, soup};
  bodies.insert(bodies.end(), shapes.begin(), shapes.end());
  ask_of_scenes(record, bodies, rng);
  record.weld(scenes::ball(12, 8));
  record.weld(scenes::lattice_soup(rng, 100, 3));

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
  Recorder record(argv[1]);
  ask(record);
  return record.close() ? 0 : 1;
}
