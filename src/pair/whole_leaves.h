// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace limber::pair {

/// Decides whether two leaves are first tried to be pruned as a whole, along the search direction. That pays where the
/// direction is that of a close pair, and everything is nearly as far apart.
class WholeLeaves {
 public:
  bool are_tried() const { return credit_ > 0; }

  /// A direction is known that may be that of a close pair.
  void try_some() { credit_ = at_first; }
  /// A close pair has been found.
  void try_many() { credit_ = most; }
  /// Notes what a try has given. Where too few succeed, there are no more.
  void note(bool is_pruned) { credit_ = is_pruned ? std::min(credit_ + gain, most) : credit_ - 1; }

 private:
  // In failures: a success saves about two (bench/realtime/caches.cpp).
  static constexpr int gain = 2, at_first = 8, most = 64;

  int credit_ = 0;
};

}  // namespace limber::pair
