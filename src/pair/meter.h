// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pair/budget_meter.h"

namespace limber::pair {

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
