// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The closest two objects of a scene.
#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "limber/distance.h"
#include "scene/scene_cache_impl.h"
#include "scene/scene_impl.h"

namespace limber {
namespace {

/// Asks for distances of pairs, nearest bounds first, as long as they may be closer than the closest pair so far.
///
/// Pairs are asked in rounds, all of a round at once and with the same limit, so neither the pairs that are asked nor
/// their limits depend on threads.
class ClosestSearch {
 public:
  ClosestSearch(const Scene::Impl& scene, const DistanceOptions& errors, const ClosestObjectsOptions& options)
      : scene_(scene), options_(errors), filter_(options.filter), cache_(options.cache) {
    closest_.result.status = Status::beyond_limit;
    closest_.result.lower = options.max_distance;
    closest_.result.upper = std::numeric_limits<double>::infinity();
  }

  ClosestObjects run();

 private:
  struct Waiting {
    double bound;  // of the distance
    ObjectPair pair;
    friend bool operator<(const Waiting& s, const Waiting& t) {
      if (s.bound != t.bound) return s.bound < t.bound;
      return s.pair.a != t.pair.a ? s.pair.a < t.pair.a : s.pair.b < t.pair.b;
    }
  };
  // A first round is small, because it decides how many pairs there are to be asked at all.
  static constexpr std::size_t most_in_round = 64, most_waiting = 1024, seeds = 8;

  bool is_found() const { return closest_.objects.a != no_id; }
  /// Pairs farther apart need not be asked; if one has been found, those exactly as far apart neither.
  double limit() const { return std::min(closest_.result.upper, options_.max_distance); }
  bool may_matter(double bound) const { return is_found() ? bound < limit() : bound <= limit(); }

  void wait(std::uint32_t rank_a, std::uint32_t rank_b);
  void ask_waiting();
  void ask_round(std::span<const Waiting> round);
  void ask_neighbors();

  const Scene::Impl& scene_;
  const DistanceOptions options_;
  const std::optional<ObjectPairFilter> filter_;
  SceneCache* const cache_;
  ClosestObjects closest_;
  std::vector<Waiting> waiting_;
  std::vector<ObjectPair> pairs_;
  std::vector<DistanceResult> results_;
};

void ClosestSearch::wait(std::uint32_t rank_a, std::uint32_t rank_b) {
  const double bound = scene_.tree.lower_bound(rank_a, rank_b);
  if (!may_matter(bound)) return;
  const ObjectPair pair = scene_.pair_of(rank_a, rank_b);
  if (!filter_ || (*filter_)(pair.a, pair.b)) waiting_.push_back({bound, pair});
}

void ClosestSearch::ask_round(std::span<const Waiting> round) {
  DistanceOptions options = options_;
  options.max_distance = limit();
  pairs_.clear();
  for (const Waiting& next : round) pairs_.push_back(next.pair);
  results_.resize(round.size());
  std::span<QueryCache* const> caches;
  if (cache_ != nullptr) caches = cache_->impl().caches_of(pairs_);
  base::parallel_for(round.size(), 1, [&](std::size_t i) {
    const Placed &a = scene_.placed(pairs_[i].a), &b = scene_.placed(pairs_[i].b);
    DistanceOptions with_cache = options;
    with_cache.cache = caches.empty() ? nullptr : caches[i];
    results_[i] = distance(a, b, with_cache);
  });
  DistanceResult& closest = closest_.result;
  for (std::size_t i = 0; i < round.size(); ++i) {
    const QueryStats stats{closest.stats.node_tests + results_[i].stats.node_tests,
                           closest.stats.triangle_tests + results_[i].stats.triangle_tests};
    const double lower = std::min(closest.lower, results_[i].lower);
    if (results_[i].upper < closest.upper) {
      closest = results_[i];
      closest_.objects = pairs_[i];
    }
    closest.lower = lower, closest.stats = stats;
  }
}

/// Asks the pairs that wait, those that matter.
void ClosestSearch::ask_waiting() {
  std::sort(waiting_.begin(), waiting_.end());
  std::size_t in_round = 1;
  for (std::size_t begin = 0; begin < waiting_.size() && may_matter(waiting_[begin].bound);) {
    std::size_t end = begin;
    while (end < waiting_.size() && end - begin < in_round && may_matter(waiting_[end].bound)) ++end;
    ask_round(std::span(waiting_).subspan(begin, end - begin));
    begin = end;
    in_round = std::min(2 * in_round, most_in_round);
  }
  waiting_.clear();
}

/// Asks a few pairs that are likely to be close: the closest pair of the last frame, and pairs that follow each other
/// in Hilbert order.
void ClosestSearch::ask_neighbors() {
  if (cache_ != nullptr) {
    const ObjectPair last = cache_->impl().closest;
    if (scene_.contains(last.a) && scene_.contains(last.b) && (!filter_ || (*filter_)(last.a, last.b))) {
      ask_round({{{0, last}}});
    }
  }
  for (std::uint32_t rank = 0; rank + 1 < scene_.tree.size(); ++rank) wait(rank, rank + 1);
  if (waiting_.size() > seeds) {
    std::nth_element(waiting_.begin(), waiting_.begin() + seeds, waiting_.end());
    waiting_.resize(seeds);
  }
  ask_waiting();
}

ClosestObjects ClosestSearch::run() {
  ask_neighbors();
  const auto visit = [&](std::uint32_t rank_a, std::uint32_t rank_b) {
    wait(rank_a, rank_b);
    return true;
  };
  for (std::uint32_t leaf = 0; leaf < scene_.tree.leaf_count() && closest_.result.upper > 0; ++leaf) {
    scene_.tree.visit_pairs(leaf, scene::margin_with_error(limit()), visit);
    if (waiting_.size() > most_waiting) ask_waiting();
  }
  ask_waiting();
  if (is_found()) {
    DistanceResult& result = closest_.result;
    result.lower = std::min(result.lower, result.upper);
    if (result.upper > 0) result.status = result.lower == result.upper ? Status::exact : Status::within_error;
  }
  if (cache_ != nullptr) cache_->impl().closest = closest_.objects;
  return closest_;
}

}  // namespace

ClosestObjects Scene::closest_objects(const ClosestObjectsOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  const Impl& scene = impl("closest_objects");
  LIMBER_REQUIRE(scene.is_committed(),
                 "limber::Scene::closest_objects: objects or models have changed since the last commit");
  const DistanceOptions errors{options.relative_error, options.absolute_error, options.max_distance};
  base::check_options(errors, "limber::Scene::closest_objects");
  return ClosestSearch(scene, errors, options).run();
}

}  // namespace limber
