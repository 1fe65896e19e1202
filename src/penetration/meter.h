// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pair/budget_meter.h"

namespace limber::penetration {

/// The budget of a query that consists of several searches, which count their steps together.
class Meter {
 public:
  explicit Meter(const QueryBudget& budget) : budget_(budget) {}

  /// To be asked before every step, which it counts. Once it is spent, it stays so.
  bool is_spent() {
    if (budget_.stopped_by() != StoppedBy::nothing || budget_.is_spent(steps_)) return true;
    ++steps_;
    return false;
  }
  StoppedBy stopped_by() const { return budget_.stopped_by(); }

  QueryStats stats{};

 private:
  pair::BudgetMeter budget_;
  std::uint64_t steps_ = 0;
};

}  // namespace limber::penetration
