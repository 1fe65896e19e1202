// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The coplanarity polynomial in double-double arithmetic next to rational arithmetic: signs that it tells are right,
// and it tells nearly all.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "motion/exact_impact.h"
#include "motion/precise_volume.h"
#include "support/random_motion.h"

namespace limber::testing {
namespace {

using motion::MovingElements;
using Exact = std::array<mpq_class, 3>;

Exact difference(const MovingElements& e, std::size_t i, std::size_t j, double time) {
  Exact d;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const mpq_class t(time), start = mpq_class(e.corners[0][i][axis]) - e.corners[0][j][axis],
                             end = mpq_class(e.corners[1][i][axis]) - e.corners[1][j][axis];
    d[axis] = (1 - t) * start + t * end;
  }
  return d;
}

int exact_sign(const MovingElements& e, double time) {
  const bool is_face = e.kind == MovingElements::Kind::vertex_face;
  const Exact u = is_face ? difference(e, 2, 1, time) : difference(e, 1, 0, time);
  const Exact v = is_face ? difference(e, 3, 1, time) : difference(e, 2, 3, time);
  const Exact w = is_face ? difference(e, 0, 1, time) : difference(e, 2, 0, time);
  return sgn(mpq_class(u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                       u[2] * (v[0] * w[1] - v[1] * w[0])));
}

TEST(PreciseVolume, NeverHasAWrongSign) {
  Rng rng(3220);
  std::size_t asked = 0, certain = 0;
  for (int i = 0; i < 6000 && !HasFailure(); ++i) {
    const auto kind = static_cast<MotionKind>(rng.below(static_cast<std::uint64_t>(MotionKind::all_scales)));
    const bool is_face = rng.below(2) == 0;
    const MovingCorners m = random_motion(rng, kind, is_face);
    MovingElements e{is_face ? MovingElements::Kind::vertex_face : MovingElements::Kind::edge_edge, {}};
    for (int k = 0; k < 4; ++k) e.corners[0][k] = m.start[k], e.corners[1][k] = m.end[k];
    const motion::PreciseVolume volume(e);
    const ElementImpact impact = exact_impact(e, {});
    for (const double time : {0.0, 1.0, 0.5, rng.uniform(), std::fmin(impact.lower, 1), std::fmin(impact.upper, 1)}) {
      const double value = volume.at(time);
      const int sign = exact_sign(e, time);
      if (value != 0) {
        EXPECT_EQ(value > 0 ? 1 : -1, sign) << ::testing::PrintToString(kind) << " at " << time;
      }
      asked += sign != 0 ? 1 : 0, certain += value != 0 ? 1 : 0;
    }
  }
  EXPECT_GT(asked, 10000U);
  EXPECT_GT(certain * 100, asked * 90);
}

}  // namespace
}  // namespace limber::testing
