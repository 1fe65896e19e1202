// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Random sequences of all operations on a deforming model, compared with brute force: 60 000 from one generator
// (LIMBER_UPDATE_SEQUENCES sets another number), and a few thousand that are shrunk when they fail, so that the printed
// sequence is short.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "support/counts.h"
#include "updates.h"

namespace limber::testing {
namespace {

Shape drawn_shape(Rng& rng, std::uint32_t most) {
  const auto kind = static_cast<Shape::Kind>(rng.below(static_cast<std::uint64_t>(Shape::Kind::count)));
  return {kind, some(rng, 1, most), some(rng, 0, 1000)};
}

Start drawn_start(Rng& rng) {
  const double margins[] = {0, std::pow(10.0, rng.uniform(-4, 0.5)), std::pow(10.0, rng.uniform(-4, 0.5))};
  const Shape shape = drawn_shape(rng, rng.below(4) == 0 ? 150 : 12), still = drawn_shape(rng, 5);
  const std::optional<double> budgets_us[] = {ModelOptions::automatic, 2, 1e4};
  return {shape, still, margins[rng.below(3)], static_cast<RebuildPolicy>(rng.below(3)), budgets_us[rng.below(3)]};
}

/// Kinds that are drawn more often than the others.
constexpr Update::Kind often[] = {Update::Kind::move, Update::Kind::move, Update::Kind::move_all, Update::Kind::check,
                                  Update::Kind::check};

Update drawn_update(Rng& rng) {
  const Update::Kind kind = rng.below(3) == 0
                                ? static_cast<Update::Kind>(rng.below(static_cast<std::uint64_t>(Update::Kind::count)))
                                : often[rng.below(std::size(often))];
  const auto exponent = static_cast<std::int32_t>(rng.below(6)) - 4;
  return {kind, some(rng, 1, 5), exponent, some(rng, 0, 1U << 30)};
}

TEST(UpdateSequences, LeaveEveryModelSoundAndEveryAnswerRight) {
  Rng rng(91);
  const std::uint64_t all = count_from("LIMBER_UPDATE_SEQUENCES", 60'000);
  std::uint64_t sequences = 0, steps = 0, rebuilt_triangles = 0;
  for (; sequences < all; ++sequences) {
    const Start start = drawn_start(rng);
    Subject subject(start);
    const std::uint64_t count = 1 + rng.below(rng.below(12) == 0 ? 80 : 6);
    std::vector<Update> done;
    for (std::uint64_t i = 0; i < count; ++i, ++steps) {
      done.push_back(i + 1 < count ? drawn_update(rng) : Update{});
      const std::string wrong = subject.apply(done.back());
      ASSERT_EQ(wrong, "") << "in sequence " << sequences << ": " << start << ::testing::PrintToString(done);
    }
    rebuilt_triangles += subject.model().maintenance_stats().rebuilt_triangles;
  }
  std::printf("%.0f sequences, %.0f steps, %.0f triangles assigned to leaves anew\n", static_cast<double>(sequences),
              static_cast<double>(steps), static_cast<double>(rebuilt_triangles));
  EXPECT_GT(10 * rebuilt_triangles, all);
}

rc::Gen<Shape> shapes(std::uint32_t most) {
  return rc::gen::build<Shape>(
      rc::gen::set(&Shape::kind, rc::gen::map(rc::gen::inRange(0, static_cast<int>(Shape::Kind::count)),
                                              [](int kind) { return static_cast<Shape::Kind>(kind); })),
      rc::gen::set(&Shape::size, rc::gen::inRange(1U, most)), rc::gen::set(&Shape::seed, rc::gen::inRange(0U, 100U)));
}

rc::Gen<Start> starts() {
  return rc::gen::build<Start>(
      rc::gen::set(&Start::shape, shapes(80)), rc::gen::set(&Start::still, shapes(5)),
      rc::gen::set(&Start::motion_margin, rc::gen::element(0.0, 1e-3, 0.1, 3.0)),
      rc::gen::set(&Start::rebuild_policy,
                   rc::gen::element(RebuildPolicy::off, RebuildPolicy::in_commit, RebuildPolicy::on_worker)),
      rc::gen::set(&Start::rebuild_budget_us,
                   rc::gen::element<std::optional<double>>(ModelOptions::automatic, 0.3, 20.0)));
}

rc::Gen<Update> updates() {
  return rc::gen::build<Update>(
      rc::gen::set(&Update::kind, rc::gen::map(rc::gen::inRange(0, static_cast<int>(Update::Kind::count)),
                                               [](int kind) { return static_cast<Update::Kind>(kind); })),
      rc::gen::set(&Update::count, rc::gen::inRange(1U, 6U)), rc::gen::set(&Update::exponent, rc::gen::inRange(-4, 2)),
      rc::gen::set(&Update::draw, rc::gen::inRange(0U, 1U << 20)));
}

RC_GTEST_PROP(UpdateSequences, StayRightAndShrinkToFewUpdatesWhenTheyFail, ()) {
  const Start start = *starts();
  const std::vector<Update> sequence = *rc::gen::container<std::vector<Update>>(updates());
  Subject subject(start);
  for (const Update& update : sequence) {
    const std::string wrong = subject.apply(update);
    if (!wrong.empty()) RC_FAIL(wrong);
  }
  const std::string wrong = subject.check(0);
  if (!wrong.empty()) RC_FAIL(wrong);
}

}  // namespace
}  // namespace limber::testing
