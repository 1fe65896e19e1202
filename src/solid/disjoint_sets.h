// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/check.h"
#include "pair/budget_meter.h"

namespace limber::solid {

/// Disjoint sets of the numbers below some count: union-find with path halving.
class DisjointSets {
 public:
  /// They are incomplete, and must not be used, if the meter is spent before they are made.
  DisjointSets(std::size_t count, pair::Meter& meter) {
    parent_.reserve(count);
    while (parent_.size() < count && !meter.is_spent_at(parent_.size())) parent_.push_back(parent_.size());
  }

  /// The representative of a number's set, the least of its members.
  std::size_t find(std::size_t i) {
    LIMBER_ASSERT(i < parent_.size());
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::size_t i, std::size_t j) {
    const auto [low, high] = std::minmax({find(i), find(j)});
    parent_[high] = low;
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace limber::solid
