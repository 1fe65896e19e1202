// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <map>
#include <vector>

#include "limber/scene.h"
#include "model_object.h"

/// A scene as Python holds it, with the models that its objects refer to.
namespace limber::python {

/// A cache of a scene, and who uses it.
struct SceneCacheObject {
  explicit SceneCacheObject(std::size_t max_pairs) : cache(max_pairs) {}

  SceneCache cache;
  Users users;
};

/// Threads  Functions are called with the GIL. Queries read the scene and all of its models.
class SceneObject {
 public:
  ObjectId add(nb::handle_t<ModelObject> model, const Transform& pose);
  void remove(ObjectId id);
  void set_pose(ObjectId id, const Transform& pose);
  void set_poses(std::span<const ObjectId> ids, std::span<const Transform> poses);
  void commit();

  nb::object model(ObjectId id);

  /// For the garbage collector: calls visit(object, argument) for what this keeps alive, until it returns something
  /// other than 0; returns that.
  int visit_references(visitproc visit, void* argument) const;

  /// Calls query(scene) while nobody changes the scene; models may change meanwhile.
  template <typename Query>
  auto look(const Query& query) {
    const Reading guard(users_, refusal_to_read);
    return query(static_cast<const Scene&>(scene_));
  }

  /// Calls query(scene) while nobody changes the scene or one of its models.
  template <typename Query>
  auto read(const Query& query) {
    const Reading guard(users_, refusal_to_read);
    const std::vector<Reading> guards = reading_models();
    return query(static_cast<const Scene&>(scene_));
  }

 private:
  static constexpr const char* refusal_to_read =
      "the scene is being changed by another thread, or by a call that has not returned";
  static constexpr const char* refusal_to_change =
      "the scene is in use by another thread, or by a query that has not returned";

  struct Shared {
    nb::object owner;
    std::size_t objects = 0;  // that show the model
  };

  std::vector<Reading> reading_models();

  Users users_;
  std::map<ModelObject*, Shared> models_;
  std::vector<ModelObject*> model_of_;  // by id; nullptr where there is no object
  Scene scene_;                         // ends before the models that it refers to
};

}  // namespace limber::python
