// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "bindings.h"
#include "budget.h"
#include "docstrings.h"
#include "interrupts.h"
#include "limber/limber.h"
#include "records.h"
#include "scene_object.h"
#include "value_class.h"

namespace limber::python {
namespace {

using Filter = PairFilter<ObjectPairFilter>;
using SceneCacheObject = CacheObject<SceneCache>;

/// Calls search(scene, visitor, filter) and returns what the visitor is given. Ctrl-C ends it: whatever it meets then
/// counts, so that it asks the visitor.
template <typename Found, typename Which, typename Search>
std::deque<Found> found_in(SceneObject& self, const Which& which, const Search& search) {
  const auto filter = which.get();
  return self.read([&](const Scene& scene) {
    const auto find = [&](const QueryBudget& budget) {
      std::deque<Found> all;
      const auto visit = [&](const Found& found) { return all.push_back(found), !*budget.abandon; };
      const auto counts = [&](auto... ids) { return *budget.abandon || (*filter)(ids...); };
      search(scene, visit, filter ? decltype(filter)(counts) : std::nullopt);
      return all;
    };
    return interruptible(nullptr, find, which.needs_gil());
  });
}

IdArray candidate_pairs_of(SceneObject& self, double margin, const ObjectFilter& filter) {
  const Filter which(filter);
  const auto pairs = found_in<ObjectPair>(self, which, [&](const Scene& scene, const auto& visit, auto counts) {
    scene.visit_candidate_pairs(margin, visit, counts);
  });
  return array_of(pairs, nb::str("uint32"), {pairs.size(), 2});
}

/// A filter of objects as Python passes it: None, or something that is called with an id.
class SingleFilter {
 public:
  explicit SingleFilter(nb::handle filter) {
    if (filter.is_none()) return;
    if (PyCallable_Check(filter.ptr()) == 0) throw nb::type_error("filter: expected None or something to call");
    predicate_ = {nb::borrow(filter)};
  }
  bool needs_gil() const { return predicate_.function.is_valid(); }
  /// For the options of a query; refers to this object.
  std::optional<limber::ObjectFilter> get() const {
    return needs_gil() ? std::optional<limber::ObjectFilter>(predicate_) : std::nullopt;
  }

