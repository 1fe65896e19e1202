// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Many configurations of one scene.
#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "geometry/rigid.h"
#include "scene/scene_impl.h"
#include "scene/still_objects.h"

namespace limber {
namespace {

/// Which objects are where, in how many configurations.
struct Configurations {
  std::span<const ObjectId> ids;
  std::span<const Transform> poses;
  std::size_t count;

  std::span<const Transform> poses_of(std::size_t k) const { return poses.subspan(k * ids.size(), ids.size()); }
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

/// Calls the filter once for every two objects, or those of which one moves, until the budget ends, and keeps what it
/// answers. Threads may read the answers at the same time, while a filter is called by one thread alone.
std::optional<ObjectPairMatrix> answers_of(const std::optional<ObjectPairFilter>& filter, const Scene::Impl& scene,
                                           const QueryBudget& budget, const scene::StillObjects* still = nullptr) {
  if (!filter) return std::nullopt;
  ObjectPairMatrix counts(scene.objects.size(), false);
  for (const ObjectId b : still == nullptr ? scene.ids : still->moving) {
    if (scene::ended_by(budget) != StoppedBy::nothing) break;
    for (const ObjectId a : scene.ids) {
      if (a == b || (a > b && (still == nullptr || still->moves(a)))) continue;  // the two that come later
      const auto [low, high] = std::minmax(a, b);
      if ((*filter)(low, high)) counts.set(low, high, true);
    }
  }
  return counts;
}

/// Sets results[k] to ask(state, k), or to what left_out() says once the budget has ended. Threads have states of their
/// own, make().
template <typename Result, typename Make, typename Ask, typename LeftOut>
void ask_all(const QueryBudget& budget, std::span<Result> results, const Make& make, const Ask& ask,
             const LeftOut& left_out) {
  base::parallel_for_with(results.size(), make, [&](auto& state, std::size_t k) {
    const StoppedBy stopped_by = scene::ended_by(budget);
    results[k] = stopped_by == StoppedBy::nothing ? ask(state, k) : left_out(stopped_by);
  });
}

/// Sets results[k] to ask(scene in configuration k) likewise; each thread has a scene of its own.
template <typename Result, typename Ask, typename LeftOut>
void ask_configurations(const Scene::Impl& scene, const Configurations& all, const QueryBudget& budget,
                        std::span<Result> results, const Ask& ask, const LeftOut& left_out) {
  const auto ask_in = [&](Scene::Impl& own, std::size_t k) {
    const std::span<const Transform> poses = all.poses_of(k);
    for (std::size_t j = 0; j < all.ids.size(); ++j) own.set_pose(all.ids[j], poses[j]);
    for (const ObjectId id : all.ids) own.update_bounds(id);
    own.tree.build(own.ids, own.bounds);
    return ask(own);
  };
  ask_all(
      budget, results, [&] { return scene; }, ask_in, left_out);
}

ClosestObjectsResult left_open(StoppedBy stopped_by) {
  ClosestObjectsResult undecided;
  undecided.result.upper = std::numeric_limits<double>::infinity();
  undecided.result.status = DistanceStatus::interrupted, undecided.result.stopped_by = stopped_by;
  return undecided;
}

/// Sets all results if find_closest() would meet no two objects that stay and count together. Returns whether it is so:
/// it looks at those that are neighbors in the tree, and at those within the largest margin of all configurations.
bool ask_moving(const Scene::Impl& scene, const Configurations& all, std::span<ClosestObjectsResult> results,
                const SceneDistanceOptions& options) {
  const scene::StillObjects still(scene, all.ids);
  const QueryBudget& budget = options.distance.budget;
  const scene::BoxTree& tree = still.tree;
  const auto may_leave_out = [&](std::uint32_t rank_a, std::uint32_t rank_b) {
    if (budget.abandon != nullptr && budget.abandon->load(std::memory_order_relaxed)) return false;
    const ObjectId a = tree.id_of(rank_a), b = tree.id_of(rank_b);
    return options.filter && !(*options.filter)(std::min(a, b), std::max(a, b));
  };
  if (tree.size() == 0) return false;
  for (std::uint32_t rank = 0; rank + 1 < tree.size(); ++rank) {
    if (!may_leave_out(rank, rank + 1)) return false;
  }
  const std::optional<ObjectPairMatrix> counts = answers_of(options.filter, scene, budget, &still);
  SceneDistanceOptions of_each = options;
  if (counts) of_each.filter = *counts;
  std::vector<double> margins(results.size());
  std::atomic<bool> found_all = true;
  const auto ask = [&](scene::MovedObjects& moved, std::size_t k) {
    moved.place(all.ids, all.poses_of(k));
    const auto found = scene::find_closest_of_moved(moved, of_each, margins[k]);
    if (!found) found_all = false;
    return found.value_or(ClosestObjectsResult{});
  };
  ask_all(
      budget, results, [&] { return scene::MovedObjects(still); }, ask, left_open);
  if (!found_all || results.empty()) return false;
  const double margin = *std::max_element(margins.begin(), margins.end());
  for (std::uint32_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
    if (!tree.visit_pairs(leaf, margin, may_leave_out)) return false;
  }
  return true;
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
  if (ask_moving(scene, all, results, options)) return;
  const std::optional<ObjectPairMatrix> counts = answers_of(options.filter, scene, options.distance.budget);
  SceneDistanceOptions of_each = options;
  if (counts) of_each.filter = *counts;
  ask_configurations(
      scene, all, options.distance.budget, results,
      [&](const Impl& own) { return scene::find_closest(own, of_each, scene::no_tasks); }, left_open);
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
