// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether any two objects of a scene are within a distance.
#include <algorithm>
#include <atomic>
#include <vector>

#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "limber/distance.h"
#include "scene/scene_impl.h"

namespace limber {
namespace {

/// Asks pairs in rounds until one of them is within the distance. The answer is that of asking one after the other, in
/// the order in which they are found, so it does not depend on threads.
class AnyWithinSearch {
 public:
  AnyWithinSearch(const Scene::Impl& scene, double max_distance, const QueryBudget& budget, std::size_t grain)
      : scene_(scene), max_distance_(max_distance), budget_(budget), grain_(grain) {}

  AnyWithinResult run(std::optional<ObjectPairFilter> filter);

 private:
  /// Asks the pairs that wait. Returns whether to go on.
  bool ask_waiting();

  const Scene::Impl& scene_;
  const double max_distance_;
  const QueryBudget budget_;
  const std::size_t grain_;
  AnyWithinResult found_;
  StoppedBy stopped_by_ = StoppedBy::nothing;
  std::size_t in_round_ = 1;
  std::vector<ObjectPair> waiting_;
  std::vector<CollideResult> results_;
};

bool AnyWithinSearch::ask_waiting() {
  results_.resize(waiting_.size());
  std::atomic<std::size_t> first_yes = waiting_.size();
  base::parallel_for(waiting_.size(), grain_, [&](std::size_t i) {
    if (i > first_yes) return;
    results_[i] =
        within(scene_.placed(waiting_[i].a), scene_.placed(waiting_[i].b), max_distance_, {.budget = budget_});
    if (!results_[i].is_yes()) return;
    for (std::size_t first = first_yes; i < first && !first_yes.compare_exchange_weak(first, i);) {
    }
  });
  for (std::size_t i = 0; i < std::min(first_yes + 1, waiting_.size()); ++i) {
    found_.result.stats += results_[i].stats;
    scene::note(results_[i].stopped_by, stopped_by_);
  }
  if (first_yes < waiting_.size()) {
    found_.objects = waiting_[first_yes];
    found_.result.answer = Answer::yes, found_.result.witness = results_[first_yes].witness;
  }
  waiting_.clear();
  in_round_ = std::min(2 * in_round_, scene::most_in_round);
  return !found_.result.is_yes() && !scene::ends_all(stopped_by_);
}

AnyWithinResult AnyWithinSearch::run(std::optional<ObjectPairFilter> filter) {
  const auto visit = [&](std::uint32_t rank_a, std::uint32_t rank_b) {
    const ObjectPair pair = scene_.pair_of(rank_a, rank_b);
    if (filter && !(*filter)(pair.a, pair.b)) return true;
    waiting_.push_back(pair);
    return waiting_.size() < in_round_ || ask_waiting();
  };
  const double margin = scene::margin_with_error(max_distance_);
  bool goes_on = true;
  StoppedBy ended_by = StoppedBy::nothing;  // where few pairs count, nothing else looks at the budget
  for (std::uint32_t leaf = 0; leaf < scene_.tree.leaf_count() && goes_on && ended_by == StoppedBy::nothing; ++leaf) {
    if (leaf > 0) ended_by = scene::ended_by(budget_);
    goes_on = scene_.tree.visit_pairs(leaf, margin, visit);
  }
  if (goes_on) ask_waiting();
  scene::note(ended_by, stopped_by_);
  LIMBER_ASSERT(found_.result.is_yes() == found_.result.witness.has_value());
  if (!found_.result.is_yes()) {
    found_.result.answer = stopped_by_ == StoppedBy::nothing ? Answer::no : Answer::undecided;
    found_.result.stopped_by = stopped_by_;
  }
  return found_;
}

}  // namespace

AnyWithinResult scene::find_any_within(const Scene::Impl& scene, double max_distance, const SceneQueryOptions& options,
                                       std::size_t grain) {
  return AnyWithinSearch(scene, max_distance, options.budget, grain).run(options.filter);
}

AnyWithinResult Scene::any_within(double max_distance, const SceneQueryOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  const Impl& scene = impl("any_within");
  scene::require_committed(scene, "limber::Scene::any_within");
  LIMBER_REQUIRE(base::is_finite_and_not_negative(max_distance),
                 "limber::Scene::any_within: max_distance must be finite and at least 0");
  LIMBER_REQUIRE(options.cache == nullptr, "limber::Scene::any_within: takes no cache");
  return scene::find_any_within(scene, max_distance, options, scene::pairs_per_task);
}

}  // namespace limber
