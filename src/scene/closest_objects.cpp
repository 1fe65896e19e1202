// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Searches for one pair of objects: the closest two, the object closest to a placed model, and any two that are within
// a distance.
#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "limber/distance.h"
#include "scene/scene_impl.h"
#include "scene/still_objects.h"

namespace limber {
namespace {

/// Asks for distances of pairs, nearest bounds first, as long as they may be closer than the closest pair so far.
///
/// Pairs are asked in rounds, all of a round at once and with the same limit, so neither the pairs that are asked nor
/// their limits depend on threads.
class ClosestSearch {
 public:
  ClosestSearch(const Scene::Impl& scene, const DistanceOptions& options, SceneCache* cache, std::size_t grain)
      : scene_(scene), options_(options), cache_(cache), grain_(grain) {
    closest_.result.status = DistanceStatus::beyond_limit;
    closest_.result.lower = options.max_distance;
    closest_.result.upper = std::numeric_limits<double>::infinity();
  }

  ClosestObjectsResult among_objects(std::optional<ObjectPairFilter> filter) {
    ask_neighbors(filter);
    const auto visit = [&](std::uint32_t rank_a, std::uint32_t rank_b) {
      wait(scene_.pair_of(rank_a, rank_b), scene_.tree.lower_bound(rank_a, rank_b), filter);
      return true;
    };
    const std::uint32_t leaves = scene_.tree.leaf_count();
    StoppedBy ended_by = StoppedBy::nothing;  // where few pairs count, nothing else looks at the budget
    for (std::uint32_t leaf = 0; leaf < leaves && ended_by == StoppedBy::nothing; ++leaf) {
      if (closest_.result.upper == 0 || scene::ends_all(stopped_by_)) break;
      if (leaf > 0) ended_by = scene::ended_by(options_.budget);
      scene_.tree.visit_pairs(leaf, scene::margin_with_error(limit()), visit);
      if (waiting_.size() > most_waiting) ask_waiting();
    }
    if (ended_by != StoppedBy::nothing) ask_waiting();  // a step is made, if there is one to make
    scene::note(ended_by, stopped_by_);
    // There may be pairs of which nothing is known.
    if (scene::ends_all(stopped_by_)) closest_.result.lower = 0;
    ask_waiting();
    if (cache_ != nullptr) Access::impl(*cache_).closest = closest_.objects;
    return finish();
  }
  /// find_closest_of_moved() says it.
  std::optional<ClosestObjectsResult> among_moved(scene::MovedObjects& moved, std::optional<ObjectPairFilter> filter,
                                                  double& margin) {
    moved_ = &moved;
    const auto visit = [&](const ObjectPair& pair, double bound) { wait(pair, bound, filter); };
    if (!all_can_wait(moved.size())) {
      moved.visit_neighbors(visit);
      ask_seeds();
    }
    margin = scene::margin_with_error(limit());
    if (closest_.result.upper > 0 && !scene::ends_all(stopped_by_)) moved.visit_pairs(margin, visit);
    if (waiting_.size() > most_waiting) return std::nullopt;
    if (scene::ends_all(stopped_by_)) closest_.result.lower = 0;
    ask_waiting();
    return finish();
  }
  /// The object closest to a model is `b` of the result.
  ClosestObjectsResult next_to(const Placed& model, std::optional<ObjectFilter> filter) {
    model_ = &model;
    const scene::WorldBounds bounds = scene::world_bounds(scene::local_bounds(model.body()), model.pose);
    scene_.tree.visit_near(bounds, scene::margin_with_error(limit()), [&](std::uint32_t rank) {
      const ObjectId id = scene_.tree.id_of(rank);
      const double bound = scene_.tree.lower_bound(bounds, rank);
      if (may_matter(bound) && (!filter || (*filter)(id))) waiting_.push_back({bound, {no_id, id}});
      return true;
    });
    ask_waiting();
    return finish();
  }

