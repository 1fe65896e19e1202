// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
#include "limber/limber.h"
#include "poses.h"
#include "query_arguments.h"
#include "records.h"
#include "scene_object.h"
#include "value_class.h"

namespace limber::python {
namespace {

using ObjectFilter = PairFilter<ObjectPairFilter>;

nb::object candidate_pairs_of(SceneObject& self, double margin, nb::handle filter) {
  const ObjectFilter which(filter);
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
template <typename Result, typename Record, typename Query>
nb::object asked_of_pairs(SceneObject& self, nb::handle pairs, SceneCacheObject* cache, nb::handle dtype,
                          const Query& query) {
  const Used used(cache);
  std::vector<ObjectPair> asked;
  for (const auto& [a, b] : id_pairs_from(pairs, "pairs")) asked.push_back({a, b});
  std::vector<Result> results(asked.size());
  self.read([&](const Scene& scene) { without_gil([&] { query(scene, asked, results, used.get()); }); });
  std::vector<Record> records;
  records.reserve(results.size());
  for (const Result& result : results) records.push_back(record_of(result));
  return array_of(std::span<const Record>(records), dtype);
}

nb::object collide_pairs(SceneObject& self, nb::handle pairs, SceneCacheObject* cache) {
  return asked_of_pairs<CollideResult, CollideRecord>(
      self, pairs, cache, dtypes().collide, [](const Scene& scene, const auto& asked, auto& results, SceneCache* c) {
        scene.collide(asked, results, {.cache = c});
      });
}

nb::object pairs_within(SceneObject& self, nb::handle pairs, double max_distance, SceneCacheObject* cache) {
  return asked_of_pairs<CollideResult, CollideRecord>(
      self, pairs, cache, dtypes().collide, [&](const Scene& scene, const auto& asked, auto& results, SceneCache* c) {
        scene.within(asked, max_distance, results, {.cache = c});
      });
}

nb::object pair_distances(SceneObject& self, nb::handle pairs, double relative_error, double absolute_error,
                          double max_distance, SceneCacheObject* cache) {
  return asked_of_pairs<DistanceResult, DistanceRecord>(
      self, pairs, cache, dtypes().distance, [&](const Scene& scene, const auto& asked, auto& results, SceneCache* c) {
        scene.distance(asked, results, {relative_error, absolute_error, max_distance, c});
      });
}

ClosestObjects closest_objects_of(SceneObject& self, double relative_error, double absolute_error, double max_distance,
                                  nb::handle filter, SceneCacheObject* cache) {
  const ObjectFilter which(filter);
  const Used used(cache);
  return self.read([&](const Scene& scene) {
    return without_gil_unless(which.needs_gil(), [&] {
      return scene.closest_objects({relative_error, absolute_error, max_distance, which.get(), used.get()});
    });
  });
}

void set_poses_of(SceneObject& self, nb::handle ids, nb::handle poses) {
  const Ids objects(ids, "ids");
  const PoseList list(poses, "poses");
  if (!list.is_one_for_all()) return self.set_poses(objects.view(), list.poses());
  self.set_poses(objects.view(), std::vector<Transform>(objects.view().size(), list[0]));
}

void bind_scene_results(nb::module_& m) {
  ValueClass<ClosestObjects>(m, "ClosestObjects", docs::ClosestObjects)
      .field("objects", &ClosestObjects::objects, "The ids of the two, or None if the result has no witness.")
      .field("result", &ClosestObjects::result, docs::ClosestObjects_result);
  nb::class_<SceneCacheObject>(m, "SceneCache", docs::SceneCache)
      .def(nb::init<std::size_t>(), "max_pairs"_a = SceneCache::usual_max_pairs)
      .def(
          "clear",
          [](SceneCacheObject& self) {
            const Used used(&self);
            used.get()->clear();
          },
          docs::SceneCache_clear);
}

/// The docstring of a query of pairs of objects.
std::string asked_documentation(const char* dtype) {
  return std::string(docs::Scene_collide) +
         "\n\nShape    pairs is (n, 2), of ids.\nReturns  An array of n records, limber3d." + dtype;
}

}  // namespace

void bind_scene(nb::module_& m) {
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  bind_scene_results(m);
  nb::class_<SceneObject>(m, "Scene", docs::Scene, nb::type_slots(collectable<SceneObject>))
      .def(nb::init<>())
      .def(
          "add",
          [](SceneObject& self, nb::handle_t<ModelObject> model, nb::handle pose) {
            return self.add(model, pose_from(pose, "pose"));
          },
          "model"_a, "pose"_a = nb::none(), nb::sig("def add(self, model: Model, pose: PoseLike = None) -> int"),
          docs::Scene_add)
      .def("remove", &SceneObject::remove, "id"_a, docs::Scene_remove)
      .def(
          "set_pose",
          [](SceneObject& self, ObjectId id, nb::handle pose) { self.set_pose(id, pose_from(pose, "pose")); }, "id"_a,
          "pose"_a.none(), nb::sig("def set_pose(self, id: int, pose: PoseLike) -> None"), docs::Scene_set_pose)
      .def("set_poses", &set_poses_of, "ids"_a, "poses"_a.none(),
           nb::sig("def set_poses(self, ids: ArrayLike, poses: PosesLike) -> None"), docs::Scene_set_poses)
      .def("commit", &SceneObject::commit, docs::Scene_commit)
      .def_prop_ro(
          "is_committed",
          [](SceneObject& self) { return self.read([](const Scene& scene) { return scene.is_committed(); }); },
          docs::Scene_is_committed)
      .def("__len__", [](SceneObject& self) { return self.look([](const Scene& scene) { return scene.size(); }); })
      .def(
          "__contains__",
          [](SceneObject& self, nb::handle id) {
            ObjectId number = no_id;
            return nb::try_cast(id, number) && self.look([&](const Scene& scene) { return scene.contains(number); });
          },
          nb::sig("def __contains__(self, id: object, /) -> bool"), "Whether that is the id of an object.")
      .def_prop_ro(
          "id_bound", [](SceneObject& self) { return self.look([](const Scene& scene) { return scene.id_bound(); }); },
          docs::Scene_id_bound)
      .def("model", &SceneObject::model, "id"_a, nb::sig("def model(self, id: int) -> Model"),
           "The model of an object.")
      .def(
          "pose",
          [](SceneObject& self, ObjectId id) {
            const Transform pose = self.look([&](const Scene& scene) { return scene.object(id).pose; });
            const std::array<double, 16> matrix = matrix_of(pose, MatrixOrder::row_major);
            return array_of(std::span<const double>(matrix), nb::str("float64"), {4, 4});
          },
          "id"_a, nb::sig("def pose(self, id: int) -> FloatArray"), "world_from_model of an object, 4 x 4.")
      .def(
          "bounding_box",
          [](SceneObject& self, ObjectId id) {
            return self.read([&](const Scene& scene) { return scene.bounding_box(id); });
          },
          "id"_a, docs::Scene_bounding_box)
      .def("candidate_pairs", &candidate_pairs_of, "margin"_a, nb::kw_only(), "filter"_a = nb::none(),
           nb::sig("def candidate_pairs(self, margin: float, *, filter: ObjectFilter = None) -> IdArray"),
           docs::Scene_visit_candidate_pairs)
      .def("collide", &collide_pairs, "pairs"_a, nb::kw_only(), "cache"_a = nb::none(),
           nb::sig("def collide(self, pairs: ArrayLike, *, cache: SceneCache | None = None) -> RecordArray"),
           asked_documentation("collide_dtype.").c_str())
      .def("within", &pairs_within, "pairs"_a, "max_distance"_a, nb::kw_only(), "cache"_a = nb::none(),
           nb::sig("def within(self, pairs: ArrayLike, max_distance: float, *, cache: SceneCache | None = None) "
                   "-> RecordArray"),
           asked_documentation("collide_dtype.").c_str())
      .def("distance", &pair_distances, "pairs"_a, nb::kw_only(), "relative_error"_a = 0.0, "absolute_error"_a = 0.0,
           "max_distance"_a = unlimited, "cache"_a = nb::none(),
           nb::sig("def distance(self, pairs: ArrayLike, *, relative_error: float = 0.0, absolute_error: float = 0.0, "
                   "max_distance: float = float('inf'), cache: SceneCache | None = None) -> RecordArray"),
           (asked_documentation("distance_dtype, with these fields.") + distance_fields()).c_str())
      .def("closest_objects", &closest_objects_of, nb::kw_only(), "relative_error"_a = 0.0, "absolute_error"_a = 0.0,
           "max_distance"_a = unlimited, "filter"_a = nb::none(), "cache"_a = nb::none(),
           nb::sig("def closest_objects(self, *, relative_error: float = 0.0, absolute_error: float = 0.0, "
                   "max_distance: float = float('inf'), filter: ObjectFilter = None, "
                   "cache: SceneCache | None = None) -> ClosestObjects"),
           docs::Scene_closest_objects);
}

}  // namespace limber::python
