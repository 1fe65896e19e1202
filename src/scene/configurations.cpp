// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Many configurations of one scene.
#include <limits>
#include <optional>
#include <string>

#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "geometry/rigid.h"
#include "scene/scene_impl.h"

namespace limber {
namespace {

// Each task has a scene of its own. Copying one takes less than placing all of its objects.
constexpr std::size_t configurations_per_task = 16;

/// Which objects are where, in how many configurations.
struct Configurations {
  std::span<const ObjectId> ids;
  std::span<const Transform> poses;
  std::size_t count;
};

void check_configurations(const Scene::Impl& scene, const Configurations& all, const char* function) {
  const auto text = [&](const char* what) { return std::string(function) + ": " + what; };
  scene::require_committed(scene, function);
  // By a division: a product might wrap around.
  const bool is_whole = all.ids.empty()
                            ? all.poses.empty()
                            : all.poses.size() % all.ids.size() == 0 && all.poses.size() / all.ids.size() == all.count;
  LIMBER_REQUIRE(is_whole, text("poses: there must be one of each id for each result").c_str());
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    LIMBER_REQUIRE_ENTRY(scene.contains(all.ids[i]), text("ids").c_str(), i, "names no object of the scene");
  }
  for (std::size_t i = 0; i < all.poses.size(); ++i) {
    if (geometry::is_rigid(all.poses[i])) continue;
    const std::string list = text("poses[") + std::to_string(i / all.ids.size()) + "]";
    base::throw_invalid_entry(list.c_str(), i % all.ids.size(), geometry::why_not_rigid(all.poses[i]).c_str());
  }
}

/// Calls the filter once for every two objects, until the budget ends, and keeps what it answers. Threads may read the
/// answers at the same time, while a filter is called by one thread alone.
std::optional<ObjectPairMatrix> answers_of(const std::optional<ObjectPairFilter>& filter, const Scene::Impl& scene,
                                           const QueryBudget& budget) {
  if (!filter) return std::nullopt;
  ObjectPairMatrix counts(scene.objects.size(), false);
  for (const ObjectId b : scene.ids) {
    if (scene::ended_by(budget) != StoppedBy::nothing) break;
    for (const ObjectId a : scene.ids) {
      if (a >= b) break;  // ids ascend
      if ((*filter)(a, b)) counts.set(a, b, true);
    }
  }
  return counts;
}

/// Sets results[k] to ask(scene in configuration k), or to what left_out() says once the budget has ended.
template <typename Result, typename Ask, typename LeftOut>
void ask_configurations(const Scene::Impl& scene, const Configurations& all, const QueryBudget& budget,
                        std::span<Result> results, const Ask& ask, const LeftOut& left_out) {
  base::parallel_for_ranges(all.count, configurations_per_task, [&](std::size_t begin, std::size_t end) {
    Scene::Impl own = scene;
    for (std::size_t k = begin; k < end; ++k) {
      const StoppedBy stopped_by = scene::ended_by(budget);
      if (stopped_by != StoppedBy::nothing) {
        results[k] = left_out(stopped_by);
        continue;
      }
      for (std::size_t j = 0; j < all.ids.size(); ++j) own.set_pose(all.ids[j], all.poses[k * all.ids.size() + j]);
      for (const ObjectId id : all.ids) own.update_bounds(id);
      own.tree.build(own.ids, own.bounds);
      results[k] = ask(own);
    }
  });
}

}  // namespace

void Scene::closest_objects_many(std::span<const ObjectId> ids, std::span<const Transform> poses,
                                 std::span<ClosestObjectsResult> results, const SceneDistanceOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  constexpr const char* function = "limber::Scene::closest_objects_many";
  const Impl& scene = impl("closest_objects_many");
  const Configurations all{ids, poses, results.size()};
  check_configurations(scene, all, function);
  scene::check_options(options.distance, function);
  LIMBER_REQUIRE(options.cache == nullptr, "limber::Scene::closest_objects_many: takes no cache");
  const std::optional<ObjectPairMatrix> counts = answers_of(options.filter, scene, options.distance.budget);
  SceneDistanceOptions of_each = options;
  if (counts) of_each.filter = *counts;
  ask_configurations(
      scene, all, options.distance.budget, results,
      [&](const Impl& own) { return scene::find_closest(own, of_each, scene::no_tasks); },
      [](StoppedBy stopped_by) {
        ClosestObjectsResult undecided;
        undecided.result.upper = std::numeric_limits<double>::infinity();
        undecided.result.status = DistanceStatus::interrupted, undecided.result.stopped_by = stopped_by;
        return undecided;
      });
}

void Scene::any_within_many(std::span<const ObjectId> ids, std::span<const Transform> poses, double max_distance,
                            std::span<AnyWithinResult> results, const SceneQueryOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  const Impl& scene = impl("any_within_many");
  const Configurations all{ids, poses, results.size()};
  check_configurations(scene, all, "limber::Scene::any_within_many");
  LIMBER_REQUIRE(base::is_finite_and_not_negative(max_distance),
                 "limber::Scene::any_within_many: max_distance must be finite and at least 0");
  LIMBER_REQUIRE(options.cache == nullptr, "limber::Scene::any_within_many: takes no cache");
  const std::optional<ObjectPairMatrix> counts = answers_of(options.filter, scene, options.budget);
  SceneQueryOptions of_each = options;
  if (counts) of_each.filter = *counts;
  ask_configurations(
      scene, all, options.budget, results,
      [&](const Impl& own) { return scene::find_any_within(own, max_distance, of_each, scene::no_tasks); },
      [](StoppedBy stopped_by) {
        AnyWithinResult undecided;
        undecided.result.stopped_by = stopped_by;
        return undecided;
      });
}

}  // namespace limber
