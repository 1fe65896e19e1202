// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/arguments.h"
#include "limber/distance.h"

namespace limber::pair {

/// Tells a search when its budget is spent.
///
/// Promise  Unless it is cancelled or may make no steps, every search makes one, so that whoever asks again and again
///          gets an answer, however short the time.
class BudgetMeter {
 public:
  /// Without limits.
  BudgetMeter() = default;
  explicit BudgetMeter(const QueryBudget& budget) : budget_(budget), is_limited_(base::is_limited(budget)) {}

  /// Whether the query has limits that its answer keeps to; `abandon` is none.
  bool is_limited() const { return is_limited_; }

  /// To be asked before every step. `steps` is how many have been made.
  bool is_spent(std::uint64_t steps) {
    if (!is_limited_) return is_abandoned();
    if (steps >= budget_.max_steps) {
      stopped_by_ = StoppedBy::max_steps;
    } else {
      look(steps > 0 || calls_ > most_calls_without_step);
    }
    return stopped_by_ != StoppedBy::nothing;
  }
  /// Whether a long step should not be finished; `steps` as before, this one included. The first step always is.
  bool cuts_short(std::uint64_t steps) {
    if (!is_limited_) return is_abandoned();
    if (steps <= 1) return false;
    look(true);
    return stopped_by_ != StoppedBy::nothing;
  }

  /// Why it was spent, if it was.
  StoppedBy stopped_by() const { return stopped_by_; }

 private:
  bool is_abandoned() {
    if (budget_.abandon == nullptr || !budget_.abandon->load(std::memory_order_relaxed)) return false;
    stopped_by_ = StoppedBy::cancel;
    return true;
  }

  void look(bool minds_deadline) {
    if (budget_.cancel != nullptr && budget_.cancel->load(std::memory_order_relaxed)) {
      stopped_by_ = StoppedBy::cancel;
    } else if (is_abandoned()) {
      return;
    } else if (budget_.deadline && ++calls_ % calls_per_look == 0 && minds_deadline &&
               std::chrono::steady_clock::now() >= *budget_.deadline) {
      stopped_by_ = StoppedBy::deadline;
    }
  }

  // Looking at the clock takes a fifth of a step.
  static constexpr std::uint64_t calls_per_look = 2;
  // What a front has to be compared again is no step.
  static constexpr std::uint64_t most_calls_without_step = 64;

  QueryBudget budget_;
  bool is_limited_ = false;
  std::uint64_t calls_ = 0;
  StoppedBy stopped_by_ = StoppedBy::nothing;
};

/// The budget of a query that consists of several searches, which count their steps together.
class Meter {
 public:
  explicit Meter(const QueryBudget& budget = {})
      : limits_of_time_{.deadline = budget.deadline, .cancel = budget.cancel, .abandon = budget.abandon},
        budget_(budget) {}

  /// To be asked before every step, which it counts. Once it is spent, it stays so.
  bool is_spent() {
    if (stopped_by_ == StoppedBy::nothing && budget_.is_spent(steps_)) stopped_by_ = budget_.stopped_by();
    ++steps_;
    return stopped_by_ != StoppedBy::nothing;
  }
  /// To be asked before the i-th of many short steps: counts one in 64.
  bool is_spent_at(std::size_t i) { return i % 64 == 0 ? is_spent() : stopped_by_ != StoppedBy::nothing; }
  /// Takes over that one of the queries below was stopped, if it was.
  void stop(StoppedBy reason) {
    if (stopped_by_ == StoppedBy::nothing) stopped_by_ = reason;
  }
  StoppedBy stopped_by() const { return stopped_by_; }
  /// For the public queries that a search asks, whose steps do not count: the deadline and the flag.
  const QueryBudget& limits_of_time() const { return limits_of_time_; }

  QueryStats stats{};

 private:
  QueryBudget limits_of_time_;
  BudgetMeter budget_;
  std::uint64_t steps_ = 0;
  StoppedBy stopped_by_ = StoppedBy::nothing;
};

}  // namespace limber::pair
