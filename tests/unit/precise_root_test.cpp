// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Roots of the coplanarity polynomial narrowed in double-double arithmetic next to exact ones: the same, and nearly
// always found where elements are in general position.
#include "motion/element_impact.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

#include "support/random_motion.h"

namespace limber::testing {
namespace {

using motion::MovingElements;

TEST(PreciseRoot, IsTheExactOne) {
  Rng rng(3220);
  int asked = 0, found = 0;
  for (int i = 0; i < 40000 && !HasFailure(); ++i) {
    const auto kind = static_cast<MotionKind>(rng.below(static_cast<std::uint64_t>(MotionKind::all_scales)));
    const bool is_face = rng.below(2) == 0;
    const MovingCorners m = random_motion(rng, kind, is_face);
    MovingElements e{is_face ? MovingElements::Kind::vertex_face : MovingElements::Kind::edge_edge, {}};
    for (int k = 0; k < 4; ++k) e.corners[0][k] = m.start[k], e.corners[1][k] = m.end[k];
    const double time_error = rng.below(2) == 0 ? 0 : 1e-5;
    const motion::FilterResult wide = motion::filter_impact(e, {.time_error = time_error});
    if (wide.verdict != motion::FilterResult::Verdict::contact || wide.upper - wide.lower <= 0x1p-53) continue;
    const std::optional<ElementImpact> precise = motion::narrow_precisely(e, wide.lower, wide.upper);
    if (kind == MotionKind::crossing) ++asked, found += precise ? 1 : 0;
    if (!precise) continue;  // such as a root that is a multiple itself
    double lower = wide.lower, upper = wide.upper;
    motion::narrow_exactly(e, 0, lower, upper);
    EXPECT_EQ(precise->lower, lower) << ::testing::PrintToString(kind);
    EXPECT_EQ(precise->upper, upper) << ::testing::PrintToString(kind);
  }
  EXPECT_GT(asked, 200);
  EXPECT_GT(found, asked * 0.95) << asked;
}

}  // namespace
}  // namespace limber::testing
