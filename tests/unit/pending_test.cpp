// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "query/pending.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "scenes/scenes.h"

namespace limber::testing {
namespace {

using query::NodePair;
using query::Pending;

NodePair pair_with(float bound_sq) { return {bound_sq, {0, 0}, 0, 0}; }

// Not inlined: GCC 12 would warn of an overflow that an assertion excludes.
[[gnu::noinline]] void push(Pending& pending, float bound_sq) { pending.push(pair_with(bound_sq)); }
[[gnu::noinline]] void push_first(Pending& pending, float bound_sq) { pending.push_first(pair_with(bound_sq)); }

TEST(Pending, HoldsWhatItWasGiven) {
  scenes::Rng rng(60);
  for (int i = 0; i < 50; ++i) {
    const auto pending = std::make_unique<Pending>();
    pending->focus(1, static_cast<float>(rng.uniform(1, 30)));
    std::vector<float> given, taken;
    for (std::uint64_t k = rng.below(100); k > 0; --k) {
      given.push_back(static_cast<float>(rng.uniform(0, 40)));
      push(*pending, given.back());
      if (rng.below(4) == 0) taken.push_back(pending->pop().bound_sq);
      if (rng.below(16) == 0) pending->focus(1, static_cast<float>(rng.uniform(1, 30)));
    }
    while (!pending->empty()) taken.push_back(pending->pop().bound_sq);
    std::sort(given.begin(), given.end());
    std::sort(taken.begin(), taken.end());
    ASSERT_EQ(taken, given);
  }
}

TEST(Pending, IsTakenNearestFirstToWithinAStep) {
  scenes::Rng rng(61);
  const auto pending = std::make_unique<Pending>();
  pending->focus(0, 64);
  for (int i = 0; i < 1000; ++i) push(*pending, static_cast<float>(rng.uniform(0, 64)));
  float last = 0;
  while (!pending->empty()) {
    const float bound_sq = pending->pop().bound_sq;
    ASSERT_GT(bound_sq, last - 1);
    last = bound_sq;
  }
  EXPECT_GT(last, 60);
}

TEST(Pending, IsNotGivenUpWhileAPairIsBelowTheLimit) {
  const auto pending = std::make_unique<Pending>();
  pending->focus(0, 64);  // steps of 1
  push(*pending, 10.25F);
  EXPECT_FALSE(pending->all_beyond(10.5F));  // within the step of the limit, and below it
  EXPECT_FALSE(pending->all_beyond(40));
  EXPECT_TRUE(pending->all_beyond(9.5F));
  push_first(*pending, 50);
  EXPECT_FALSE(pending->all_beyond(9.5F));
}

}  // namespace
}  // namespace limber::testing
