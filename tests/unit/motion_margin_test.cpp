// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/motion_margin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bvh/refit.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

using bvh::DirtySet;
using model::MotionMargin;

struct MovingSheet {
  MovingSheet() { dirty.try_index_vertices(tree, mesh.positions().size()); }

  Vec3 position(VertexId v) const { return mesh.positions()[v]; }
  void move(VertexId v, const Vec3& by) { mesh.set_position(v, position(v) + by).value(); }
  void move_all(const Vec3& by) {
    for (VertexId v = 0; v < mesh.positions().size(); ++v) move(v, by);
  }

  Mesh mesh = scenes::grid(40, 40, 0, 0, 1, 1);
  bvh::Tree tree = bvh::build(mesh);
  DirtySet dirty{tree};
};

TEST(MotionMargin, IsOffUntilItIsStarted) {
  MovingSheet sheet;
  MotionMargin margin;
  EXPECT_FALSE(margin.is_on());
  EXPECT_EQ(margin.fitted(sheet.mesh).positions.data(), sheet.mesh.positions().data());
  EXPECT_EQ(margin.largest_displacement(), 0);
  margin.start(sheet.mesh.positions());
  EXPECT_TRUE(margin.is_on());
  sheet.move(7, {0, 0, 1});
  EXPECT_EQ(margin.fitted(sheet.mesh).positions[7].z, 0);
  margin.stop();
  EXPECT_FALSE(margin.is_on());
  EXPECT_EQ(margin.fitted(sheet.mesh).positions[7].z, 1);
}

TEST(MotionMargin, AbsorbsUpToTheMarginAndRefitsBeyond) {
  MovingSheet sheet;
  MotionMargin margin;
  margin.start(sheet.mesh.positions());
  const VertexId near = 3, far = 900;
  sheet.move(near, {0, 0, 0.25});
  sheet.move(far, {0, 0, std::nextafter(0.25, 1)});
  const std::vector<VertexId> ids{near, far};
  margin.absorb(sheet.mesh, ids, 0.25, sheet.dirty);
  EXPECT_EQ(margin.absorbed_count(), 1U);
  EXPECT_EQ(margin.fitted(sheet.mesh).positions[near].z, 0);
  EXPECT_EQ(margin.fitted(sheet.mesh).positions[far], sheet.position(far));
  EXPECT_GE(margin.largest_displacement(), 0.25);
  EXPECT_LT(margin.largest_displacement(), 0.25 * (1 + 1e-9));

  DirtySet expected(sheet.tree);
  expected.try_index_vertices(sheet.tree, sheet.mesh.positions().size());
  expected.add(far);
  const std::size_t lowest = sheet.tree.level_begin.size() - 2;
  EXPECT_EQ(sheet.dirty.nodes(lowest), expected.nodes(lowest));

  // The bounds of the positions at the last refit, and the largest displacement, hold the mesh.
  refit(sheet.tree, margin.fitted(sheet.mesh), sheet.dirty);
  EXPECT_TRUE(static_cast<bool>(validate(sheet.tree, margin.fitted(sheet.mesh))));
  margin.clear_counts();
  EXPECT_EQ(margin.absorbed_count(), 0U);
}

TEST(MotionMargin, MeasuresDisplacementsAnewWhenAllHaveMoved) {
  MovingSheet sheet;
  MotionMargin margin;
  margin.start(sheet.mesh.positions());
  sheet.move(5, {0, 0, 0.5});
  const std::vector<VertexId> ids(sheet.mesh.positions().size() + 1, 5);
  margin.absorb(sheet.mesh, ids, 1, sheet.dirty);
  EXPECT_TRUE(margin.is_stale());
  sheet.move(5, {0, 0, -0.5});
  EXPECT_GE(margin.largest_displacement(), 0.5);
  sheet.move_all({0, 0, 0.125});
  EXPECT_EQ(margin.absorb_all(sheet.mesh, 1, sheet.tree, sheet.dirty), 0U);
  EXPECT_FALSE(margin.is_stale());
  EXPECT_GE(margin.largest_displacement(), 0.125);
  EXPECT_LT(margin.largest_displacement(), 0.126);
  EXPECT_TRUE(sheet.dirty.empty());
}

TEST(MotionMargin, RefitsSomeOrAllOfWhatHasMovedTooFar) {
  MovingSheet sheet;
  MotionMargin margin;
  margin.start(sheet.mesh.positions());
  sheet.move_all({0, 0, 0.125});
  sheet.move(8, {0, 0, 3});
  EXPECT_EQ(margin.absorb_all(sheet.mesh, 0.25, sheet.tree, sheet.dirty), 1U);
  EXPECT_EQ(margin.fitted(sheet.mesh).positions[8], sheet.position(8));
  EXPECT_EQ(margin.fitted(sheet.mesh).positions[9].z, 0);
  EXPECT_FALSE(sheet.dirty.covers_most_of(sheet.tree));

  sheet.move_all({0, 0, 2});
  EXPECT_EQ(margin.absorb_all(sheet.mesh, 0.25, sheet.tree, sheet.dirty), sheet.mesh.positions().size());
  EXPECT_TRUE(sheet.dirty.covers_most_of(sheet.tree));
  EXPECT_EQ(margin.largest_displacement(), 0);
  EXPECT_EQ(margin.fitted(sheet.mesh).positions[9], sheet.position(9));
}

}  // namespace
}  // namespace limber::testing
