// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace limber::pair {

/// Decides when a traversal descends: goes straight down to two leaves, always to the nearest child, instead of taking
/// the nearest pair of all.
///
/// Best first comes to leaves late, so the upper bound would stay loose for long. So a traversal begins with a descent,
/// and descends again from time to time (docs/design/one_query.md).
class Descents {
 public:
  bool is_descending() const { return descends_; }
  bool has_reached_leaves() const { return next_ != never; }
  /// Whether to begin another descent.
  bool is_due(std::uint64_t steps) const { return steps >= next_; }

  /// Begins a descent that is due, and sets when the next one is due.
  void start(std::uint64_t steps) {
    postpone(steps);
    descends_ = true;
  }
  /// Leaves out a descent that is due, and sets when the next one is due.
  void postpone(std::uint64_t steps) {
    descends_ = false;
    next_ = factor * steps;
  }
  void stop() { descends_ = false; }
  /// Ends a descent: two leaves are compared. Returns whether there was one.
  bool end_at_leaves(std::uint64_t steps) {
    next_ = std::max(has_reached_leaves() ? next_ : 0, steps + steps_between);
    return std::exchange(descends_, false);
  }

 private:
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  // A descent begins after so many steps without comparing leaves, and not before the number of steps is so many times
  // what it was at the last descent.
  static constexpr std::uint64_t steps_between = 9, factor = 3;

  std::uint64_t next_ = never;
  bool descends_ = true;
};

}  // namespace limber::pair
