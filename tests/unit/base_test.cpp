// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "base/check.h"
#include "base/decoded.h"
#include "base/parallel.h"
#include "base/rounding.h"
#include "limber/base.h"

namespace limber::testing {
namespace {

TEST(Result, HoldsAValueOrAnError) {
  const Result<int> good = 7;
  ASSERT_TRUE(static_cast<bool>(good));
  EXPECT_EQ(*good, 7);
  EXPECT_EQ(good.value(), 7);
  const Result<int> bad = Error{ErrorCode::empty_mesh, "nothing there", 3};
  ASSERT_FALSE(static_cast<bool>(bad));
  EXPECT_EQ(bad.error().code, ErrorCode::empty_mesh);
  EXPECT_EQ(bad.error().where, 3U);
}

TEST(Result, ValueThrowsTheErrorItHolds) {
  const Result<int> bad = Error{ErrorCode::non_finite, "vertex 4 is not finite", 4};
  try {
    static_cast<void>(bad.value());
    FAIL() << "no exception";
  } catch (const BadResult& e) {
    EXPECT_STREQ(e.what(), "vertex 4 is not finite");
    EXPECT_EQ(e.error().code, ErrorCode::non_finite);
  }
  const Result<void> nothing = Error{ErrorCode::too_large, "x", {}};
  EXPECT_THROW(nothing.value(), BadResult);
  EXPECT_NO_THROW(Result<void>().value());
}

TEST(Result, MovesItsValueOut) {
  Result<std::unique_ptr<int>> owner = std::make_unique<int>(5);
  const std::unique_ptr<int> taken = std::move(owner).value();
  EXPECT_EQ(*taken, 5);
}

TEST(AssertHandler, IsCalledWithTheExpressionAndCanBeReplaced) {
  static const char* seen = nullptr;
  const AssertHandler previous =
      set_assert_handler([](const char* expression, const char*, int) { seen = expression; });
  base::report_violation("1 == 2", "file.cpp", 3);
  set_assert_handler(previous);
  EXPECT_STREQ(seen, "1 == 2");
}

TEST(AssertHandler, ThrowsByDefault) {
  EXPECT_THROW(base::report_violation("1 == 2", "file.cpp", 3), std::logic_error);
}

TEST(Rounding, SumsAndDistancesErrOnTheirSide) {
  EXPECT_EQ(base::add_up(0, 3), 3);
  EXPECT_GT(base::add_up(1, 0x1p-60), 1);
  const Vec3 a{1, 1, 1}, b{2, 2, 2};
  EXPECT_GT(base::distance_up(a, b), std::sqrt(3.0));
  EXPECT_LT(base::distance_down(a, b), std::sqrt(3.0));
  EXPECT_EQ(base::distance_up(a, a), 0);
  EXPECT_GE(base::distance_up({0, 0, 0}, {1e-200, 1e-200, 1e-200}), 1.7e-200);
  EXPECT_EQ(base::distance_down({0, 0, 0}, {1e-200, 0, 0}), 0);
  EXPECT_LE(base::distance_down({0, 0, 0}, {1.72e-162, 0, 0}), 1.72e-162);  // the square rounds up to a subnormal
}

TEST(Decoded, IsTheNumber) {
  const double numbers[] = {
      1, -1, 0.1, 6, 0x1p200, std::numeric_limits<double>::max(), 0x1p-1022, 0x1.8p-1023, 0x1p-1074, -0x1.fffp-1060};
  for (const double x : numbers) {
    const base::Decoded d(x);
    EXPECT_EQ(std::ldexp(static_cast<double>(d.m), d.exponent), x);
    EXPECT_NE(d.m % 2, 0) << x;
    if (d.exponent < 8 && d.exponent > -8) {
      EXPECT_EQ(d.in<std::int64_t>(-8), std::ldexp(x, 8)) << x;
    }
  }
  EXPECT_EQ(base::Decoded(0).m, 0);
  EXPECT_EQ(base::Decoded(-0.0).in<std::int64_t>(-8), 0);
}

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
