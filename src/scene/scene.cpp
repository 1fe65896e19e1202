// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/scene.h"

#include <algorithm>
#include <string>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "geometry/rigid.h"
#include "scene/scene_impl.h"

namespace limber {
namespace {

// Objects whose bounds one task updates.
constexpr std::size_t worth_a_task = 4096;

}  // namespace

Scene::Scene() : impl_(std::make_unique<Impl>()) {}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

const Scene::Impl& Scene::impl(const char* function) const {
  if (impl_ != nullptr) return *impl_;
  base::throw_invalid_argument((std::string("limber::Scene::") + function + ": the scene has been moved from").c_str());
}
Scene::Impl& Scene::impl(const char* function) { return const_cast<Impl&>(std::as_const(*this).impl(function)); }

// --- objects ---

ObjectId Scene::add(const Placed& object) {
  const base::DefaultFloatEnvironment environment;
  Impl& scene = impl("add");
  require_ready(object, "limber::Scene::add", "the model");
  if (!scene.free_ids.empty()) {
    const ObjectId id = scene.free_ids.back();
    scene.objects[id] = {object};
    scene.free_ids.pop_back();
    scene.is_changed = true;
    return id;
  }
  LIMBER_REQUIRE(scene.objects.size() < no_id, "limber::Scene::add: there are more objects than ids can count");
  scene.bounds.resize(scene.objects.size() + 1);
  scene.objects.push_back({object});
  scene.is_changed = true;
  return static_cast<ObjectId>(scene.objects.size() - 1);
}

void Scene::remove(ObjectId id) {
  Impl& scene = impl("remove");
  LIMBER_REQUIRE(scene.contains(id), "limber::Scene::remove: id names no object of the scene");
  scene.free_ids.push_back(id);
  scene.objects[id].exists = false;
  scene.is_changed = true;
}

void Scene::set_pose(ObjectId id, const Transform& world_from_model) {
  const base::DefaultFloatEnvironment environment;
  Impl& scene = impl("set_pose");
  LIMBER_REQUIRE(scene.contains(id), "limber::Scene::set_pose: id names no object of the scene");
  geometry::require_rigid(world_from_model, "limber::Scene::set_pose: the pose");
  scene.set_pose(id, world_from_model);
  scene.is_changed = true;
}

void Scene::set_poses(std::span<const ObjectId> ids, std::span<const Transform> poses) {
  const base::DefaultFloatEnvironment environment;
  Impl& scene = impl("set_poses");
  LIMBER_REQUIRE(ids.size() == poses.size(), "limber::Scene::set_poses: there are not as many poses as ids");
  for (std::size_t i = 0; i < ids.size(); ++i) {
    LIMBER_REQUIRE_ENTRY(scene.contains(ids[i]), "limber::Scene::set_poses: ids", i, "names no object of the scene");
    LIMBER_REQUIRE_ENTRY(geometry::is_rigid(poses[i]), "limber::Scene::set_poses: poses", i,
                         geometry::why_not_rigid(poses[i]).c_str());
  }
  for (std::size_t i = 0; i < ids.size(); ++i) scene.set_pose(ids[i], poses[i]);
  scene.is_changed = scene.is_changed || !ids.empty();
}

std::size_t Scene::size() const {
  const Impl& scene = impl("size");
  return scene.objects.size() - scene.free_ids.size();
}
ObjectId Scene::id_bound() const { return static_cast<ObjectId>(impl("id_bound").objects.size()); }
bool Scene::contains(ObjectId id) const { return impl("contains").contains(id); }

const Placed& Scene::object(ObjectId id) const {
  const Impl& scene = impl("object");
  LIMBER_REQUIRE(scene.contains(id), "limber::Scene::object: id names no object of the scene");
  return scene.placed(id);
}

Box Scene::bounding_box(ObjectId id) const {
  const Impl& scene = impl("bounding_box");
  LIMBER_REQUIRE(scene.contains(id), "limber::Scene::bounding_box: id names no object of the scene");
  LIMBER_REQUIRE(!scene.is_changed, "limber::Scene::bounding_box: objects have changed since the last commit");
  return scene.bounds[id].box;
}

// --- commits ---

bool Scene::Impl::is_committed() const {
  if (is_changed) return false;
  return std::all_of(ids.begin(), ids.end(), [&](ObjectId id) {
    const Object& object = objects[id];
    return object.placed.model().is_committed() && object.state == scene::state_of(object.placed.model());
  });
}

bool Scene::is_committed() const { return impl("is_committed").is_committed(); }

void Scene::Impl::update_bounds(ObjectId id) {
  Object& object = objects[id];
  const scene::ModelState state = scene::state_of(object.placed.model());
  if (!object.is_moved && object.state == state) return;
  if (object.state != state) object.local = scene::local_bounds(object.placed.body());
  bounds[id] = scene::world_bounds(object.local, object.placed.pose);
  object.state = state, object.is_moved = false;
}

void Scene::commit() {
  const base::DefaultFloatEnvironment environment;
  Impl& scene = impl("commit");
  for (ObjectId id = 0; id < scene.objects.size(); ++id) {
    const Impl::Object& object = scene.objects[id];
    LIMBER_REQUIRE(!object.exists || object.placed.model().is_committed(),
                   "limber::Scene::commit: a model of the scene has moves that are not committed, or was moved from");
    LIMBER_REQUIRE_ENTRY(!object.exists || has_its_surface(object.placed.body()), "limber::Scene::commit: objects", id,
                         "is a solid whose model has been reset(): remove it, and add its closed surface anew");
  }
  if (!scene.is_changed && scene.is_committed()) return;
  scene.is_changed = true;  // in case a step throws
  scene.ids.clear();
  for (ObjectId id = 0; id < scene.objects.size(); ++id) {
    if (scene.objects[id].exists) scene.ids.push_back(id);
  }
  base::parallel_for(scene.ids.size(), worth_a_task, [&](std::size_t i) { scene.update_bounds(scene.ids[i]); });
  scene.tree.build(scene.ids, scene.bounds);
  scene.is_changed = false;
}

// --- candidate pairs ---

PairCount Scene::visit_candidate_pairs(double margin, ObjectPairVisitor visit,
                                       std::optional<ObjectPairFilter> filter) const {
  const base::DefaultFloatEnvironment environment;
  const Impl& scene = impl("visit_candidate_pairs");
  LIMBER_REQUIRE(base::is_finite_and_not_negative(margin),
                 "limber::Scene::candidate_pairs: margin must be finite and at least 0");
  scene::require_committed(scene, "limber::Scene::candidate_pairs");
  PairCount found;
  const auto visit_ranks = [&](std::uint32_t rank_a, std::uint32_t rank_b) {
    const ObjectPair pair = scene.pair_of(rank_a, rank_b);
    if (filter && !(*filter)(pair.a, pair.b)) return true;
    ++found.count;
    found.is_complete = visit(pair);
    return found.is_complete;
  };
  const double enlarged = scene::margin_with_error(margin);
  for (std::uint32_t leaf = 0; leaf < scene.tree.leaf_count() && found.is_complete; ++leaf) {
    scene.tree.visit_pairs(leaf, enlarged, visit_ranks);
  }
  return found;
}

PairCount Scene::candidate_pairs(double margin, std::span<ObjectPair> pairs,
                                 std::optional<ObjectPairFilter> filter) const {
  std::size_t count = 0;
  const auto write = [&](const ObjectPair& pair) {
    if (count < pairs.size()) pairs[count] = pair;
    ++count;
    return true;
  };
  return visit_candidate_pairs(margin, write, filter);
}

PairCount Scene::visit_candidates(const Placed& model, double margin, ObjectVisitor visit,
                                  std::optional<ObjectFilter> filter) const {
  const base::DefaultFloatEnvironment environment;
  const Impl& scene = impl("visit_candidates");
  scene::require_committed(scene, "limber::Scene::visit_candidates");
  base::check_margin(margin, "limber::Scene::visit_candidates");
  require_ready(model, "limber::Scene::visit_candidates", "the model");
  const scene::WorldBounds bounds = scene::world_bounds(scene::local_bounds(model.body()), model.pose);
  PairCount found;
  found.is_complete = scene.tree.visit_near(bounds, scene::margin_with_error(margin), [&](std::uint32_t rank) {
    const ObjectId id = scene.tree.id_of(rank);
    if (filter && !(*filter)(id)) return true;
    ++found.count;
    return visit(id);
  });
  return found;
}

}  // namespace limber
