// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/check.h"

namespace limber::pair {

/// Judges a search direction that is a guess: the normal of a leaf, not the separation of two triangles. One that
/// prunes nothing is given up, and after some of these no other is chosen.
class AimedDirection {
 public:
  bool may_choose() const { return wasted_ < most_wasted; }
  void choose() {
    LIMBER_ASSERT(may_choose());
    is_chosen_ = true;
  }
  /// Another direction has taken the place of the chosen one: that of a closest pair.
  void replace() { is_chosen_ = false; }

  /// Whether the direction in use is a chosen one, to be judged after each expansion.
  bool is_chosen() const { return is_chosen_; }
  /// Notes whether it has pruned what no other bound has. True if the direction is to be given up.
  bool gives_up(bool has_pruned) {
    LIMBER_ASSERT(is_chosen_);
    idle_ = has_pruned ? 0 : idle_ + 1;
    if (idle_ < most_idle) return false;
    idle_ = 0;
    ++wasted_;
    is_chosen_ = false;
    return true;
  }

 private:
  static constexpr int most_idle = 3;    // expansions in a row
  static constexpr int most_wasted = 2;  // directions

  int idle_ = 0, wasted_ = 0;
  bool is_chosen_ = false;
};

}  // namespace limber::pair
