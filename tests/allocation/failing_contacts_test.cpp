// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Every allocation of what is built from contacts and for self-queries fails once; see failing_heap_test.cpp.
#include <gtest/gtest.h>

#include <new>
#include <vector>

#include "allocation/heap.h"
#include "limber/contacts.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

/// Runs `call` with each of its allocations failing once, and `check` after each run that threw. Returns how many
/// allocations there are.
template <typename Call, typename Check>
int fail_each(const Call& call, const Check& check) {
  for (int k = 0;; ++k) {
    bool threw = false, failed = false;
    {
      const FailingHeap heap(k, Failing::once);
      try {
        call();
      } catch (const std::bad_alloc&) {
        threw = true;
      }
      failed = heap.has_failed();
    }
    EXPECT_EQ(threw, failed) << k;
    if (!failed) return k;
    check();
  }
}

TEST(FailingHeap, LeavesContactsThatAreToBeReducedAsTheyWere) {
  const Model ball(scenes::ball(12, 8));
  std::vector<Contact> contacts(500);
  contacts.resize(std::min(limber::contacts({ball}, {ball, {{}, {1.9, 0, 0}}}, 0.1, contacts).count, contacts.size()));
  ASSERT_GT(contacts.size(), 20U);
  const std::vector<Contact> before = contacts;
  const int count = fail_each([&] { reduce_contacts(contacts, {.radius = 0.2}); },
                              [&] {
                                for (std::size_t i = 0; i < before.size(); ++i) {
                                  ASSERT_EQ(contacts[i].triangle_a, before[i].triangle_a);
                                  ASSERT_EQ(contacts[i].triangle_b, before[i].triangle_b);
                                }
                              });
  EXPECT_EQ(count, 5);
}

TEST(FailingHeap, LeavesAnEmptyCacheForSelfQueries) {
  const Model ball(scenes::ball(12, 8));
  const double truth = self_distance(ball).upper;
  QueryCache cache;
  const auto check = [&] { EXPECT_EQ(self_distance(ball, {.cache = &cache}).upper, truth), cache.clear(); };
  EXPECT_EQ(fail_each([&] { self_distance(ball, {.cache = &cache}); }, check), 1);
  cache.clear();
  EXPECT_EQ(fail_each([&] { self_collide(ball, {.cache = &cache}); }, check), 1);
}

TEST(FailingHeap, IsReportedByNeighborRings) {
  const Mesh ball = scenes::ball(12, 8);
  EXPECT_GT(fail_each([&] { const NeighborRings rings(ball, 2); }, [] {}), 5);
}

}  // namespace
}  // namespace limber::testing
