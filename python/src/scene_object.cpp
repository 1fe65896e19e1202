// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_object.h"

#include "query_arguments.h"

namespace limber::python {

std::vector<Reading> SceneObject::reading_models() {
  std::vector<Reading> guards;
  guards.reserve(models_.size());
  for (auto& [model, shared] : models_) guards.push_back(reading(*model));
  return guards;
}

ObjectId SceneObject::add(nb::handle_t<ModelObject> model, const Transform& pose) {
  auto& object = nb::cast<ModelObject&>(model);
  const Changing guard(users_, refusal_to_change);
  const Reading model_guard = reading(object);
  const auto [entry, is_new] = models_.try_emplace(&object, Shared{nb::borrow(model), 0});
  try {
    model_of_.reserve(scene_.size() + model_of_.size() + 1);
    const ObjectId id = scene_.add({object.model, pose});
    if (id >= model_of_.size()) model_of_.resize(id + 1, nullptr);
    model_of_[id] = &object;
    ++entry->second.objects;
    return id;
  } catch (...) {
    if (is_new) models_.erase(entry);
    throw;
  }
}

void SceneObject::remove(ObjectId id) {
  const Changing guard(users_, refusal_to_change);
  scene_.remove(id);
  const auto entry = models_.find(model_of_[id]);
  model_of_[id] = nullptr;
  if (--entry->second.objects == 0) models_.erase(entry);
}

void SceneObject::set_pose(ObjectId id, const Transform& pose) {
  const Changing guard(users_, refusal_to_change);
  scene_.set_pose(id, pose);
}

void SceneObject::set_poses(std::span<const ObjectId> ids, std::span<const Transform> poses) {
  const Changing guard(users_, refusal_to_change);
  without_gil([&] { scene_.set_poses(ids, poses); });
}

void SceneObject::commit() {
  const Changing guard(users_, refusal_to_change);
  const std::vector<Reading> guards = reading_models();
  without_gil([&] { scene_.commit(); });
}

int SceneObject::visit_references(visitproc visit, void* argument) const {
  for (const auto& [model, shared] : models_) {
    if (const int result = visit(shared.owner.ptr(), argument); result != 0) return result;
  }
  return 0;
}

nb::object SceneObject::model(ObjectId id) {
  return look([&](const Scene& scene) {
    (void)scene.object(id);  // throws unless there is such an object
    return models_.at(model_of_[id]).owner;
  });
}

}  // namespace limber::python
