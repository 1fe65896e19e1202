// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace limber::pair {

/// Decides when a traversal goes straight down to leaves, to the nearest child of each node, instead of best first.
///
/// Best first comes to leaves late, so the upper bound would stay loose for long. So a traversal begins with a descent,
/// and descends again from time to time (docs/design/fast_engine.md).
class Descents {
 public:
  bool is_descending() const { return descends_; }
  bool has_reached_leaves() const { return next_ != never; }
  /// Whether to descend again.
  bool is_due(std::uint64_t steps) const { return steps >= next_; }

  /// Begins a descent that is due; if it is of no use, only puts the next one off.
  void start(std::uint64_t steps, bool is_of_use) {
    descends_ = is_of_use;
    next_ = factor * steps;
  }
  void stop() { descends_ = false; }
  /// Two leaves are compared: a descent ends here. Returns whether there was one.
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
