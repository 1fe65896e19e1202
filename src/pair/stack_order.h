// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "base/check.h"

namespace limber::pair {

/// The order of PairWalk that goes depth first, with a stack: for queries that need every pair. Of pairs that are added
/// together the last is taken first; or, if pairs have an order, comes_before(), the first of that order, and nodes
/// with themselves come after all others.
template <typename Pair, std::uint32_t capacity>
class StackOrder {
 public:
  static constexpr bool raises = false;  // a better bound of a pair changes nothing

  bool empty() const { return size_ == 0; }
  Pair take() {
    --size_;
    if constexpr (is_sorted) group_ = size_;
    return pairs_[size_];
  }

  void push(const Pair& pair) {
    LIMBER_ASSERT(size_ < capacity);
    std::uint32_t at = size_++;
    if constexpr (is_sorted) {
      for (; at > group_ && pairs_[at - 1].comes_before(pair); --at) pairs_[at] = pairs_[at - 1];
    }
    pairs_[at] = pair;
  }
  void add_first(const Pair& pair) { push(pair); }
  void add_itself(const Pair& pair) {
    if constexpr (is_sorted) {
      LIMBER_ASSERT(size_ < capacity);
      std::copy_backward(pairs_ + group_, pairs_ + size_, pairs_ + size_ + 1);
      pairs_[group_++] = pair, ++size_;
    } else {
      push(pair);
    }
  }
  /// Adds the children that were kept.
  template <typename Expansion, typename Bounds>
  void add(const Expansion& e, const Bounds& bounds) {
    for (unsigned rest = e.kept.all; rest != 0; rest &= rest - 1) {
      push(bounds.child_pair(e, static_cast<std::uint32_t>(std::countr_zero(rest))));
    }
  }
  static constexpr bool takes_raised(const Pair&) { return false; }
  static constexpr void follow_cutoff() {}
  static constexpr void drop_pruned() {}

  /// Appends all pairs, in the order in which they would be taken: what a pair has become.
  void move_to(std::vector<Pair>& pairs, const Pair& from) {
    const auto begin = static_cast<std::ptrdiff_t>(pairs.size());
    pairs.insert(pairs.end(), pairs_, pairs_ + size_);
    if constexpr (is_sorted) Pair::note_later(std::span<Pair>(pairs).subspan(static_cast<std::size_t>(begin)), from);
    std::reverse(pairs.begin() + begin, pairs.end());
    size_ = group_ = 0;
  }
  /// Those that are left, the next one last.
  std::span<const Pair> pairs() const { return {pairs_, size_}; }

 private:
  static constexpr bool is_sorted = requires(const Pair& p) { p.comes_before(p); };

  Pair pairs_[capacity];
  std::uint32_t size_ = 0;
  std::uint32_t group_ = 0;  // where those begin that are added together
};

}  // namespace limber::pair
