// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models of the fast engine that move.
#include "limber/model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "limber/reference.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "tree/node.h"

namespace limber::testing {
namespace {

void expect_refused(const Result<void>& result, ErrorCode code, const std::string& part) {
  ASSERT_FALSE(static_cast<bool>(result));
  EXPECT_EQ(result.error().code, code);
  EXPECT_NE(result.error().text.find(part), std::string::npos) << result.error().text;
}

TEST(Model, RefusesWhatItCannotTakeAndStaysAsItWas) {
  Model model(scenes::thesis_ball());
  const std::vector<Vec3> before = model.mesh().positions();
  const auto last = static_cast<VertexId>(before.size() - 1);
  const std::vector<Vec3> two{{0, 0, 1}, {0, 0, 2}};
  expect_refused(model.move_vertices(std::vector<VertexId>{0, last + 1}, two), ErrorCode::index_out_of_range,
                 "entry 1");
  expect_refused(model.move_vertices(std::vector<VertexId>{0}, two), ErrorCode::size_mismatch, "2 positions for 1 ids");
  expect_refused(model.move_vertices(std::vector<VertexId>{0, 1}, std::vector<Vec3>{{0, 0, 1}, {0, NAN, 0}}),
                 ErrorCode::non_finite, "entry 1");
  expect_refused(model.move_vertices(std::vector<VertexId>{0}, std::vector<Vec3>{{1e70, 0, 1}}), ErrorCode::too_large,
                 "entry 0");
  expect_refused(model.move_all(two), ErrorCode::size_mismatch, "2 positions for");
  std::vector<Vec3> all = before;
  all[5].x = INFINITY;
  expect_refused(model.move_all(all), ErrorCode::non_finite, "entry 5");
  EXPECT_EQ(model.mesh().positions(), before);
  EXPECT_TRUE(model.is_committed());
  EXPECT_EQ(model.maintenance_stats().moved_vertices, 0U);
}

TEST(Model, RefitsEveryBlockAboveAVertexOnceHoweverOftenItMoves) {
  Model model(scenes::wave_sheet(100, 100, 0));
  const std::vector<VertexId> ids{5000, 5000, 5001, 5000};
  const std::vector<Vec3> positions(4, {2, 2, 3});
  ASSERT_TRUE(static_cast<bool>(model.move_vertices(ids, positions)));
  EXPECT_FALSE(model.is_committed());
  model.commit();
  EXPECT_TRUE(model.is_committed());
  EXPECT_EQ(model.mesh().positions()[5000], (Vec3{2, 2, 3}));
  EXPECT_EQ(model.maintenance_stats().moved_vertices, 4U);
  // At most the blocks of the triangles at two neighbours, and one path each.
  EXPECT_GE(model.maintenance_stats().refits, model.tree_stats().levels);
  EXPECT_LE(model.maintenance_stats().refits, 4 * model.tree_stats().levels);
  ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text;
}

TEST(Model, StopsWhereNothingChanges) {
  Model model(scenes::wave_sheet(100, 100, 0));
  const Vec3 same = model.mesh().positions()[777];
  ASSERT_TRUE(static_cast<bool>(model.move_vertices(std::vector<VertexId>{777}, std::vector<Vec3>{same})));
  model.commit();
  EXPECT_LE(model.maintenance_stats().refits, 4U);
  model.commit();  // nothing is left
  EXPECT_LE(model.maintenance_stats().refits, 4U);
}

TEST(Model, IsAfterMovingAllAsIfJustFitted) {
  const Mesh start = scenes::wave_sheet(60, 60, 0), end = scenes::wave_sheet(60, 60, 0.4);
  Model moved(start);
  ASSERT_TRUE(static_cast<bool>(moved.move_all(end.positions())));
  moved.commit();
  tree::Tree fitted = moved.tree();
  tree::fit(fitted, end);
  for (std::size_t b = 0; b < fitted.blocks.size(); ++b) {
    ASSERT_EQ(std::memcmp(&fitted.blocks[b].bounds, &moved.tree().blocks[b].bounds, sizeof(simd::NodeBounds)), 0);
  }
  ASSERT_TRUE(static_cast<bool>(moved.validate())) << moved.validate().error().text;
}

TEST(Model, FollowsWhereverItsVerticesGo) {
  // Far away, back, into a point, very large and very small: units and origins have to keep up.
  Rng rng(310);
  Model model(scenes::ball(12, 7));
  const std::vector<Vec3> start = model.mesh().positions();
  const Model other(scenes::grid(6, 6, -3, -3, 1, 1));
  for (const double scale : {1.0, 0x1p-60, 1e-6, 0.0, 1.0, 0x1p90, 1e3, 1.0}) {
    for (const Vec3& at : {Vec3{}, Vec3{1e5, -2e6, 3}, Vec3{0.1, 0.2, 40}}) {
      std::vector<Vec3> positions = start;
      for (Vec3& p : positions) p = p * scale + at;
      ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
      model.commit();
      ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text << " at scale " << scale;
      const double truth = reference::distance({model.mesh()}, {other.mesh()}).upper;
      ASSERT_NEAR(distance({model}, {other}).upper, truth, 1e-14 * (scale + length(at) + 10)) << scale;
      // The same one vertex after the other.
      for (int i = 0; i < 20; ++i) {
        const auto v = static_cast<VertexId>(rng.below(start.size()));
        ASSERT_TRUE(static_cast<bool>(
            model.move_vertices(std::vector<VertexId>{v}, std::vector<Vec3>{start[v] * rng.uniform(0, 2)})));
        model.commit();
        ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text << " at scale " << scale;
      }
    }
  }
}

TEST(Model, MakesPairsForgetWhatTheyKnewOfIt) {
  Model ball(scenes::thesis_ball());
  const Model square(scenes::thesis_square());
  const Placed there{ball, {{}, {0, 0, 3}}};
  Pair pair;
  EXPECT_NEAR(distance({square}, there, {}, pair).upper, 2, 1e-2);
  std::vector<Vec3> positions = ball.mesh().positions();
  for (Vec3& p : positions) p.z -= 1.5;
  ASSERT_TRUE(static_cast<bool>(ball.move_all(positions)));
  ball.commit();
  EXPECT_EQ(distance({square}, there, {}, pair).upper, distance({square}, there).upper);
}

}  // namespace
}  // namespace limber::testing
