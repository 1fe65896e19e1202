// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Polynomials that are made of known roots: n / 8 for small n, any of them several times, or a factor without roots;
// and roots of the coplanarity polynomial narrowed in double-double arithmetic.
#include "motion/polynomial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "motion/element_impact.h"
#include "support/random_motion.h"

namespace limber::motion {
namespace {

using scenes::Rng;

constexpr int eighths = 8;

struct KnownPolynomial {
  Cubic p;
  std::multiset<int> roots;  // in eighths
};

Linear factor(int root) { return {{Integer(-root), Integer(eighths)}}; }

KnownPolynomial random_polynomial(Rng& rng) {
  const auto some = [&] { return static_cast<int>(rng.below(14)) - 3; };
  const Integer constant = static_cast<int>(rng.below(9)) * 2 - 9;
  KnownPolynomial known{{{constant}}, {}};
  const auto multiply = [&](const auto& by) {
    const auto product = known.p * by;
    std::copy_n(product.c.begin(), 4, known.p.c.begin());
  };
  std::size_t degree = rng.below(4);
  if (degree >= 2 && rng.below(4) == 0) {
    const int at = some();
    Quadratic square = factor(at) * factor(at);
    square.c[0] += 1;
    multiply(square);
    degree -= 2;
  }
  for (; degree > 0; --degree) {
    const int root = !known.roots.empty() && rng.below(3) == 0 ? *known.roots.begin() : some();
    known.roots.insert(root);
    multiply(factor(root));
  }
  return known;
}

/// From one root or place between roots to another.
Interval random_interval(Rng& rng, int& low, int& high) {
  low = static_cast<int>(rng.below(20)) - 2, high = low + 1 + static_cast<int>(rng.below(8));  // in sixteenths
  return {{low, 4}, {high, 4}};
}

/// With an end and its multiplicity as descartes_bound() counts them.
int count(const std::multiset<int>& roots, int low, int high, bool with_multiplicity) {
  std::multiset<int> counted;
  for (const int root : roots) {
    const int at = 2 * root;
    const bool counts_once = !with_multiplicity || at == high;
    if (at > low && at <= high && !(counts_once && counted.count(at) > 0)) counted.insert(at);
  }
  return static_cast<int>(counted.size());
}

TEST(Polynomial, RootsAreCounted) {
  Rng rng(51);
  int multiple = 0;
  for (int i = 0; i < 20'000; ++i) {
    const KnownPolynomial known = random_polynomial(rng);
    int low = 0, high = 0;
    const Interval interval = random_interval(rng, low, high);
    ASSERT_EQ(SturmSequence(squarefree(known.p)).count(interval), count(known.roots, low, high, false)) << i;
    const int bound = descartes_bound(known.p, interval), roots = count(known.roots, low, high, true);
    ASSERT_GE(bound, roots) << i;
    ASSERT_EQ((bound - roots) % 2, 0) << i;
    multiple += roots > count(known.roots, low, high, false) ? 1 : 0;
  }
  EXPECT_GT(multiple, 300);
}

TEST(Polynomial, SignsAreThoseOfFactors) {
  Rng rng(52);
  int decided = 0;
  for (int i = 0; i < 20'000; ++i) {
    const KnownPolynomial known = random_polynomial(rng);
    int low = 0, high = 0;
    const Interval interval = random_interval(rng, low, high);
    const bool has_low_root = known.roots.count(low / 2) > 0 && low % 2 == 0;
    ASSERT_EQ(known.p.sign_at(interval.low) == 0, has_low_root) << i;
    if (!known.p.c[3].is_zero()) continue;
    Quadratic p;
    std::copy_n(known.p.c.begin(), 3, p.c.begin());
    const int sign = sign_within(p, interval);
    if (sign == 0) continue;
    ++decided;
    Interval inside = interval;
    for (int k = 0; k < 5; ++k) {
      const DyadicTime middle = inside.middle();
      ASSERT_EQ(p.sign_at(middle), sign) << i;
      (rng.below(2) == 0 ? inside.low : inside.high) = middle;
    }
  }
  EXPECT_GT(decided, 5000);
}

TEST(Polynomial, CommonDivisorHasTheCommonRoots) {
  Rng rng(53);
  int shared = 0;
  for (int i = 0; i < 5000; ++i) {
    const KnownPolynomial a = random_polynomial(rng), b = random_polynomial(rng);
    const Cubic common = common_divisor(a.p, b.p);
    for (int root = -4; root < 12; ++root) {
      const bool is_common = a.roots.count(root) > 0 && b.roots.count(root) > 0;
      ASSERT_EQ(common.sign_at({root, 3}) == 0, is_common) << i;
      shared += is_common ? 1 : 0;
    }
  }
  EXPECT_GT(shared, 200);
}

// Next to exact arithmetic: the same, and nearly always found where elements are in general position.
TEST(PreciseRoot, IsTheExactOne) {
  Rng rng(3220);
  int asked = 0, found = 0;
  for (int i = 0; i < 40000 && !HasFailure(); ++i) {
    const auto kind =
        static_cast<testing::MotionKind>(rng.below(static_cast<std::uint64_t>(testing::MotionKind::all_scales)));
    const bool is_face = rng.below(2) == 0;
    const testing::MovingCorners m = testing::random_motion(rng, kind, is_face);
    MovingElements e{is_face ? MovingElements::Kind::vertex_face : MovingElements::Kind::edge_edge, {}};
    for (int k = 0; k < 4; ++k) e.corners[0][k] = m.start[k], e.corners[1][k] = m.end[k];
    const double time_error = rng.below(2) == 0 ? 0 : 1e-5;
    const FilterResult wide = filter_impact(e, {.time_error = time_error});
    if (wide.verdict != FilterResult::Verdict::contact || wide.upper - wide.lower <= 0x1p-53) continue;
    const std::optional<ElementImpact> precise = narrow_precisely(e, wide.lower, wide.upper);
    if (kind == testing::MotionKind::crossing) ++asked, found += precise ? 1 : 0;
    if (!precise) continue;  // such as a root that is a multiple itself
    double lower = wide.lower, upper = wide.upper;
    narrow_exactly(e, 0, lower, upper);
    EXPECT_EQ(precise->lower, lower) << ::testing::PrintToString(kind);
    EXPECT_EQ(precise->upper, upper) << ::testing::PrintToString(kind);
  }
  EXPECT_GT(asked, 200);
  EXPECT_GT(found, asked * 0.95) << asked;
}

}  // namespace
}  // namespace limber::motion
