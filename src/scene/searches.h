// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <limits>
#include <string>

#include "base/arguments.h"
#include "base/check.h"
#include "limber/scene.h"

/// Searches of a scene for one pair, which queries of one configuration and of many share. Their answers do not depend
/// on the tasks that they make.
namespace limber::scene {

/// Every pair may be a task of its own: the shortest queries take as long as starting one, others a thousand times as
/// long.
constexpr std::size_t pairs_per_task = 1;
/// A search that is itself a part of a task makes none: it would wait for tasks, and take up others meanwhile.
constexpr std::size_t no_tasks = std::numeric_limits<std::size_t>::max();

/// Searches ask rounds of pairs, all of a round at once. The first round is small, because it decides how many pairs
/// there are to be asked at all; every other one is twice as large as the one before, up to this.
constexpr std::size_t most_in_round = 64;

/// Pre: the scene is committed, and the options are what they have to be.
ClosestObjectsResult find_closest(const Scene::Impl& scene, const SceneDistanceOptions& options, std::size_t grain);
AnyWithinResult find_any_within(const Scene::Impl& scene, double max_distance, const SceneQueryOptions& options,
                                std::size_t grain);

/// Checks how distances of a scene are asked for: its caches are those of scenes.
inline void check_options(const DistanceOptions& options, const char* function) {
  base::check_options(options, function);
  LIMBER_REQUIRE(options.cache == nullptr, (std::string(function) + ": distance takes no cache of two models").c_str());
}

/// Whether a budget ends all queries that share it, not one of them alone.
inline bool ends_all(StoppedBy stopped_by) {
  return stopped_by == StoppedBy::deadline || stopped_by == StoppedBy::cancel;
}

/// Which limit has ended a call, if one has.
inline StoppedBy ended_by(const QueryBudget& budget) {
  for (const std::atomic<bool>* const flag : {budget.cancel, budget.abandon}) {
    if (flag != nullptr && flag->load(std::memory_order_relaxed)) return StoppedBy::cancel;
  }
  const bool is_late = budget.deadline && std::chrono::steady_clock::now() >= *budget.deadline;
  return is_late ? StoppedBy::deadline : StoppedBy::nothing;
}

/// Takes into account what has stopped a part of a search, if anything has: what ends all stays.
inline void note(StoppedBy part, StoppedBy& search) {
  if (!ends_all(search) && part != StoppedBy::nothing) search = part;
}

}  // namespace limber::scene
