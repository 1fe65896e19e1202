// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "base/check.h"

namespace limber::pair {

/// Decides, from what it has given so far, whether to try something that saves time in some queries and costs time in
/// others. Where it does not pay, it is tried in few queries, so that its cost is a small part of all.
///
/// Gains and losses are parts of the time of a query that does without it.
class Trial {
 public:
  /// To be asked once a query.
  bool is_due() {
    if (credit_ >= to_begin) is_on_ = true;
    if (credit_ < to_go_on) is_on_ = false;
    if (!is_on_) credit_ += allowance;
    return is_on_;
  }
  void add_gain(double gain) {
    LIMBER_ASSERT(gain <= 1);
    credit_ = std::clamp(credit_ + gain, -1.0, 2.0);
  }

 private:
  // Several queries in a row: the first may only prepare what the next one profits from.
  static constexpr double to_begin = 0.5, to_go_on = 0.2, allowance = 1. / 64;

  double credit_ = to_begin;
  bool is_on_ = true;
};

}  // namespace limber::pair
