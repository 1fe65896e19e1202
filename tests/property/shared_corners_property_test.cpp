// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Triangles that share vertices, compared with exact arithmetic. LIMBER_NEIGHBOR_PAIRS says how many pairs.
#include <gtest/gtest.h>

#include <iostream>

#include "geometry/shared_corners.h"
#include "support/counts.h"
#include "support/exact_intersection.h"
#include "support/neighbors.h"

namespace limber::testing {
namespace {

class NeighborsOfKind : public ::testing::TestWithParam<int> {};

TEST_P(NeighborsOfKind, MeetElsewhereExactlyWhenTheirIntersectionIsNotAllShared) {
  const std::uint64_t pairs = count_from("LIMBER_NEIGHBOR_PAIRS", 12'000) / neighbor_kinds;
  Rng rng(3200 + static_cast<std::uint64_t>(GetParam()));
  std::uint64_t meeting = 0;
  for (std::uint64_t i = 0; i < pairs; ++i) {
    const Neighbors n = random_neighbors(rng, GetParam());
    const std::vector<VertexId> shared = n.shared();
    const bool truth = shared.size() < 3 && exact::intersect_off_segment(n.a(), n.b(), n.positions[shared.front()],
                                                                         n.positions[shared.back()]);
    meeting += truth ? 1 : 0;
    ASSERT_EQ(geometry::meets_elsewhere(n.a(), n.ids_a, n.b(), n.ids_b), truth) << "pair " << i;
    ASSERT_EQ(geometry::meets_elsewhere(n.b(), n.ids_b, n.a(), n.ids_a), truth) << "pair " << i << ", swapped";
  }
  std::cout << pairs << " pairs, " << meeting << " meeting elsewhere, 0 disagreements\n";
  EXPECT_GT(meeting, pairs / 100);
  EXPECT_LT(meeting, pairs - pairs / 100);
}

INSTANTIATE_TEST_SUITE_P(EveryKind, NeighborsOfKind, ::testing::Range(0, neighbor_kinds));

}  // namespace
}  // namespace limber::testing
