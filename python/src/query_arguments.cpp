// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "query_arguments.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace limber::python {

BudgetObject::BudgetObject(std::optional<double> deadline, std::optional<std::uint64_t> max_steps,
                           const CancelFlag* cancel) {
  if (deadline) {
    if (std::isnan(*deadline)) throw nb::value_error("deadline: expected seconds of time.monotonic(); got nan");
    // Python's time.monotonic() and this clock are the same clock of the system. A century is as good as for ever.
    using Clock = std::chrono::steady_clock;
    constexpr double century_s = 3.2e9;
    const std::chrono::duration<double> since_start(std::clamp(*deadline, 0.0, century_s));
    budget.deadline = Clock::time_point(std::chrono::duration_cast<Clock::duration>(since_start));
  }
  if (max_steps) budget.max_steps = *max_steps;
  if (cancel != nullptr) budget.cancel = &cancel->flag();
}

}  // namespace limber::python