 private:
  struct Waiting {
    double bound;  // of the distance
    ObjectPair pair;
    friend bool operator<(const Waiting& s, const Waiting& t) {
      if (s.bound != t.bound) return s.bound < t.bound;
      return s.pair.a != t.pair.a ? s.pair.a < t.pair.a : s.pair.b < t.pair.b;
    }
  };
  static constexpr std::size_t most_waiting = 1024, seeds = 8;

  bool is_found() const { return closest_.objects.b != no_id; }
  /// Pairs farther apart need not be asked; if one has been found, those exactly as far apart neither.
  double limit() const { return std::min(closest_.result.upper, options_.max_distance); }
  bool may_matter(double bound) const { return is_found() ? bound < limit() : bound <= limit(); }
  const Placed& placed(ObjectId id) const {
    if (moved_ != nullptr) return moved_->placed(id);
    return id == no_id ? *model_ : scene_.placed(id);
  }
  static bool all_can_wait(std::size_t objects) { return objects * objects <= 2 * most_waiting; }

  void wait(const ObjectPair& pair, double bound, std::optional<ObjectPairFilter> filter) {
    if (may_matter(bound) && (!filter || (*filter)(pair.a, pair.b))) waiting_.push_back({bound, pair});
  }
  /// Asks the pairs that wait, those that matter.
  void ask_waiting() {
    std::sort(waiting_.begin(), waiting_.end());
    std::size_t in_round = 1, begin = 0;
    while (begin < waiting_.size() && may_matter(waiting_[begin].bound) && !scene::ends_all(stopped_by_)) {
      std::size_t end = begin;
      while (end < waiting_.size() && end - begin < in_round && may_matter(waiting_[end].bound)) ++end;
      ask_round(std::span(waiting_).subspan(begin, end - begin));
      begin = end;
      in_round = std::min(2 * in_round, scene::most_in_round);
    }
    if (begin < waiting_.size()) closest_.result.lower = std::min(closest_.result.lower, waiting_[begin].bound);
    waiting_.clear();
  }
  void ask_round(std::span<const Waiting> round) {
    DistanceOptions options = options_;
    options.max_distance = limit();
    pairs_.clear();
    for (const Waiting& next : round) pairs_.push_back(next.pair);
    results_.resize(round.size());
    std::span<QueryCache* const> caches;
    if (cache_ != nullptr) caches = Access::impl(*cache_).caches_of(pairs_);
    base::parallel_for(round.size(), grain_, [&](std::size_t i) {
      DistanceOptions with_cache = options;
      with_cache.cache = caches.empty() ? nullptr : caches[i];
      results_[i] = distance(placed(pairs_[i].a), placed(pairs_[i].b), with_cache);
    });
    DistanceResult& closest = closest_.result;
    for (std::size_t i = 0; i < round.size(); ++i) {
      QueryStats stats = closest.stats;
      stats += results_[i].stats;
      const double lower = std::min(closest.lower, results_[i].lower);
      scene::note(results_[i].stopped_by, stopped_by_);
      if (results_[i].upper < closest.upper) {
        closest = results_[i];
        closest_.objects = pairs_[i];
      }
      closest.lower = lower, closest.stats = stats;
    }
  }
  /// Asks a few pairs that are likely to be close: the closest pair of the last frame, and pairs that follow each other
  /// in Hilbert order.
  void ask_neighbors(std::optional<ObjectPairFilter> filter) {
    if (cache_ != nullptr) {
      const ObjectPair last = Access::impl(*cache_).closest;
      if (scene_.contains(last.a) && scene_.contains(last.b) && (!filter || (*filter)(last.a, last.b))) {
        ask_round({{{0, last}}});
      }
    }
    const std::uint32_t size = scene_.tree.size();
    if (all_can_wait(size)) return;  // so the nearest bounds come first anyway
    for (std::uint32_t rank = 0; rank + 1 < size; ++rank) {
      wait(scene_.pair_of(rank, rank + 1), scene_.tree.lower_bound(rank, rank + 1), filter);
    }
    ask_seeds();
  }
  /// Asks those that are likely to be close of the neighbors that wait.
  void ask_seeds() {
    if (waiting_.size() > seeds) {
      std::nth_element(waiting_.begin(), waiting_.begin() + seeds, waiting_.end());
      waiting_.resize(seeds);
    }
    ask_waiting();
  }
  /// Says what the result is.
  ClosestObjectsResult finish() {
    DistanceResult& result = closest_.result;
    LIMBER_ASSERT(is_found() == result.witness.has_value());
    if (is_found()) {
      result.lower = std::min(result.lower, result.upper);
      if (result.upper > 0)
        result.status = result.lower == result.upper ? DistanceStatus::exact : DistanceStatus::within_error;
      const double most =
          std::max(result.lower * (1 + options_.relative_error), result.lower + options_.absolute_error);
      const bool is_interrupted = stopped_by_ != StoppedBy::nothing && result.upper > most;
      result.stopped_by = is_interrupted ? stopped_by_ : StoppedBy::nothing;
      if (is_interrupted) result.status = DistanceStatus::interrupted;
    } else if (stopped_by_ != StoppedBy::nothing) {
      result.status = DistanceStatus::interrupted, result.stopped_by = stopped_by_;
    }
    LIMBER_ASSERT(result.lower <= result.upper);
    return closest_;
  }

