// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/placed_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "reference/reference.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

TEST(PlacedPair, ErrorCoversTheCoordinatesOfModelsThatDriftVertexByVertex) {
  // Few vertices at a time, so the tree is never fitted whole, and its root keeps its origin for long.
  Model model(scenes::ball(60, 31), {.rebuild_policy = RebuildPolicy::off});
  const Model still(scenes::ball(6, 4));
  const std::vector<Vec3> home = model.mesh().positions();
  for (int step = 1; step <= 8; ++step) {
    for (std::size_t first = 0; first < home.size(); first += 8) {
      std::vector<VertexId> ids;
      std::vector<Vec3> to;
      for (std::size_t v = first; v < std::min(first + 8, home.size()); ++v) {
        ids.push_back(static_cast<VertexId>(v)), to.push_back(home[v] + Vec3{10.0 * step, 5.0 * step, 0});
      }
      ASSERT_TRUE(static_cast<bool>(model.move_vertices(ids, to)));
      model.commit();
    }
    double largest = 0;
    for (const Vec3& p : model.mesh().positions()) largest = std::max(largest, max_abs(p));
    ASSERT_GE(pair::PlacedPair({model}, {still}).error(), 0x1p-45 * largest) << step;
  }
}

TEST(PlacedPair, BoundOfTheRootsHoldsWhereSquaresOfLengthsUnderflow) {
  const Mesh ball = scenes::ball(10, 5);
  for (int exponent = -480; exponent >= -560; --exponent) {
    // Next to their distance the models are nearly points.
    const double distance = std::ldexp(1.3, exponent), size = std::ldexp(distance, -34);
    std::vector<Vec3> positions = ball.positions();
    for (Vec3& p : positions) p = size * p;
    const Mesh tiny = Mesh::create(std::move(positions), ball.triangles()).value();
    const Model model(tiny);
    const Transform pose{{}, {0.6 * distance, 0.64 * distance, 0.48 * distance}};
    const double expected = reference::distance({tiny}, {tiny, pose}).upper;
    EXPECT_LE(pair::PlacedPair({model}, {model, pose}).root_bound(), expected) << exponent;
    const DistanceResult found = limber::distance({model}, {model, pose});
    EXPECT_NEAR(found.upper / expected, 1, 1e-13) << exponent;
    EXPECT_LE(found.lower, found.upper) << exponent;
    EXPECT_TRUE(within({model}, {model, pose}, expected * (1 + 1e-13)).is_yes()) << exponent;
  }
}

}  // namespace
}  // namespace limber::testing
