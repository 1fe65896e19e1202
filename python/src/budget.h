// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>

#include "bindings.h"
#include "limber/distance.h"

/// When a query that Python asks has to end.
namespace limber::python {

/// A flag that ends queries from another thread.
struct CancelFlag {
  std::atomic<bool> flag = false;
};

/// A budget. Whoever creates it keeps the flag alive.
struct BudgetObject {
  /// `deadline` counts the seconds of time.monotonic().
  ///
  /// Throws   nb::value_error for a deadline that is not a number.
  BudgetObject(std::optional<double> deadline, std::optional<std::uint64_t> max_steps, const CancelFlag* cancel) {
    if (deadline) {
      if (std::isnan(*deadline)) throw nb::value_error("deadline: expected seconds of time.monotonic(); got nan");
      // Python's time.monotonic() and this clock are the same clock of the system. A century is as good as for ever.
      using Clock = std::chrono::steady_clock;
      constexpr double century_s = 3.2e9;
      const std::chrono::duration<double> since_start(std::clamp(*deadline, 0.0, century_s));
      budget.deadline = Clock::time_point(std::chrono::duration_cast<Clock::duration>(since_start));
    }
    if (max_steps) budget.max_steps = *max_steps;
    if (cancel != nullptr) budget.cancel = &cancel->flag;
  }

  QueryBudget budget;
};

/// The budget that a query gets: without limits if Python gave none.
inline QueryBudget budget_of(const BudgetObject* budget) { return budget != nullptr ? budget->budget : QueryBudget{}; }

/// Whether time is up, or the flag is set.
inline bool has_ended(const QueryBudget& budget) {
  return (budget.cancel != nullptr && *budget.cancel) ||
         (budget.deadline && std::chrono::steady_clock::now() >= *budget.deadline);
}

}  // namespace limber::python
