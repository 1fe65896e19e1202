// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Random scenes, in which objects are added, removed and moved, and models deform, next to brute force.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "limber/scene.h"
#include "reference/reference.h"
#include "support/brute_force.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// A scene, and beside it what is in it.
struct SceneCase {
  explicit SceneCase(std::uint64_t seed) : rng(seed) {
    scale = rng.below(3) == 0 ? std::ldexp(1.0, static_cast<int>(rng.below(600)) - 540) : 1;
    offset = rng.below(4) == 0 ? uniform_point(rng, -1e6, 1e6) : Vec3{};
    range = std::pow(10.0, rng.uniform(-1, 2));
    for (std::uint64_t i = 0, count = 1 + rng.below(3); i < count; ++i) {
      // Tiny ones beside huge ones, now and then.
      const double size = rng.below(4) == 0 ? std::ldexp(scale, static_cast<int>(rng.below(80)) - 40) : scale;
      models.push_back(std::make_unique<Model>(arbitrary_mesh(rng, 5, {}, size)));
    }
    for (std::uint64_t i = 0, count = rng.below(7); i < count; ++i) add();
  }

  Transform pose() {
    Transform pose = random_pose(rng, range);
    if (rng.below(4) == 0) pose.rotation = {};
    if (rng.below(8) == 0) pose.translation = {};
    if (rng.below(30) == 0) pose.translation *= 0x1p50;
    pose.translation = (pose.translation + offset) * scale;
    return pose;
  }
  void add() {
    const std::size_t model = rng.below(models.size());
    const Transform at = pose();
    const ObjectId id = scene.add({*models[model], at});
    if (id >= objects.size()) objects.resize(id + 1);
    RC_ASSERT(!objects[id]);
    objects[id] = {models[model].get(), at};
  }
  void deform() {
    Model& model = *models[rng.below(models.size())];
    const double step = std::pow(10.0, rng.uniform(-6, 0)) * model.bounding_sphere().radius;
    testing::deform(model, [&](const Vec3& p) { return p + step * uniform_point(rng); });
  }
  void change() {
    const ObjectId id = objects.empty() ? 0 : static_cast<ObjectId>(rng.below(objects.size()));
    switch (rng.below(6)) {
      case 0:
        return add();
      case 1:
        if (!scene.contains(id)) return;
        scene.remove(id);
        objects[id].reset();
        return;
      case 2:
        return deform();
      default:
        if (!scene.contains(id)) return;
        objects[id]->pose = pose();
        scene.set_pose(id, objects[id]->pose);
    }
  }

  /// What rounding is relative to.
  double size() const {
    double largest = 0;
    for (const std::optional<Object>& o : objects) {
      if (!o) continue;
      const Sphere sphere = o->model->bounding_sphere();
      largest = std::max(largest, max_abs(o->pose.translation) + max_abs(sphere.center) + sphere.radius);
    }
    return largest;
  }

  struct Object {
    const Model* model;
    Transform pose;
  };
  Rng rng;
  double scale, range;
  Vec3 offset;
  std::vector<std::unique_ptr<Model>> models;
  limber::Scene scene;
  std::vector<std::optional<Object>> objects;  // by id
};

// python-fcl #28: with managers of bodies, the points are not as far apart as the distance.
// trimesh #1055: the distance is right, but the name of the mesh and the points are those of another pair.
void require_witness(const SceneCase& c, const ObjectPair& pair, const Witness& w, double distance, double tolerance) {
  const auto lies_on = [&](const Vec3& point, ObjectId id, TriangleId triangle) {
    const Triangle t = mapped(c.objects[id]->model->mesh().triangle(triangle), c.objects[id]->pose);
    return closest_points(point, t).distance <= tolerance;
  };
  RC_ASSERT(lies_on(w.point_a, pair.a, w.triangle_a) && lies_on(w.point_b, pair.b, w.triangle_b));
  const double apart = closest_points(w.point_a, Triangle{w.point_b, w.point_b, w.point_b}).distance;
  RC_ASSERT(std::abs(apart - distance) <= 2 * tolerance);
}

