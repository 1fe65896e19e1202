// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace limber::testing {
namespace {

/// Calls something in arenas of one, two and five threads, also where the machine has fewer.
template <typename Call>
void in_small_arenas(const Call& call) {
  const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, 5);
  for (const int threads : {1, 2, 5}) oneapi::tbb::task_arena(threads).execute(call);
}

TEST(ParallelInOrder, TakesEachInOrderAndMakesIntoWhatIsLeft) {
  in_small_arenas([] {
    for (const std::size_t count : {0, 1, 2, 1000}) {
      std::vector<std::size_t> taken;
      std::atomic<int> filled{0};
      const auto make = [&](std::size_t i, std::vector<std::size_t>& made) {
        if (!made.empty()) ++filled;
        // The first of each ten take longest, so that later ones overtake them.
        volatile double work = 1;
        for (int k = 0; k < (i % 10 == 0 ? 20'000 : 10); ++k) work = work * 1.000001;
        made.push_back(i);
      };
      const auto take = [&](std::vector<std::size_t>& made) {
        taken.insert(taken.end(), made.begin(), made.end());
        made.clear();
      };
      base::parallel_in_order<std::vector<std::size_t>>(count, make, take);
      std::vector<std::size_t> expected(count);
      std::iota(expected.begin(), expected.end(), std::size_t{0});
      EXPECT_EQ(taken, expected);
      EXPECT_EQ(filled, 0);
    }
  });
}

TEST(ParallelInOrder, PassesOnWhatIsThrown) {
  in_small_arenas([] {
    for (const bool in_take : {false, true}) {
      std::size_t taken = 0;
      const auto make = [&](std::size_t i, std::size_t& made) {
        if (!in_take && i == 50) throw std::runtime_error("made");
        made = i;
      };
      const auto take = [&](std::size_t& made) {
        if (in_take && made == 50) throw std::runtime_error("taken");
        EXPECT_EQ(made, taken++);
      };
      EXPECT_THROW(base::parallel_in_order<std::size_t>(100, make, take), std::runtime_error);
      EXPECT_LE(taken, 50U);
    }
  });
}

}  // namespace
}  // namespace limber::testing
