// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Trees that were stale, half updated or broken after a mesh had moved.
#include <functional>
#include <stdexcept>

#include "limber/points.h"
#include "peers.h"

namespace limber::testing {
namespace {

/// Moves all vertices to where a function puts them, and commits.
void deform(Model& model, const Mesh& rest, const std::function<Vec3(const Vec3&)>& motion) {
  std::vector<Vec3> positions = rest.positions();
  for (Vec3& p : positions) p = motion(p);
  model.move_all(positions).value();
  model.commit();
}

/// A model that has a history answers as one that has none.
void expect_like_new(const Model& model, const Placed& other) {
  ASSERT_TRUE(static_cast<bool>(model.validate()));
  const Model fresh(model.mesh());
  EXPECT_NEAR(agreed_distance({model}, other, 1e-13), distance({fresh}, other).upper, 1e-13);
  EXPECT_EQ(self_intersections(model, {}).count, self_intersections(fresh, {}).count);
  const Vec3 p = other.pose.translation;
  EXPECT_EQ(closest_point({model}, p).closest->position, closest_point({fresh}, p).closest->position);
}

const std::vector<ModelOptions> all_options{
    {},
    {.motion_margin = 0.05},
    {.motion_margin = 0.3, .rebuild_policy = RebuildPolicy::off},
    ModelOptions::real_time(50),
};

// Newton PR #3828, #3846: contacts are sought in a tree of an earlier pose: layers of cloth that lie apart at rest and
// were moved together have none. Here the question is refused until the tree is right.
TEST(Updates, AreNeverForgottenByAQuery) {
  const Mesh sheet = scenes::grid(8, 8, 0, 0, 0.1, 0.1);
  std::vector<Vec3> positions = sheet.positions();
  std::vector<Corners> triangles = sheet.triangles();
  const auto layer = static_cast<VertexId>(positions.size());
  const std::size_t faces = triangles.size();
  for (VertexId v = 0; v < layer; ++v) positions.push_back(positions[v] + Vec3{0, 0, 1});
  for (std::size_t f = 0; f < faces; ++f) {
    triangles.push_back({triangles[f][0] + layer, triangles[f][1] + layer, triangles[f][2] + layer});
  }
  Model cloth(Mesh::create(positions, triangles).value());
  EXPECT_EQ(self_contacts(cloth, 0.01, {}).count, 0U);
  for (std::size_t v = layer; v < positions.size(); ++v) positions[v].z = 0.005;
  cloth.move_all(positions).value();
  EXPECT_THROW(self_contacts(cloth, 0.01, {}), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(self_collide(cloth)), std::invalid_argument);
  const Model other(box({1, 1, 1}));
  EXPECT_THROW(static_cast<void>(distance({cloth}, {other})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(distance({other}, {cloth})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(collide({other}, {cloth})), std::invalid_argument);
  EXPECT_THROW(contacts({other}, {cloth}, 0.1, {}), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(closest_point({cloth}, {})), std::invalid_argument);
  cloth.commit();
  EXPECT_EQ(self_contacts(cloth, 0.01, {}).count, reference::self_contacts(cloth.mesh(), 0.01).size());
  EXPECT_GT(self_contacts(cloth, 0.01, {}).count, faces);
}

// Newton PR #3760: after a reset the mesh jumps back, and a tree that is only refitted is a bad one.
TEST(Updates, SurviveJumpsAndAreAsGoodAsNewAfterARebuild) {
  const Mesh rest = scenes::grid(30, 30, -1.5, -1.5, 0.1, 0.1);
  const Model ball(stretched(scenes::ball(12, 8), {0.3, 0.3, 0.3}));
  for (const ModelOptions& options : all_options) {
    scenes::Rng rng(3760);
    Model cloth(rest, options);
    std::vector<Vec3> elsewhere = rest.positions();
    for (int times = 0; times < 4; ++times) {
      // Scattered far away, or all in one point, where all triangles are equal.
      for (Vec3& p : elsewhere) p = times % 2 == 0 ? 1000 * random_point(rng, 1) : Vec3{1, 2, 3};
      cloth.move_all(elsewhere).value();
      cloth.commit();
      cloth.move_all(rest.positions()).value();
      cloth.commit();
      const Placed there{ball, random_pose(rng, 0.5)};
      expect_like_new(cloth, there);
    }
    cloth.rebuild();
    const Model fresh(rest);
    for (int i = 0; i < 5; ++i) {
      const Placed there{ball, {scenes::random_rotation(rng), {0.2 * i, 0.1, 0.5}}};
      EXPECT_EQ(distance({cloth}, there).stats.node_tests, distance({fresh}, there).stats.node_tests);
    }
  }
}

// mitsuba2 #526, #531, #276, #383: positions are replaced, the tree is not, and geometry vanishes over some frames.
// UPBGE #703, PR #835: the physics of a deformed mesh is that of the mesh at rest. Embree #389: a wall of a moved ball
// stays where it was. fluid-engine-dev PR #271: an update does not reach the tree; a rebuild in each frame is feared.
TEST(Updates, FollowABodyThroughManyFramesWithoutRebuildingItAll) {
  const Mesh rest = scenes::ball(24, 16);
  const Model wall(scenes::grid(10, 10, -1, -1, 0.2, 0.2));
  Model body(rest, {.rebuild_policy = RebuildPolicy::off});
  for (int frame = 0; frame < 30; ++frame) {
    const double z = 3 - 0.2 * frame;
    deform(body, rest, [&](const Vec3& p) { return Vec3{p.x, p.y, p.z + z}; });
    const double found = distance({wall}, {body}).upper;
    if (std::abs(z) > 1) {
      EXPECT_NEAR(found, std::abs(z) - 1, 1e-15) << frame;
    } else {
      EXPECT_EQ(found, 0) << frame;
    }
    EXPECT_NEAR(closest_point({body}, {0, 0, 9}).closest->distance, 8 - z, 1e-14) << frame;
  }
  EXPECT_EQ(body.maintenance_stats().rebuilt_triangles, 0U);
  EXPECT_LE(body.maintenance_stats().refits, 30 * body.tree_stats().nodes);
}

}  // namespace
}  // namespace limber::testing