RC_GTEST_PROP(Scenes, MissNoPairThatIsWithinTheMargin, (std::uint64_t seed)) {
  SceneCase c(seed);
  SceneCache cache(4);
  for (int step = 0; step < 3; ++step) {
    for (std::uint64_t i = 0, count = c.rng.below(4); i < count; ++i) c.change();
    c.scene.commit();
    RC_ASSERT(c.scene.size() == static_cast<std::size_t>(std::count_if(c.objects.begin(), c.objects.end(),
                                                                       [](const auto& o) { return o.has_value(); })));
    const double margin = c.rng.below(3) == 0 ? 0 : c.scale * c.range * c.rng.uniform(0, 0.3);
    std::vector<ObjectPair> pairs(c.objects.size() * c.objects.size());
    const auto are_far = [&](ObjectId a, ObjectId b) {
      return std::find(pairs.begin(), pairs.end(), ObjectPair{a, b}) == pairs.end();
    };
    pairs.resize(c.scene.candidate_pairs(margin, pairs).count);
    double closest = INFINITY;
    for (ObjectId a = 0; a < c.objects.size(); ++a) {
      for (ObjectId b = a + 1; b < c.objects.size(); ++b) {
        if (!c.objects[a] || !c.objects[b]) {
          RC_ASSERT(are_far(a, b));
          continue;
        }
        const reference::Placed placed_a{c.objects[a]->model->mesh(), c.objects[a]->pose};
        const reference::Placed placed_b{c.objects[b]->model->mesh(), c.objects[b]->pose};
        const double distance = brute_force_distance(placed_a, placed_b);
        closest = std::min(closest, distance);
        const bool is_within = within(c.scene.object(a), c.scene.object(b), margin).is_yes();
        RC_ASSERT(!are_far(a, b) || (distance > margin && !is_within));
        // The distance itself is a margin too.
        const double exactly = limber::distance(c.scene.object(a), c.scene.object(b)).upper;
        bool is_candidate = false;
        const auto visit = [&](const ObjectPair& pair) { return !(is_candidate = pair == ObjectPair{a, b}); };
        c.scene.visit_candidate_pairs(exactly, visit);
        RC_ASSERT(is_candidate);
        is_candidate = false;
        c.scene.visit_candidates(c.scene.object(a), exactly, [&](ObjectId id) { return !(is_candidate = id == b); });
        RC_ASSERT(is_candidate);
      }
    }
    const ClosestObjectsResult found = c.scene.closest_objects({.cache = c.rng.below(2) == 0 ? &cache : nullptr});
    if (std::isinf(closest)) {
      RC_ASSERT(found.result.status == DistanceStatus::beyond_limit);
      continue;
    }
    const double tolerance = 1e-13 * (c.size() + closest);
    RC_ASSERT((found.result.upper == 0) == (closest == 0));
    RC_ASSERT(std::abs(found.result.upper - closest) <= tolerance);
    RC_ASSERT(found.result.status == (closest == 0 ? DistanceStatus::collision : DistanceStatus::exact));
    RC_ASSERT(found.result.lower == found.result.upper);
    require_witness(c, found.objects, *found.result.witness, closest, tolerance);
    const DistanceResult rough = c.scene.closest_objects({.distance = {.relative_error = 0.2}}).result;
    RC_ASSERT(rough.lower <= closest + tolerance && closest - tolerance <= rough.upper);
    RC_ASSERT(rough.upper <= 1.2 * closest + tolerance);
    // Whether any two objects are within a distance, where that is enough and where it is not.
    const AnyWithinResult any = c.scene.any_within(found.result.upper), none = c.scene.any_within(0.99 * closest);
    RC_ASSERT(any.result.is_yes());
    require_witness(c, any.objects, *any.result.witness, closest, tolerance);
    RC_ASSERT(none.result.is_yes() == (closest <= 0.99 * closest) && none.result.is_yes() != none.result.is_no());
    if (closest <= 1000 * tolerance) continue;
    const ClosestObjectsResult beyond = c.scene.closest_objects({.distance = {.max_distance = 0.99 * closest}});
    RC_ASSERT(beyond.result.status == DistanceStatus::beyond_limit && beyond.objects == ObjectPair{});
    RC_ASSERT(beyond.result.lower == 0.99 * closest);
    const double near = c.scene.closest_objects({.distance = {.max_distance = 1.01 * closest}}).result.upper;
    RC_ASSERT(std::abs(near - closest) <= tolerance);
  }
}

RC_GTEST_PROP(Scenes, AnswerManyConfigurationsAsBruteForce, (std::uint64_t seed)) {
  SceneCase c(seed);
  c.scene.commit();
  std::vector<ObjectId> ids;
  for (ObjectId id = 0; id < c.objects.size(); ++id) {
    if (c.rng.below(4) > 0) ids.push_back(id);
  }
  ObjectPairMatrix counts(c.objects.size());
  for (std::uint64_t i = c.rng.below(6); i > 0 && c.objects.size() > 1; --i) {
    const auto a = static_cast<ObjectId>(c.rng.below(c.objects.size() - 1));
    counts.set(a, a + 1 + static_cast<ObjectId>(c.rng.below(c.objects.size() - 1 - a)), false);
  }
  const double margin = c.rng.below(3) == 0 ? 0 : c.scale * c.range * c.rng.uniform(0, 0.3);
  const std::size_t count = c.rng.below(4);
  std::vector<Transform> poses(count * ids.size());
  for (Transform& pose : poses) pose = c.pose();
  std::vector<ClosestObjectsResult> closest(count);
  std::vector<AnyWithinResult> any(count);
  c.scene.closest_objects_many(ids, poses, closest, {.filter = counts});
  c.scene.any_within_many(ids, poses, margin, any, {.filter = counts});
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t j = 0; j < ids.size(); ++j) c.objects[ids[j]]->pose = poses[k * ids.size() + j];
    double truth = INFINITY;
    bool is_any = false;
    for (ObjectId b = 0; b < c.objects.size(); ++b) {
      for (ObjectId a = 0; a < b; ++a) {
        if (!counts(a, b)) continue;
        const Placed placed_a{*c.objects[a]->model, c.objects[a]->pose};
        const Placed placed_b{*c.objects[b]->model, c.objects[b]->pose};
        truth = std::min(truth, limber::distance(placed_a, placed_b).upper);
        is_any = is_any || within(placed_a, placed_b, margin).is_yes();
      }
    }
    RC_ASSERT(any[k].result.is_yes() == is_any);
    RC_ASSERT(any[k].result.is_no() != is_any);
    RC_ASSERT((closest[k].result.upper == 0) == (truth == 0));
    const ObjectPair named = closest[k].objects;
    const bool is_left_out = named.a != no_id && !counts(named.a, named.b);
    RC_ASSERT(!is_left_out);
    RC_ASSERT(std::isinf(truth) == (closest[k].result.status == DistanceStatus::beyond_limit));
    RC_ASSERT(std::isinf(truth) || std::abs(closest[k].result.upper - truth) <= 1e-13 * (c.size() + truth));
  }
}

}  // namespace
}  // namespace limber::testing