  const Scene::Impl& scene_;
  const DistanceOptions options_;
  SceneCache* const cache_;
  const std::size_t grain_;
  const Placed* model_ = nullptr;  // which no_id stands for
  const scene::MovedObjects* moved_ = nullptr;
  ClosestObjectsResult closest_;
  StoppedBy stopped_by_ = StoppedBy::nothing;
  std::vector<Waiting> waiting_;
  std::vector<ObjectPair> pairs_;
  std::vector<DistanceResult> results_;
};

/// Asks pairs in rounds until one of them is within the distance. The answer is that of asking one after the other, in
/// the order in which they are found, so it does not depend on threads.
class AnyWithinSearch {
 public:
  AnyWithinSearch(const Scene::Impl& scene, double max_distance, const QueryBudget& budget, std::size_t grain)
      : scene_(scene), max_distance_(max_distance), budget_(budget), grain_(grain) {}

  AnyWithinResult run(std::optional<ObjectPairFilter> filter) {
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

 private:
  /// Asks the pairs that wait. Returns whether to go on.
  bool ask_waiting() {
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

}  // namespace

ClosestObjectsResult scene::find_closest(const Scene::Impl& scene, const SceneDistanceOptions& options,
                                         std::size_t grain) {
  return ClosestSearch(scene, options.distance, options.cache, grain).among_objects(options.filter);
}

std::optional<ClosestObjectsResult> scene::find_closest_of_moved(MovedObjects& moved,
                                                                 const SceneDistanceOptions& options, double& margin) {
  return ClosestSearch(moved.scene(), options.distance, nullptr, no_tasks).among_moved(moved, options.filter, margin);
}

ClosestObjectsResult Scene::closest_objects(const SceneDistanceOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  const Impl& scene = impl("closest_objects");
  scene::require_committed(scene, "limber::Scene::closest_objects");
  scene::check_options(options.distance, "limber::Scene::closest_objects");
  return scene::find_closest(scene, options, scene::pairs_per_task);
}

ClosestObjectResult Scene::closest_object(const Placed& model, const ClosestObjectOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  const Impl& scene = impl("closest_object");
  scene::require_committed(scene, "limber::Scene::closest_object");
  scene::check_options(options.distance, "limber::Scene::closest_object");
  require_ready(model, "limber::Scene::closest_object", "the model");
  ClosestSearch search(scene, options.distance, nullptr, scene::pairs_per_task);
  const ClosestObjectsResult found = search.next_to(model, options.filter);
  return {found.objects.b, found.result};
}

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
