// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace limber::pair {

/// Decides whether two leaves are first tested as a whole: whether the search direction tells all their triangles
/// apart. That test pays where the direction is that of a close pair, and everything is nearly as far apart. It is made
/// on credit: a success adds to the credit, a failure takes from it, and without credit there are no more tests.
class WholeLeaves {
 public:
  bool are_tested() const { return credit_ > 0; }

  /// Gives a little credit: a direction is known that may be that of a close pair.
  void allow_some() { credit_ = at_first; }
  /// Gives all credit: a close pair has been found.
  void allow_many() { credit_ = most; }
  /// Notes whether a test has pruned its two leaves.
  void note(bool is_pruned) { credit_ = is_pruned ? std::min(credit_ + gain, most) : credit_ - 1; }

 private:
  // In failures: a success saves about two (bench/realtime/caches.cpp).
  static constexpr int gain = 2, at_first = 8, most = 64;

  int credit_ = 0;
};

}  // namespace limber::pair
