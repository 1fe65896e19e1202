// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "interrupts.h"
#include "limber/limber.h"
#include "records.h"
#include "scene_object.h"

namespace limber::python {
namespace {

/// A scene and many configurations of some of its objects. The package asks for a part at a time.
class SceneBatch {
 public:
  SceneBatch(nb::handle_t<SceneObject> scene, const ArrayLike& ids, const PosesLike& poses, const ObjectFilter& filter,
             const WholeNumber& threads)
      : owner_(nb::borrow(scene)),
        scene_(nb::cast<SceneObject&>(scene)),
        ids_(ids_from(ids, "ids")),
        threads_(thread_count(threads, "threads")) {
    if (ids_.empty()) throw nb::value_error("ids: expected at least one");
    poses_ = configurations_from(poses, ids_.size(), "poses");
    const PairFilter<ObjectPairFilter> which(filter);
    if (!which.get()) return;
    // Once for all parts, so that they need no GIL.
    scene_.read([&](const Scene& of_ids) {
      if (which.matrix() && which.matrix()->size() >= of_ids.id_bound()) {
        counts_ = which.matrix();
        return;
      }
      counts_.emplace(of_ids.id_bound(), false);
      for (ObjectId b = 0; b < of_ids.id_bound(); ++b) {
        run_signal_handlers();
        for (ObjectId a = 0; a < b; ++a) {
          if (of_ids.contains(a) && of_ids.contains(b) && (*which.get())(a, b)) counts_->set(a, b, true);
        }
      }
    });
  }

  std::size_t size() const { return poses_.size() / ids_.size(); }

  void closest_objects(const RecordArray& records, std::size_t begin, std::size_t end, double relative_error,
                       double absolute_error, double max_distance, const BudgetObject* budget) {
    write<ClosestObjectsResult>(
        records, begin, end, budget, [&](const Scene& scene, auto poses, auto& results, const QueryBudget& limits) {
          scene.closest_objects_many(ids_, poses, results,
                                     {{relative_error, absolute_error, max_distance, nullptr, limits}, filter()});
        });
  }

  void any_within(const RecordArray& records, std::size_t begin, std::size_t end, double max_distance,
                  const BudgetObject* budget) {
    write<AnyWithinResult>(
        records, begin, end, budget, [&](const Scene& scene, auto poses, auto& results, const QueryBudget& limits) {
          scene.any_within_many(ids_, poses, max_distance, results, {.filter = filter(), .budget = limits});
        });
  }

 private:
  std::optional<ObjectPairFilter> filter() const {
    return counts_ ? std::optional<ObjectPairFilter>(*counts_) : std::nullopt;
  }

  /// Writes the records of query(scene, poses, results, budget) for configurations begin to end.
  template <typename Result, typename Query>
  void write(nb::handle records, std::size_t begin, std::size_t end, const BudgetObject* budget, const Query& query) {
    if (end > size() || begin > end) throw nb::index_error("there are fewer configurations");
    using Record = decltype(record_of(Result{}));
    auto* const out = static_cast<Record*>(memory_of(records, (end - begin) * sizeof(Record)));
    std::vector<Result> results(end - begin);
    const auto poses = std::span<const Transform>(poses_).subspan(begin * ids_.size(), results.size() * ids_.size());
    scene_.read([&](const Scene& scene) {
      interruptible(budget, [&](const QueryBudget& limits) {
        if (threads_) {
          oneapi::tbb::task_arena(*threads_).execute([&] { query(scene, poses, results, limits); });
        } else {
          query(scene, poses, results, limits);
        }
        std::transform(results.begin(), results.end(), out, [](const Result& result) { return record_of(result); });
        return true;
      });
    });
  }

  nb::object owner_;
  SceneObject& scene_;
  std::vector<ObjectId> ids_;
  std::vector<Transform> poses_;
  std::optional<ObjectPairMatrix> counts_;
  std::optional<int> threads_;
};

}  // namespace

void bind_scene_batch(nb::module_& m) {
  nb::class_<SceneBatch>(m, "SceneBatch", "A scene and many configurations.")
      .def(nb::init<nb::handle_t<SceneObject>, ArrayLike, PosesLike, ObjectFilter, WholeNumber>(), "scene"_a, "ids"_a,
           "poses"_a, "filter"_a.none(), "threads"_a.none())
      .def_prop_ro("size", &SceneBatch::size, "How many configurations there are.")
      .def("closest_objects", &SceneBatch::closest_objects, "records"_a, "begin"_a, "end"_a, "relative_error"_a,
           "absolute_error"_a, "max_distance"_a, "budget"_a.none(),
           "Writes the closest objects of configurations begin to end.")
      .def("any_within", &SceneBatch::any_within, "records"_a, "begin"_a, "end"_a, "max_distance"_a, "budget"_a.none(),
           "Writes the answers of any_within() for configurations begin to end.");
}

}  // namespace limber::python
