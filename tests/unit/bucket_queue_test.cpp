// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/node_pair.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "scenes/scenes.h"

namespace limber::testing {
namespace {

using pair::BucketQueue;
using pair::NodePair;

NodePair pair_with(float bound_sq) { return {bound_sq, {0, 0}, 0, 0, false}; }

// Not inlined: GCC 12 would warn of an overflow that an assertion excludes.
[[gnu::noinline]] void push(BucketQueue& queue, float bound_sq) { queue.push(pair_with(bound_sq)); }
[[gnu::noinline]] void push_first(BucketQueue& queue, float bound_sq) { queue.push_first(pair_with(bound_sq)); }

TEST(BucketQueue, HoldsWhatItWasGivenAndKnowsTheLeast) {
  scenes::Rng rng(60);
  for (int i = 0; i < 200; ++i) {
    const auto queue = std::make_unique<BucketQueue>();
    queue->focus(1, static_cast<float>(rng.uniform(1, 30)));
    std::multiset<float> held;
    const auto pop = [&] {
      ASSERT_EQ(queue->least_bound_sq(), *held.begin());
      const auto taken = held.find(queue->pop().bound_sq);
      ASSERT_NE(taken, held.end());
      held.erase(taken);
    };
    for (std::uint64_t k = rng.below(100); k > 0; --k) {
      const float bound_sq = *held.insert(static_cast<float>(rng.uniform(0, 40)));
      rng.below(8) == 0 ? push_first(*queue, bound_sq) : push(*queue, bound_sq);
      if (rng.below(4) == 0) pop();
      if (rng.below(16) == 0) queue->focus(1, static_cast<float>(rng.uniform(1, 30)));
    }
    while (!queue->empty() && !HasFatalFailure()) pop();
    ASSERT_TRUE(held.empty());
  }
}

TEST(BucketQueue, IsTakenNearestFirstToWithinABucket) {
  scenes::Rng rng(61);
  const auto queue = std::make_unique<BucketQueue>();
  queue->focus(0, 64);
  for (int i = 0; i < 1000; ++i) push(*queue, static_cast<float>(rng.uniform(0, 64)));
  float last = 0;
  while (!queue->empty()) {
    const float bound_sq = queue->pop().bound_sq;
    ASSERT_GT(bound_sq, last - 1);
    last = bound_sq;
  }
  EXPECT_GT(last, 60);
}

TEST(BucketQueue, UsesTheRoomOfTakenPairsAgain) {
  const auto queue = std::make_unique<BucketQueue>();
  queue->focus(0, 64);
  push(*queue, 63);
  for (int i = 0; i < 100'000; ++i) {  // more than there is room for
    push(*queue, 1);
    ASSERT_TRUE(queue->has_only_ordered()) << i;  // no pair had to go to the stack
    ASSERT_EQ(queue->pop().bound_sq, 1);
  }
}

TEST(BucketQueue, IsNotGivenUpWhileAPairIsBelowTheLimit) {
  const auto queue = std::make_unique<BucketQueue>();
  queue->focus(0, 64);  // buckets of width 1
  push(*queue, 10.25F);
  EXPECT_FALSE(queue->all_beyond(10.5F));  // in the bucket of the limit, and below the limit
  EXPECT_FALSE(queue->all_beyond(40));
  EXPECT_TRUE(queue->all_beyond(9.5F));
  push_first(*queue, 50);
  EXPECT_FALSE(queue->all_beyond(9.5F));
}

}  // namespace
}  // namespace limber::testing
