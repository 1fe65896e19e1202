// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/trial.h"

#include <gtest/gtest.h>

namespace limber::testing {
namespace {

using pair::Trial;

/// How many of 1000 queries try what changes the time of each by `gain`.
int tries(Trial& trial, double gain) {
  int count = 0;
  for (int i = 0; i < 1000; ++i) {
    if (!trial.is_due()) continue;
    ++count;
    trial.add_gain(gain);
  }
  return count;
}

TEST(Trial, GoesOnForeverWithWhatPays) {
  Trial trial;
  EXPECT_EQ(tries(trial, 0.1), 1000);
}

TEST(Trial, SpendsFewQueriesOnWhatDoesNotPay) {
  for (const double loss : {0.1, 0.25, 0.5}) {
    Trial trial;
    const int count = tries(trial, -loss);
    EXPECT_GT(count, 10) << loss;
    EXPECT_LT(count * loss, 1000 / 50) << loss;  // 2 % of the time of all queries
  }
}

TEST(Trial, NoticesSoonThatSomethingPaysNowOrNoLonger) {
  Trial trial;
  tries(trial, -0.25);
  int waited = 0;
  while (!trial.is_due()) ++waited;
  EXPECT_LT(waited, 50);
  EXPECT_GT(tries(trial, 0.5), 900);
  EXPECT_LT(tries(trial, -0.25), 100);
}

}  // namespace
}  // namespace limber::testing
