// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "arguments.h"
#include "bindings.h"
#include "docstrings.h"
#include "limber/limber.h"
#include "records.h"
#include "value_class.h"

namespace limber::python {
namespace {

using ObjectFilter = Named<"ObjectFilter">;
using Filter = PairFilter<ObjectPairFilter>;
using SceneCacheObject = CacheObject<SceneCache>;

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

  ObjectId add(nb::handle_t<ModelObject> model, const PoseLike& pose) {
    auto& object = nb::cast<ModelObject&>(model);
    const Transform placed = pose_from(pose, "pose");
    const Changing guard = changing();
    const Reading model_guard = reading(object);
    const auto [entry, is_new] = models_.try_emplace(&object, Shared{nb::borrow(model), 0});
    try {
      model_of_.reserve(scene_.size() + model_of_.size() + 1);
      const ObjectId id = scene_.add({object.model, placed});
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
    const Changing guard = changing();
    const std::vector<Reading> guards = reading_models();
    without_gil([&] { scene_.commit(); });
  }

  Named<"Model"> model(ObjectId id) {
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
    for (auto& [model, shared] : models_) guards.push_back(reading(*model));
    return guards;
  }

  Users users_;
  std::map<ModelObject*, Shared> models_;
  std::vector<ModelObject*> model_of_;  // by id; nullptr where there is no object
  Scene scene_;                         // ends before the models that it refers to
};

IdArray candidate_pairs_of(SceneObject& self, double margin, const ObjectFilter& filter) {
  const Filter which(filter);
  std::vector<ObjectPair> pairs;
  self.read([&](const Scene& scene) {
    without_gil_unless(which.needs_gil(), [&] {
      scene.visit_candidate_pairs(margin, [&](const ObjectPair& pair) { return pairs.push_back(pair), true; },
                                  {which.get()});
    });
  });
  return array_of(std::span<const ObjectPair>(pairs), nb::str("uint32"), {pairs.size(), 2});
}

/// Asks query(scene, pairs, results, cache) about pairs of objects; its answers as an array of records.
template <typename Result, typename Query>
RecordArray asked_of_pairs(SceneObject& self, nb::handle pairs, SceneCacheObject* cache, nb::handle dtype,
                           const Query& query) {
  const Used used(cache);
  std::vector<ObjectPair> asked;
  for (const auto& [a, b] : id_pairs_from(pairs, "pairs")) asked.push_back({a, b});
  std::vector<Result> results(asked.size());
  self.read([&](const Scene& scene) { without_gil([&] { query(scene, asked, results, used.get()); }); });
  return recorded(results, dtype);
}

RecordArray collide_pairs(SceneObject& self, const ArrayLike& pairs, SceneCacheObject* cache) {
  return asked_of_pairs<CollideResult>(self, pairs, cache, dtypes().collide,
                                       [](const Scene& scene, const auto& asked, auto& results, SceneCache* c) {
                                         scene.collide(asked, results, {.cache = c});
                                       });
}

RecordArray pairs_within(SceneObject& self, const ArrayLike& pairs, double max_distance, SceneCacheObject* cache) {
  return asked_of_pairs<CollideResult>(self, pairs, cache, dtypes().collide,
                                       [&](const Scene& scene, const auto& asked, auto& results, SceneCache* c) {
                                         scene.within(asked, max_distance, results, {.cache = c});
                                       });
}

RecordArray pair_distances(SceneObject& self, const ArrayLike& pairs, double relative_error, double absolute_error,
                           double max_distance, SceneCacheObject* cache) {
  return asked_of_pairs<DistanceResult>(
      self, pairs, cache, dtypes().distance, [&](const Scene& scene, const auto& asked, auto& results, SceneCache* c) {
        scene.distance(asked, results, {relative_error, absolute_error, max_distance, c});
      });
}

ClosestObjects closest_objects_of(SceneObject& self, double relative_error, double absolute_error, double max_distance,
                                  const ObjectFilter& filter, SceneCacheObject* cache) {
  const Filter which(filter);
  const Used used(cache);
  return self.read([&](const Scene& scene) {
    return without_gil_unless(which.needs_gil(), [&] {
      return scene.closest_objects({relative_error, absolute_error, max_distance, which.get(), used.get()});
    });
  });
}

FloatArray pose_of(SceneObject& self, ObjectId id) {
  const Transform pose = self.look([&](const Scene& scene) { return scene.object(id).pose; });
  const std::array<double, 16> matrix = matrix_of(pose, MatrixOrder::row_major);
  return array_of(std::span<const double>(matrix), nb::str("float64"), {4, 4});
}

bool contains(SceneObject& self, nb::handle id) {
  ObjectId number = no_id;
  return nb::try_cast(id, number) && self.look([&](const Scene& scene) { return scene.contains(number); });
}

/// The docstring of a query of pairs of objects.
std::string asked_documentation(const char* dtype) {
  return std::string(docs::Scene_collide) +
         "\n\nShape    pairs is (n, 2), of ids.\nReturns  An array of n records, limber3d." + dtype;
}

}  // namespace

void bind_scene(nb::module_& m) {
  ValueClass<ClosestObjects>(m, "ClosestObjects", docs::ClosestObjects)
      .field("objects", &ClosestObjects::objects, "The ids of the two, or None if the result has no witness.")
      .field("result", &ClosestObjects::result, docs::ClosestObjects_result);
  nb::class_<SceneCacheObject>(m, "SceneCache", docs::SceneCache)
      .def(nb::init<std::size_t>(), "max_pairs"_a = SceneCache::usual_max_pairs)
      .def("clear", &clear<SceneCache>, docs::SceneCache_clear);
  nb::class_<SceneObject>(m, "Scene", docs::Scene, nb::type_slots(collectable<SceneObject>))
      .def(nb::init<>())
      .def("add", &SceneObject::add, "model"_a, "pose"_a = nb::none(), docs::Scene_add)
      .def("remove", &SceneObject::remove, "id"_a, docs::Scene_remove)
      .def("set_pose", &SceneObject::set_pose, "id"_a, "pose"_a.none(), docs::Scene_set_pose)
      .def("set_poses", &SceneObject::set_poses, "ids"_a, "poses"_a.none(), docs::Scene_set_poses)
      .def("commit", &SceneObject::commit, docs::Scene_commit)
      .def_prop_ro(
          "is_committed",
          [](SceneObject& self) { return self.read([](const Scene& scene) { return scene.is_committed(); }); },
          docs::Scene_is_committed)
      .def("__len__", [](SceneObject& self) { return self.look([](const Scene& scene) { return scene.size(); }); })
      .def("__contains__", &contains, nb::sig("def __contains__(self, id: object, /) -> bool"),
           "Whether that is the id of an object.")
      .def_prop_ro(
          "id_bound", [](SceneObject& self) { return self.look([](const Scene& scene) { return scene.id_bound(); }); },
          docs::Scene_id_bound)
      .def("model", &SceneObject::model, "id"_a, "The model of an object.")
      .def("pose", &pose_of, "id"_a, "world_from_model of an object, 4 x 4.")
      .def(
          "bounding_box",
          [](SceneObject& self, ObjectId id) {
            return self.read([&](const Scene& scene) { return scene.bounding_box(id); });
          },
          "id"_a, docs::Scene_bounding_box)
      .def("candidate_pairs", &candidate_pairs_of, "margin"_a, nb::kw_only(), "filter"_a = nb::none(),
           docs::Scene_visit_candidate_pairs)
      .def("collide", &collide_pairs, "pairs"_a, nb::kw_only(), "cache"_a = nb::none(),
           asked_documentation("collide_dtype.").c_str())
      .def("within", &pairs_within, "pairs"_a, "max_distance"_a, nb::kw_only(), "cache"_a = nb::none(),
           asked_documentation("collide_dtype.").c_str())
      .def("distance", &pair_distances, "pairs"_a, nb::kw_only(), "relative_error"_a = 0.0, "absolute_error"_a = 0.0,
           max_distance_argument(), "cache"_a = nb::none(),
           (asked_documentation("distance_dtype, with these fields.") + distance_fields()).c_str())
      .def("closest_objects", &closest_objects_of, nb::kw_only(), "relative_error"_a = 0.0, "absolute_error"_a = 0.0,
           max_distance_argument(), "filter"_a = nb::none(), "cache"_a = nb::none(), docs::Scene_closest_objects);
}

}  // namespace limber::python