 private:
  struct Predicate {
    nb::object function;
    bool operator()(ObjectId id) const { return nb::cast<bool>(nb::bool_(function(id))); }
  };
  Predicate predicate_;
};
using SingleObjectFilter = Named<"SingleObjectFilter">;

IdArray candidates_of(SceneObject& self, nb::handle_t<BodyObject> model, double margin, const PoseLike& pose,
                      const SingleObjectFilter& filter) {
  auto& object = nb::cast<BodyObject&>(model);
  const Reading model_guard = reading(object);
  const SingleFilter which(filter);
  const Placed placed(object.body(), pose_from(pose, "pose"));
  const auto ids = found_in<ObjectId>(self, which, [&](const Scene& scene, const auto& visit, auto counts) {
    scene.visit_candidates(placed, margin, visit, counts);
  });
  return array_of(ids, nb::str("uint32"));
}

ClosestObjectResult closest_object_of(SceneObject& self, nb::handle_t<BodyObject> model, const PoseLike& pose,
                                      double relative_error, double absolute_error, double max_distance,
                                      const SingleObjectFilter& filter, const BudgetObject* budget) {
  auto& object = nb::cast<BodyObject&>(model);
  const Reading model_guard = reading(object);
  const Placed placed(object.body(), pose_from(pose, "pose"));
  const SingleFilter which(filter);
  return self.read([&](const Scene& scene) {
    const auto ask = [&](const QueryBudget& limits) {
      return scene.closest_object(placed,
                                  {{relative_error, absolute_error, max_distance, nullptr, limits}, which.get()});
    };
    return interruptible(budget, ask, which.needs_gil());
  });
}

ObjectImpactResult object_impact_of(SceneObject& self, nb::handle_t<BodyObject> body, const RigidMotion& motion,
                                    double max_time, double min_separation, std::optional<double> distance_error,
                                    const SingleObjectFilter& filter, const BudgetObject* budget) {
  auto& object = nb::cast<BodyObject&>(body);
  const Reading model_guard = reading(object);
  const SingleFilter which(filter);
  return self.read([&](const Scene& scene) {
    const auto ask = [&](const QueryBudget& limits) {
      return scene.time_of_impact(object.body(), motion,
                                  {{max_time, min_separation, distance_error, nullptr, limits}, which.get()});
    };
    return interruptible(budget, ask, which.needs_gil());
  });
}

AnyWithinResult any_within_of(SceneObject& self, double max_distance, const ObjectFilter& filter,
                              const BudgetObject* budget) {
  const Filter which(filter);
  return self.read([&](const Scene& scene) {
    const auto ask = [&](const QueryBudget& limits) {
      return scene.any_within(max_distance, {.filter = which.get(), .budget = limits});
    };
    return interruptible(budget, ask, which.needs_gil());
  });
}

bool names_no_object(const Scene& scene, std::span<const ObjectPair> pairs) {
  return !std::all_of(pairs.begin(), pairs.end(),
                      [&](const ObjectPair& pair) { return scene.contains(pair.a) && scene.contains(pair.b); });
}

Named<"ManyContacts"> contacts_of_pairs(SceneObject& self, const ArrayLike& pairs, double margin,
                                        std::optional<OrientedFaces> oriented_faces, const BudgetObject* budget) {
  const std::vector<ObjectPair> asked = id_pairs_from(pairs, "pairs");
  ObjectContacts found;
  std::deque<Contact> contacts;
  std::vector<std::int64_t> offsets{0};
  const auto of_first = [&](std::size_t count) {
    offsets.resize(count + 1), contacts.resize(static_cast<std::size_t>(offsets.back()));
    return result("ManyContacts", "contacts"_a = array_of(contacts, dtypes().contact),
                  "offsets"_a = array_of(std::span<const std::int64_t>(offsets), nb::str("int64"), {offsets.size()}));
  };
  return self.read([&](const Scene& scene) {
    const auto ask = [&](std::size_t begin, std::size_t end, const QueryBudget& limits) {
      offsets.resize(begin + 1), contacts.resize(static_cast<std::size_t>(offsets.back()));  // if asked again
      scene.contacts(std::span(asked).subspan(begin, end - begin), margin, found,
                     {.oriented_faces = oriented_faces, .budget = limits});
      for (std::size_t i = 1; i < found.offsets.size(); ++i) {
        offsets.push_back(static_cast<std::int64_t>(contacts.size() + found.offsets[i]));
      }
      contacts.insert(contacts.end(), found.contacts.begin(), found.contacts.end());
      return found.offsets.size() - 1;
    };
    return in_parts(asked.size(), names_no_object(scene, asked), budget, Spent::leaves_out, ask, of_first);
  });
}

/// Asks query(scene, pairs, results, cache, budget) about pairs of objects; its answers as an array of records.
template <typename Result, typename Query>
RecordArray asked_of_pairs(SceneObject& self, nb::handle pairs, SceneCacheObject* cache, nb::handle dtype,
                           const BudgetObject* budget, const Query& query) {
  const Used used(cache);
  const std::vector<ObjectPair> asked = id_pairs_from(pairs, "pairs");
  return self.read([&](const Scene& scene) {
    const bool is_refused = names_no_object(scene, asked);
    const auto ask = [&](auto part, auto results, const QueryBudget& limits) {
      query(scene, part, results, used.get(), limits);
    };
    try {  // with a cache at once: a part would take the place of another one in it
      return recorded_in_parts<Result>(asked, is_refused || cache != nullptr, budget, Spent::is_told, dtype, ask);
    } catch (...) {
      if (cache != nullptr) used.get()->clear();
      throw;
    }
  });
}

RecordArray collide_pairs(SceneObject& self, const ArrayLike& pairs, SceneCacheObject* cache,
                          const BudgetObject* budget) {
  return asked_of_pairs<CollideResult>(
      self, pairs, cache, dtypes().collide, budget,
      [&](const Scene& scene, std::span<const ObjectPair> asked, auto results, SceneCache* c,
          const QueryBudget& limits) { scene.collide(asked, results, {.cache = c, .budget = limits}); });
}

RecordArray pairs_within(SceneObject& self, const ArrayLike& pairs, double max_distance, SceneCacheObject* cache,
                         const BudgetObject* budget) {
  return asked_of_pairs<CollideResult>(
      self, pairs, cache, dtypes().collide, budget,
      [&](const Scene& scene, std::span<const ObjectPair> asked, auto results, SceneCache* c,
          const QueryBudget& limits) { scene.within(asked, max_distance, results, {.cache = c, .budget = limits}); });
}

RecordArray pair_distances(SceneObject& self, const ArrayLike& pairs, double relative_error, double absolute_error,
                           double max_distance, SceneCacheObject* cache, const BudgetObject* budget) {
  return asked_of_pairs<DistanceResult>(
      self, pairs, cache, dtypes().distance, budget,
      [&](const Scene& scene, std::span<const ObjectPair> asked, auto results, SceneCache* c,
          const QueryBudget& limits) {
        scene.distance(asked, results,
                       {.distance = {relative_error, absolute_error, max_distance, nullptr, limits}, .cache = c});
      });
}

ClosestObjectsResult closest_objects_of(SceneObject& self, double relative_error, double absolute_error,
                                        double max_distance, const ObjectFilter& filter, SceneCacheObject* cache,
                                        const BudgetObject* budget) {
  const Filter which(filter);
  const Used used(cache);
  return self.read([&](const Scene& scene) {
    return interruptible(true, which.needs_gil(), budget, used.get(), [&](const QueryBudget& limits) {
      return scene.closest_objects(
          {{relative_error, absolute_error, max_distance, nullptr, limits}, which.get(), used.get()});
    });
  });
}

FloatArray pose_of(SceneObject& self, ObjectId id) {
  return array_of(self.look([&](const Scene& scene) { return scene.object(id).pose; }));
}

/// Ctrl-C ends it. Pre: the matrix is locked.
void set_between(ObjectPairMatrix& matrix, std::span<const ObjectId> a, std::span<const ObjectId> b, bool counts) {
  matrix.set_between(a, {}, counts);  // throws if an id is wrong, before anything is said
  const auto of_piece = [&](std::size_t begin, std::size_t end) {
    matrix.set_between(a.subspan(begin, end - begin), b, counts);
  };
  in_pieces(a.size(), of_piece, 1 + (std::size_t{1} << 22) / (b.size() + 1));
}

/// What a pickle keeps of each id: a body and its pose, or None; and whether they are committed.
nb::tuple reduced(nb::handle_t<SceneObject> self) {
  auto& scene = nb::cast<SceneObject&>(self);
  nb::list objects;
  const bool is_committed = scene.read([&](const Scene& read) {
    for (ObjectId id = 0; id < read.id_bound(); ++id) {
      objects.append(read.contains(id) ? nb::object(nb::make_tuple(scene.model(id), pose_of(scene, id))) : nb::none());
      run_signal_handlers();
    }
    return read.is_committed();
  });
  return restored_by(self.type(), nb::tuple(), nb::make_tuple(objects, is_committed));
}

void restore_scene(SceneObject& self, const nb::tuple& state) {
  std::vector<ObjectId> unused;
  nb::object some;  // a body for ids that none has, until all are there
  for (const nb::handle object : state[0]) some = object.is_none() ? some : nb::object(object[0]);
  for (const nb::handle object : state[0]) {
    const bool is_used = !object.is_none();
    if (!some.is_valid()) break;
    const ObjectId id = self.add(nb::handle_t<BodyObject>(is_used ? nb::object(object[0]) : some),
                                 is_used ? nb::object(object[1]) : nb::none());
    if (!is_used) unused.push_back(id);
    run_signal_handlers();
  }
  for (const ObjectId id : unused) self.remove(id);
  if (nb::cast<bool>(state[1])) self.commit();
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
  ValueClass<ClosestObjectsResult>(m, "ClosestObjectsResult", docs::ClosestObjectsResult)
      .field("objects", &ClosestObjectsResult::objects, "The ids of the two, or None if the result has no witness.")
      .field("result", &ClosestObjectsResult::result, docs::ClosestObjectsResult_result);
  ValueClass<AnyWithinResult>(m, "AnyWithinResult", docs::AnyWithinResult)
      .field("objects", &AnyWithinResult::objects, "The ids of the two, or None unless the answer is yes.")
      .field("result", &AnyWithinResult::result, docs::AnyWithinResult_result);
  ValueClass<ClosestObjectResult>(m, "ClosestObjectResult", docs::ClosestObjectResult)
      .id_or_none("object", &ClosestObjectResult::object, "Its id, or None if the result has no witness.")
      .field("result", &ClosestObjectResult::result, docs::ClosestObjectResult_result);
  ValueClass<ObjectImpactResult>(m, "ObjectImpactResult", docs::ObjectImpactResult)
      .id_or_none("object", &ObjectImpactResult::object, "Its id, or None if the result has no witness.")
      .field("result", &ObjectImpactResult::result, docs::ObjectImpactResult_result);
  nb::class_<ObjectPairMatrix>(m, "ObjectPairMatrix", docs::ObjectPairMatrix)
      .def(nb::init<std::size_t, bool>(), "size"_a, "counts"_a = true,
           "All pairs of ids below `size` count, or none does.")
      .def_prop_ro("size", &ObjectPairMatrix::size, "Ids are less than this.")
      .def("set", &ObjectPairMatrix::set, "a"_a, "b"_a, "counts"_a, nb::lock_self(),
           "Says whether two ids count as a pair.")
      .def(
          "set_among",
          [](ObjectPairMatrix& self, const ArrayLike& ids, bool counts) {
            set_between(self, ids_from(ids, "ids"), ids_from(ids, "ids"), counts);
          },
          "ids"_a, "counts"_a, nb::lock_self(), docs::ObjectPairMatrix_set_among)
      .def(
          "set_between",
          [](ObjectPairMatrix& self, const ArrayLike& ids_a, const ArrayLike& ids_b, bool counts) {
            set_between(self, ids_from(ids_a, "ids_a"), ids_from(ids_b, "ids_b"), counts);
          },
          "ids_a"_a, "ids_b"_a, "counts"_a, nb::lock_self(), docs::ObjectPairMatrix_set_between)
      .def("__call__", &ObjectPairMatrix::operator(), "a"_a, "b"_a, nb::lock_self(), "Whether a pair counts.");
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
      .def("__reduce__", &reduced, nb::sig("def __reduce__(self) -> tuple[Any, ...]"))
      .def("_restore", &restore_scene, nb::sig("def _restore(self, state: tuple[Any, ...], /) -> None"))
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
      .def(
          "object", [](SceneObject& self, ObjectId id) { return nb::make_tuple(self.model(id), pose_of(self, id)); },
          "id"_a, nb::sig("def object(self, id: int) -> tuple[Body, FloatArray]"),
          "The model and the pose of an object: closest_object(*scene.object(id), filter=others) asks what is next to "
          "it.")
      .def("pose", &pose_of, "id"_a, "world_from_model of an object, 4 x 4.")
      .def(
          "bounding_box",
          [](SceneObject& self, ObjectId id) {
            return self.read([&](const Scene& scene) { return scene.bounding_box(id); });
          },
          "id"_a, docs::Scene_bounding_box)
      .def("candidate_pairs", &candidate_pairs_of, "margin"_a, nb::kw_only(), "filter"_a = nb::none(),
           docs::Scene_visit_candidate_pairs)
      .def("collide", &collide_pairs, "pairs"_a, nb::kw_only(), "cache"_a = nb::none(), "budget"_a = nb::none(),
           (asked_documentation("collide_dtype, with these fields.") + collide_fields()).c_str())
      .def("within", &pairs_within, "pairs"_a, "max_distance"_a, nb::kw_only(), "cache"_a = nb::none(),
           "budget"_a = nb::none(),
           (asked_documentation("collide_dtype, with these fields.") + collide_fields()).c_str())
      .def("distance", &pair_distances, "pairs"_a, nb::kw_only(), "relative_error"_a = 0.0, "absolute_error"_a = 0.0,
           max_distance_argument(), "cache"_a = nb::none(), "budget"_a = nb::none(),
           (asked_documentation("distance_dtype, with these fields.") + distance_fields()).c_str())
      .def("closest_objects", &closest_objects_of, nb::kw_only(), "relative_error"_a = 0.0, "absolute_error"_a = 0.0,
           max_distance_argument(), "filter"_a = nb::none(), "cache"_a = nb::none(), "budget"_a = nb::none(),
           docs::Scene_closest_objects)
      .def("contacts", &contacts_of_pairs, "pairs"_a, "margin"_a, nb::kw_only(), "oriented_faces"_a = nb::none(),
           "budget"_a = nb::none(), docs::Scene_contacts)
      .def("any_within", &any_within_of, "max_distance"_a, nb::kw_only(), "filter"_a = nb::none(),
           "budget"_a = nb::none(), docs::Scene_any_within)
      .def("candidates", &candidates_of, "model"_a, "margin"_a, "pose"_a = nb::none(), nb::kw_only(),
           "filter"_a = nb::none(), docs::Scene_visit_candidates)
      .def("closest_object", &closest_object_of, "model"_a, "pose"_a = nb::none(), nb::kw_only(),
           "relative_error"_a = 0.0, "absolute_error"_a = 0.0, max_distance_argument(), "filter"_a = nb::none(),
           "budget"_a = nb::none(), docs::Scene_closest_object)
      .def("time_of_impact", &object_impact_of, "body"_a, "motion"_a, nb::kw_only(), "max_time"_a = 1.0,
           "min_separation"_a = 0.0, "distance_error"_a = nb::none(), "filter"_a = nb::none(), "budget"_a = nb::none(),
           docs::Scene_time_of_impact);
}

}  // namespace limber::python
