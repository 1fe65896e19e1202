// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries that are interrupted and go on while their models move, deform and are rebuilt. The environment variable
// LIMBER_INTERRUPTED_QUERIES changes how many.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "support/counts.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// What can happen to a model between two queries. Returns whether it is at rest.
bool rests_or_is_disturbed(Rng& rng, Model& model, Transform& pose, double size) {
  switch (rng.below(8)) {
    case 0: {  // some vertices move
      const std::vector<Vec3>& positions = model.mesh().positions();
      const auto v = static_cast<VertexId>(rng.below(positions.size()));
      const std::vector<Vec3> to{positions[v] + size * std::pow(10.0, rng.uniform(-5, -0.5)) * uniform_point(rng)};
      model.move_vertices(std::vector<VertexId>{v}, to).value();
      model.commit();
      return false;
    }
    case 1: {  // all move
      std::vector<Vec3> positions = model.mesh().positions();
      const double step = size * std::pow(10.0, rng.uniform(-5, -0.5));
      for (Vec3& p : positions) p += step * uniform_point(rng);
      model.move_all(positions).value();
      model.commit();
      return false;
    }
    case 2:
      if (rng.below(4) != 0) return true;
      model.rebuild();
      return false;
    case 3:  // it jumps
      if (rng.below(4) != 0) return true;
      pose = random_pose(rng, size);
      return false;
    case 4:
    case 5: {  // it moves a little
      const double step = std::pow(10.0, rng.uniform(-6, -1));
      const Vec3 axis = step * uniform_point(rng);
      const Transform turn = transform_from_quaternion({}, 1, axis.x, axis.y, axis.z).value();
      pose = {turn.rotation * pose.rotation, pose.translation + size * step * uniform_point(rng)};
      return false;
    }
    default:
      return true;
  }
}

TEST(InterruptedQueries, HoldTheTruthWhateverMovesInBetween) {
  Rng rng(1201);
  const std::uint64_t count = count_from("LIMBER_INTERRUPTED_QUERIES", 30000);
  std::uint64_t interrupted = 0, unknown = 0, contacts = 0, narrowed = 0;
  for (std::uint64_t asked = 0; asked < count;) {
    Scene s = arbitrary_scene(rng);
    const double margins[] = {0, 0.05 * s.size, 0.001 * s.size};
    Model model_a(s.mesh_a, {.motion_margin = margins[rng.below(3)]}), model_b(s.mesh_b);
    QueryCache cache;
    double lower = 0;  // of the last query, if nothing has happened since
    for (int i = 0; i < 40; ++i, ++asked) {
      const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
      const double truth = distance(a, b).upper;
      const double tolerance = s.tolerance + 0x1p-40 * (max_abs(s.pose_a.translation) + max_abs(s.pose_b.translation));
      const QueryBudget budget{.max_steps = rng.below(3) == 0 ? rng.below(40) : rng.below(4)};
      if (rng.below(3) != 0) {
        const double error = rng.below(2) == 0 ? 0 : rng.uniform(0, 0.5);
        const DistanceResult found = distance(a, b, {.relative_error = error, .cache = &cache, .budget = budget});
        ASSERT_LE(found.lower, truth + tolerance) << "query " << asked;
        ASSERT_GE(found.upper, truth - tolerance) << "query " << asked;
        ASSERT_TRUE(found.witness);
        ASSERT_NEAR(length(found.witness->point_b - found.witness->point_a), found.upper, tolerance);
        ASSERT_EQ(found.status == Status::interrupted, found.stopped_by != StoppedBy::nothing);
        if (found.status != Status::interrupted) {
          ASSERT_LE(found.upper, truth * (1 + error) + tolerance) << "query " << asked;
          ASSERT_EQ(found.status == Status::collision, truth == 0) << "query " << asked;
        } else {
          ++interrupted;
        }
        ASSERT_GE(found.lower, std::min(lower, found.upper)) << "query " << asked;
        narrowed += lower > 0 && found.lower > lower ? 1 : 0;
        lower = found.lower;
      } else {
        const bool asks_collision = rng.below(2) == 0;
        const double limit = truth * rng.uniform(0.5, 1.5);
        const CollideResult found = asks_collision ? collide(a, b, {.cache = &cache, .budget = budget})
                                                   : within(a, b, limit, {.cache = &cache, .budget = budget});
        const double far = asks_collision ? 0 : limit + tolerance, near = asks_collision ? 0 : limit - tolerance;
        if (found.answer == Answer::yes) {
          ASSERT_LE(truth, far) << "query " << asked;
        }
        if (found.answer == Answer::no) {
          ASSERT_TRUE(asks_collision ? truth > 0 : truth > near) << "query " << asked;
        }
        unknown += found.answer == Answer::unknown ? 1 : 0;
        contacts += truth == 0 ? 1 : 0;
      }
      const bool moves_a = rng.below(2) == 0;
      const bool rests = rests_or_is_disturbed(rng, moves_a ? model_a : model_b, moves_a ? s.pose_a : s.pose_b, s.size);
      if (!rests) lower = 0;
    }
  }
  EXPECT_GT(interrupted, count / 10);
  EXPECT_GT(unknown, count / 50);
  EXPECT_GT(contacts, count / 100);
  EXPECT_GT(narrowed, count / 100);
}

}  // namespace
}  // namespace limber::testing
