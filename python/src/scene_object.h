// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <map>
#include <utility>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "interrupts.h"
#include "limber/scene.h"

namespace limber::python {

/// A scene as Python holds it, with the models that its objects refer to.
///
/// Threads  Functions are called with the GIL. Queries read the scene and all of its models.
class SceneObject {
 public:
  /// Calls query(scene) while nobody changes the scene; models may change meanwhile.
  template <typename Query>
  auto look(const Query& query) {
    const Reading guard =
        users_.read("the scene is being changed by another thread, or by a call that has not returned");
    return query(static_cast<const Scene&>(scene_));
  }

  /// Calls query(scene) while nobody changes the scene or one of its models.
  template <typename Query>
  auto read(const Query& query) {
    return look([&](const Scene& scene) {
      const std::vector<Reading> guards = reading_models();
      return query(scene);
    });
  }

  ObjectId add(nb::handle_t<BodyObject> model, const PoseLike& pose) {
    auto& object = nb::cast<BodyObject&>(model);
    const Transform placed = pose_from(pose, "pose");
    const Changing guard = changing();
    const Reading model_guard = reading(object);
    const auto [entry, is_new] = models_.try_emplace(&object, Shared{nb::borrow(model), 0});
    try {
      if (model_of_.size() == model_of_.capacity()) model_of_.reserve(2 * model_of_.size() + 1);
      const ObjectId id = scene_.add(Placed(object.body(), placed));
      if (id >= model_of_.size()) model_of_.resize(id + 1, nullptr);
      model_of_[id] = &object;
      ++entry->second.objects;
      return id;
    } catch (...) {
      if (is_new) models_.erase(entry);
      throw;
    }
  }

  void remove(ObjectId id) {
    const Changing guard = changing();
    scene_.remove(id);
    const auto entry = models_.find(model_of_[id]);
    model_of_[id] = nullptr;
    if (--entry->second.objects == 0) models_.erase(entry);
  }

  void set_pose(ObjectId id, const PoseLike& pose) {
    const Transform placed = pose_from(pose, "pose");
    const Changing guard = changing();
    scene_.set_pose(id, placed);
  }

  void set_poses(const ArrayLike& ids, const PosesLike& poses) {
    const std::vector<ObjectId> objects = ids_from(ids, "ids");
    const PoseList list(poses, "poses");
    const std::vector<Transform> placed =
        list.is_one_for_all() ? std::vector<Transform>(objects.size(), list[0]) : list.poses();
    const Changing guard = changing();
    without_gil([&] { scene_.set_poses(objects, placed); });
  }

  void commit() {
    aside(scene_.size(), [this, owner = nb::find(*this), guard = changing(), guards = reading_models()] {
      return scene_.commit(), true;
    });
  }

  Named<"Body"> model(ObjectId id) {
    return look([&](const Scene& scene) {
      (void)scene.object(id);  // throws unless there is such an object
      return models_.at(model_of_[id]).owner;
    });
  }

  /// For the garbage collector: calls visit(object, argument) for what this keeps alive, until it returns something
  /// other than 0; returns that.
  int visit_references(visitproc visit, void* argument) const {
    for (const auto& [model, shared] : models_) {
      if (const int result = visit(shared.owner.ptr(), argument); result != 0) return result;
    }
    return 0;
  }

 private:
  struct Shared {
    nb::object owner;
    std::size_t objects = 0;  // that show the model
  };

  Changing changing() {
    return users_.change("the scene is in use by another thread, or by a query that has not returned");
  }

  std::vector<Reading> reading_models() {
    std::vector<Reading> guards;
    guards.reserve(models_.size());
    for (auto& [model, shared] : models_) {
      guards.push_back(reading(*model));
      (void)model->body();  // throws where the surface of a solid is no longer known to be closed
    }
    return guards;
  }

  Users users_;
  std::map<BodyObject*, Shared> models_;
  std::vector<BodyObject*> model_of_;  // by id; nullptr where there is no object
  Scene scene_;                        // ends before the models that it refers to
};

}  // namespace limber::python
