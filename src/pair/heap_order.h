// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "base/check.h"

namespace limber::pair {

/// The order of PairWalk, and of searches of one tree, that goes best first: a heap. Of two entries one comes_before()
/// the other: standard libraries differ in how heaps order ties, so there are none.
template <typename Entry>
class HeapOrder {
 public:
  static constexpr bool raises = false;

  bool empty() const { return entries_.empty(); }
  const Entry& next() const { return entries_.front(); }
  Entry take() {
    LIMBER_ASSERT(!empty());
    std::pop_heap(entries_.begin(), entries_.end(), is_later);
    const Entry entry = entries_.back();
    entries_.pop_back();
    return entry;
  }
  void push(const Entry& entry) {
    entries_.push_back(entry);
    std::push_heap(entries_.begin(), entries_.end(), is_later);
  }
  void clear() { entries_.clear(); }

  void add_first(const Entry& entry) { push(entry); }
  template <typename Expansion, typename Bounds>
  void add(const Expansion& e, const Bounds& bounds) {
    for (unsigned rest = e.kept.all; rest != 0; rest &= rest - 1) {
      push(bounds.child_pair(e, static_cast<std::uint32_t>(std::countr_zero(rest))));
    }
  }
  static constexpr bool takes_raised(const Entry&) { return false; }
  static constexpr void follow_cutoff() {}
  static constexpr void drop_pruned() {}

 private:
  static bool is_later(const Entry& p, const Entry& q) { return q.comes_before(p); }

  std::vector<Entry> entries_;
};

}  // namespace limber::pair
