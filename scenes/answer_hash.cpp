// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Source   The idea is Jolt's, whose performance test prints a hash of its simulation.
#include "scenes/scenes.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <type_traits>
#include <utility>

#include "limber/limber.h"
#include "scenes/motions.h"

namespace limber::scenes {
namespace {

/// FNV-1a over words of 64 bits. Every type of a result has an overload of add().
class Digest {
 public:
  explicit Digest(const char* kind) : result_{kind, 0, 0xcbf29ce484222325} {}

  /// Adds the answer to one query.
  template <typename... Parts>
  void answer(const Parts&... parts) {
    ++result_.queries;
    (add(parts), ...);
  }
  const AnswerHash& result() const { return result_; }

  template <typename T>
  requires(std::is_integral_v<T> || std::is_enum_v<T>) void add(T value) {
    result_.hash = (result_.hash ^ static_cast<std::uint64_t>(value)) * 0x100000001b3;
    result_.hash ^= result_.hash >> 29;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
  void add(const Feature& f) { add(f.kind), add(f.index); }
  template <typename T>
  void add(const std::optional<T>& value) {
    add(value.has_value());
    if (value) add(*value);
  }
  template <typename T>
  void add(const std::vector<T>& values) {
    add(values.size());
    for (const T& value : values) add(value);
  }

  void add(const Witness& w) { add(w.point_a), add(w.point_b), add(w.triangle_a), add(w.triangle_b); }
  void add(const DistanceResult& r) { add(r.lower), add(r.upper), add(r.status), add(r.witness), add(r.stopped_by); }
  void add(const CollideResult& r) { add(r.answer), add(r.witness), add(r.stopped_by); }
  void add(const TrianglePair& p) { add(p.a), add(p.b); }
  void add(const Contact& c) {
    add(c.distance), add(c.depth), add(c.point_a), add(c.point_b), add(c.normal), add(c.weights_a), add(c.weights_b);
    add(c.feature_a), add(c.feature_b), add(c.normal_side), add(c.triangle_a), add(c.triangle_b);
  }
  void add(const VertexFacePair& p) {
    add(p.vertex), add(p.triangle), add(p.is_vertex_of_b), add(p.distance), add(p.weights);
  }
  void add(const EdgeEdgePair& p) { add(p.a), add(p.b), add(p.distance), add(p.parameter_a), add(p.parameter_b); }
  void add(const SurfacePoint& p) { add(p.distance), add(p.position), add(p.triangle), add(p.weights), add(p.feature); }
  void add(const SignedDistance& d) { add(d.is_inside), add(d.closest); }
  void add(const ElementPair& e) { add(e.kind), add(e.a), add(e.b); }
  void add(const ImpactResult& r) {
    add(r.status), add(r.lower), add(r.upper), add(r.elements), add(r.witness), add(r.normal);
  }
  void add(const Impact& i) { add(i.elements), add(i.time.lower), add(i.time.upper); }
  void add(const PathImpact& i) { add(i.status), add(i.time), add(i.witness), add(i.normal), add(i.stopped_by); }
  void add(const PathDistance& d) { add(d.lower), add(d.upper), add(d.time), add(d.witness), add(d.stopped_by); }
  void add(const DeepestVertex& v) { add(v.vertex), add(v.depth); }
  void add(const DeepestPair& d) { add(d.of_a), add(d.of_b), add(d.max_depth); }
  void add(const SeparatingTranslation& t) { add(t.lower), add(t.upper), add(t.witness), add(t.stopped_by); }
  void add(const SolidDistance& d) {
    add(d.lower), add(d.upper), add(d.translation), add(d.witness), add(static_cast<const DeepestPair&>(d.deepest));
  }
  void add(const SolidRelationResult& r) { add(r.relation), add(r.witness), add(r.stopped_by); }
  void add(const ObjectPair& p) { add(p.a), add(p.b); }

 private:
  AnswerHash result_;
};

using Hashes = std::vector<AnswerHash>;

Vec3 random_point(Rng& rng, double reach) {
  return {rng.uniform(-reach, reach), rng.uniform(-reach, reach), rng.uniform(-reach, reach)};
}
Transform random_pose(Rng& rng, double reach) { return {random_rotation(rng), random_point(rng, reach)}; }

/// Pairs of bodies that are apart, cross, lie in common planes and are small or large, each with how far poses reach.
struct Pair {
  Model a, b;
  double reach;
};
std::vector<Pair> pairs() {
  Rng rng(1);
  std::vector<Pair> all;
  all.push_back({Model(ball(24, 16)), Model(ring(30, 12, 0.2)), 2.5});
  all.push_back({Model(random_soup(rng, 600, 0.2)), Model(random_soup(rng, 300, 0.3)), 3});
  all.push_back({Model(lattice_soup(rng, 120, 4)), Model(lattice_soup(rng, 60, 3)), 4});
  all.push_back({Model(grid(16, 16, -1, -1, 0.125, 0.125)), Model(ball(10, 6)), 2});
  all.push_back({Model(wave_sheet(30, 30, 3)), Model(wave_sheet(20, 20, 9)), 3});
  return all;
}

/// Pose number i: every fourth only moves by whole steps, so that faces lie in common planes.
Transform pose(Rng& rng, double reach, std::uint32_t i) {
  const Transform free = random_pose(rng, reach);
  if (i % 4 != 3) return free;
  const auto whole = [](double x) { return static_cast<double>(static_cast<int>(x)); };
  return {{}, {whole(free.translation.x), whole(free.translation.y), whole(free.translation.z)}};
}

void ask_two(Digest& digest, const Placed& a, const Placed& b, QueryCache* cache, const QueryBudget& budget) {
  digest.answer(distance(a, b, {.cache = cache, .budget = budget}));
  digest.answer(distance(a, b, {.relative_error = 0.1, .cache = cache, .budget = budget}));
  digest.answer(distance(a, b, {.absolute_error = 0.05, .max_distance = 1, .cache = cache, .budget = budget}));
  digest.answer(collide(a, b, {cache, budget}));
  digest.answer(within(a, b, 0.2, {cache, budget}));
}

void ask_static(Hashes& hashes, std::uint32_t scale) {
  Digest cold("two models"), budgets("budgets of steps"), radii("shapes and radii");
  const Shape sphere = Shape::sphere(0.3), capsule = Shape::capsule({0, 0, 0}, {0.5, 0, 0}, 0.1),
              box = Shape::box({0.2, 0.3, 0.4}, 0.05);
  Rng rng(2);
  for (const Pair& p : pairs()) {
    for (std::uint32_t i = 0; i < 20 * scale; ++i) {
      const Transform there = pose(rng, p.reach, i);
      ask_two(cold, p.a, {p.b, there}, nullptr, {});
      ask_two(budgets, p.a, {p.b, there}, nullptr, {.max_steps = rng.below(60)});
      ask_two(radii, p.a, {i % 3 == 0 ? sphere : i % 3 == 1 ? capsule : box, there}, nullptr, {});
      ask_two(radii, {Body(p.a, 0.02)}, {Body(p.b, 0.01), there}, nullptr, {});
    }
  }
  hashes.insert(hashes.end(), {cold.result(), budgets.result(), radii.result()});
}

void ask_with_caches(Hashes& hashes, std::uint32_t scale) {
  Digest digest("caches");
  Rng rng(3);
  for (const Pair& p : pairs()) {
    QueryCache cache;
    for (std::uint32_t i = 0; i < 20 * scale; ++i) {
      // Each pose is asked about twice, a small step apart; the next one is a jump away.
      const Transform from = random_pose(rng, p.reach);
      const Vec3 step = random_point(rng, 0.01);
      const QueryBudget budget{.max_steps = i % 5 == 4 ? rng.below(100) : QueryBudget{}.max_steps};
      for (int k = 0; k < 2; ++k)
        ask_two(digest, p.a, {p.b, {from.rotation, from.translation + k * step}}, &cache, budget);
    }
  }
  hashes.push_back(digest.result());
}

void ask_deforming(Hashes& hashes, std::uint32_t scale) {
  Digest digest("deforming models");
  Rng rng(4);
  const Model ball_model(ball(20, 12));
  for (const Motion& motion : {waving_sheet(24, 24), twisting_bar(4), crumpling_cloth(20), shuffled_soup(400)}) {
    for (const double margin : {0.0, 0.02}) {
      Model model(motion.mesh, {.motion_margin = margin, .rebuild_policy = RebuildPolicy::in_commit});
      QueryCache cache;
      for (std::uint32_t i = 0; i < 6 * scale; ++i) {
        const std::vector<Vec3> positions = motion.positions(0.7 * i);
        if (i % 3 == 2) {
          const std::vector<VertexId> ids{0, static_cast<VertexId>(positions.size() / 2)};
          model.move_vertices(ids, std::vector<Vec3>{positions[ids[0]], positions[ids[1]]}).value();
        } else {
          model.move_all(positions).value();
        }
        model.commit();
        ask_two(digest, model, {ball_model, random_pose(rng, 2)}, nullptr, {});
        ask_two(digest, model, {ball_model, {{}, {1.5 + 0.001 * i, 0.5, 1}}}, &cache, {});
      }
    }
  }
  hashes.push_back(digest.result());
}

template <typename T, typename Visit>
std::vector<T> collected(const Visit& visit) {
  std::vector<T> found;
  visit([&](const T& one) { return found.push_back(one), true; });
  return found;
}

void ask_lists(Hashes& hashes, std::uint32_t scale) {
  Digest lists("lists of pairs"), elements("elements"), self("one model with itself");
  Rng rng(5);
  for (const Pair& p : pairs()) {
    for (std::uint32_t i = 0; i < 4 * scale; ++i) {
      const Placed b{p.b, pose(rng, 0.4 * p.reach, i)};
      const bool parallel = i % 2 == 1;
      lists.answer(collected<TrianglePair>(
          [&](auto visit) { static_cast<void>(visit_intersections(p.a, b, visit, {.parallel = parallel})); }));
      lists.answer(collected<Contact>([&](auto visit) {
        static_cast<void>(
            visit_contacts(p.a, b, 0.05, visit, {.oriented_faces = OrientedFaces::both, .parallel = parallel}));
      }));
      std::vector<Contact> closest(7);
      closest.resize(closest_pairs(p.a, b, closest).count);
      lists.answer(closest);
      std::vector<VertexFacePair> vertex_face(200);
      std::vector<EdgeEdgePair> edge_edge(200);
      const ElementPairCount count = element_pairs(p.a, b, 0.03, vertex_face, edge_edge, {.parallel = parallel});
      vertex_face.resize(std::min(count.vertex_face, vertex_face.size()));
      edge_edge.resize(std::min(count.edge_edge, edge_edge.size()));
      elements.answer(vertex_face, edge_edge, count.vertex_face, count.edge_edge);
    }
  }
  for (const Motion& motion : {crumpling_cloth(24), shuffled_soup(300), twisting_bar(4)}) {
    for (std::uint32_t i = 0; i < 2 * scale; ++i) {
      Model model(Mesh::create(motion.positions(180 + 13.7 * i), motion.mesh.triangles()).value());
      self.answer(self_collide(model)), self.answer(self_distance(model));
      self.answer(collected<Contact>(
          [&](auto visit) { static_cast<void>(visit_self_contacts(model, 0.01, visit, {.parallel = i % 2 == 1})); }));
      std::vector<Contact> closest(5);
      closest.resize(self_closest_pairs(model, closest).count);
      self.answer(closest);
    }
  }
  hashes.insert(hashes.end(), {lists.result(), elements.result(), self.result()});
}

void ask_motions(Hashes& hashes, std::uint32_t scale) {
  Digest impacts("impacts of deforming models"), paths("motions of rigid bodies");
  Rng rng(6);
  const Model ball_model(ball(14, 8));
  const Motion cloth = crumpling_cloth(14);
  for (std::uint32_t i = 0; i < 3 * scale; ++i) {
    const Model model(Mesh::create(cloth.positions(9.0 * i), cloth.mesh.triangles()).value());
    MovingModel moving(model), other(ball_model);
    moving.set_motion(cloth.positions(9.0 * i + 20)).value();
    const Transform start{random_rotation(rng), {rng.uniform(0, 2), rng.uniform(0, 2), 1.3}};
    other.set_motion(ball_model.mesh().positions(), start, {start.rotation, start.translation - Vec3{0, 0, 0.8}})
        .value();
    const ImpactOptions options{.time_error = 1e-6, .min_separation = i % 2 == 0 ? 0 : 1e-3, .parallel = i % 3 == 2};
    impacts.answer(time_of_impact(moving, other, options)), impacts.answer(self_time_of_impact(moving, options));
    impacts.answer(
        collected<Impact>([&](auto visit) { static_cast<void>(visit_impacts(moving, other, visit, options)); }));
    impacts.answer(collected<ElementPair>(
        [&](auto visit) { static_cast<void>(visit_self_impact_candidates(moving, visit, options)); }));
    std::vector<double> fractions(model.mesh().positions().size(), 1), displacements(fractions.size(), 0.05);
    limit_self_motions(moving, 1e-4, fractions), limit_self_displacements(model, 1e-4, displacements);
    impacts.answer(fractions), impacts.answer(displacements);
  }
  for (const Pair& p : pairs()) {
    for (std::uint32_t i = 0; i < 3 * scale; ++i) {
      const RigidMotion motion(pose(rng, 2 * p.reach, i), pose(rng, p.reach, i));
      paths.answer(time_of_impact(p.a, RigidMotion{}, p.b, motion)),
          paths.answer(min_distance(p.a, RigidMotion{}, p.b, motion));
    }
  }
  hashes.insert(hashes.end(), {impacts.result(), paths.result()});
}

void ask_solids(Hashes& hashes, std::uint32_t scale) {
  Digest points("points"), solids("solids");
  Rng rng(7);
  const Model a(ring(24, 10, 0.3)), b(ball(16, 10));
  const ClosedSurface surface_a = ClosedSurface::create(a).value(), surface_b = ClosedSurface::create(b).value();
  for (const Pair& p : pairs()) {
    for (std::uint32_t i = 0; i < 40 * scale; ++i) {
      const Vec3 point = random_point(rng, p.reach);
      points.answer(closest_point(p.a, point).closest);
      points.answer(surface_a.signed_distance(random_point(rng, 1.5)));
      points.answer(generalized_winding_number(p.b, point));
    }
  }
  for (std::uint32_t i = 0; i < 6 * scale; ++i) {
    const Transform there = pose(rng, 1.5, i);
    const PlacedSurface placed_a{surface_a}, placed_b{surface_b, there};
    solids.answer(solid_relation(placed_a, placed_b)), solids.answer(deepest_vertices(placed_a, placed_b));
    solids.answer(separating_translation(placed_a, placed_b, random_point(rng, 1)));
    solids.answer(signed_distance(placed_a, placed_b, {.relative_error = 0.2, .budget = {.max_steps = 20'000}}));
    ask_two(solids, Body(surface_a), {Body(surface_b), there}, nullptr, {});
  }
  hashes.insert(hashes.end(), {points.result(), solids.result()});
}

void ask_scenes(Hashes& hashes, std::uint32_t scale) {
  Digest digest("scenes");
  Rng rng(8);
  const Model a(ring(20, 8, 0.2)), b(ball(12, 8));
  const Shape box = Shape::box({0.3, 0.2, 0.1});
  for (std::uint32_t i = 0; i < scale; ++i) {
    Scene scene;
    std::vector<ObjectId> ids;
    for (int k = 0; k < 40; ++k) {
      const Transform there = random_pose(rng, 4);
      ids.push_back(scene.add(k % 3 == 0 ? Placed(a, there) : k % 3 == 1 ? Placed(b, there) : Placed(box, there)));
    }
    scene.commit();
    const auto candidates =
        collected<ObjectPair>([&](auto visit) { static_cast<void>(scene.visit_candidate_pairs(0.3, visit)); });
    digest.answer(candidates);
    std::vector<DistanceResult> distances(candidates.size());
    std::vector<CollideResult> collisions(candidates.size());
    scene.distance(candidates, distances), scene.collide(candidates, collisions);
    for (const DistanceResult& r : distances) digest.answer(r);
    for (const CollideResult& r : collisions) digest.answer(r);
    ObjectContacts contacts;
    scene.contacts(candidates, 0.1, contacts);
    digest.answer(contacts.contacts, contacts.offsets);
    const ClosestObjectsResult closest = scene.closest_objects();
    digest.answer(closest.objects, closest.result);
    const AnyWithinResult any = scene.any_within(0.05);
    digest.answer(any.objects, any.result);
    const ClosestObjectResult one = scene.closest_object({b, random_pose(rng, 5)});
    digest.answer(one.object, one.result);
    const ObjectImpactResult hit = scene.time_of_impact(b, RigidMotion(random_pose(rng, 8), random_pose(rng, 8)));
    digest.answer(hit.object, hit.result);
    std::vector<Transform> poses(24);
    for (Transform& there : poses) there = random_pose(rng, 4);
    std::vector<ClosestObjectsResult> many(8);
    scene.closest_objects_many(std::span(ids).first(3), poses, many);
    for (const ClosestObjectsResult& r : many) digest.answer(r.objects, r.result);
  }
  hashes.push_back(digest.result());
}

}  // namespace

std::vector<AnswerHash> answer_hashes(std::uint32_t scale) {
  std::vector<AnswerHash> hashes;
  for (const auto ask : {ask_static, ask_with_caches, ask_deforming, ask_lists, ask_motions, ask_solids, ask_scenes}) {
    ask(hashes, scale);
  }
  return hashes;
}

std::uint64_t total(const std::vector<AnswerHash>& hashes) {
  std::uint64_t result = 0;
  for (const AnswerHash& h : hashes) result = (result ^ h.hash) * 0x100000001b3;
  return result;
}

}  // namespace limber::scenes
