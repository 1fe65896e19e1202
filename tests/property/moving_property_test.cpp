// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Random sequences of updates and queries on the fast engine.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "support/brute_force.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// Changes the motion margin, rebuilds, or resets the mesh.
void change_settings(Rng& rng, Model& model, double size) {
  const std::uint64_t kind = rng.below(8);
  if (kind == 0) {
    Mesh mesh = model.mesh();
    return model.reset(std::move(mesh));
  }
  if (kind == 1) return model.rebuild();
  if (kind == 2) return model.set_motion_margin(0);
  model.set_motion_margin(size * std::pow(10.0, rng.uniform(-9, 0)));
}

/// One random update: a few vertices, some twice, some a little and some far; all of them; or one that is refused.
void update(Rng& rng, Model& model, double size) {
  const std::vector<Vec3> before = model.mesh().positions();
  const bool was_committed = model.is_committed();
  const auto moved = [&](const Vec3& p) {
    const double step = rng.below(10) == 0 ? size : size * std::pow(10.0, rng.uniform(-8, -1));
    return p + step * uniform_point(rng);
  };
  const std::uint64_t kind = rng.below(12);
  if (kind >= 10) return change_settings(rng, model, size);
  if (kind == 0) {
    std::vector<Vec3> positions = before;
    for (Vec3& p : positions) p = moved(p);
    RC_ASSERT(static_cast<bool>(model.move_all(positions)));
    return;
  }
  std::vector<VertexId> ids;
  std::vector<Vec3> positions;
  for (std::uint64_t i = 0, count = 1 + rng.below(6); i < count; ++i) {
    ids.push_back(static_cast<VertexId>(rng.below(before.size())));
    positions.push_back(moved(before[ids.back()]));
  }
  if (kind == 1) positions.back().y = std::numeric_limits<double>::quiet_NaN();
  if (kind == 2) ids.back() = static_cast<VertexId>(before.size());
  const auto result = model.move_vertices(ids, positions);
  RC_ASSERT(static_cast<bool>(result) == (kind > 2));
  if (kind > 2) return;
  RC_ASSERT(result.error().where == ids.size() - 1);
  RC_ASSERT(model.mesh().positions() == before);
  RC_ASSERT(model.is_committed() == was_committed);
}

RC_GTEST_PROP(FastEngine, StaysSoundAndRightThroughAnySequenceOfUpdates, (std::uint64_t seed)) {
  Rng rng(seed);
  const Scene s = arbitrary_scene(rng);
  Model model_a(s.mesh_a), model_b(s.mesh_b);
  QueryCache cache;
  for (int step = 0; step < 6; ++step) {
    for (Model* model : {&model_a, &model_b}) {
      for (std::uint64_t i = 0, count = rng.below(4); i < count; ++i) update(rng, *model, s.size / 4);
      model->commit();
      RC_ASSERT(model->is_committed());
      RC_ASSERT(static_cast<bool>(model->validate()));
    }
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    const double tolerance = 100 * s.tolerance;
    const double truth = brute_force_distance({model_a.mesh(), s.pose_a}, {model_b.mesh(), s.pose_b});
    const DistanceResult cold = distance(a, b), warm = distance(a, b, {.cache = &cache});
    RC_ASSERT(std::abs(cold.upper - truth) <= tolerance);
    RC_ASSERT(std::abs(warm.upper - truth) <= tolerance);
    RC_ASSERT((cold.upper == 0) == (truth == 0) && (warm.upper == 0) == (truth == 0));
    RC_ASSERT(collide(a, b).is_yes() == (truth == 0));
    RC_ASSERT(collide(a, b, {.cache = &cache}).is_yes() == (truth == 0));
  }
}

/// The largest distance of a corner from the first one.
double extent(const Mesh& mesh) {
  const Vec3 first = mesh.triangle(0).v0;
  double farthest = 0;
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle corners = mesh.triangle(t);
    farthest = std::max({farthest, length(corners.v0 - first), length(corners.v1 - first), length(corners.v2 - first)});
  }
  return farthest;
}

RC_GTEST_PROP(FastEngine, FindsWhatHasLeftItsBounds, (std::uint64_t seed)) {
  // All vertices move at random within the motion margin, so bounds say little about where the closest triangles are.
  Rng rng(seed);
  const Scene s = arbitrary_scene(rng);
  const double motion_margin = s.size * std::pow(10.0, rng.uniform(-3, 0));
  Model model_a(s.mesh_a, {.motion_margin = rng.below(2) == 0 ? motion_margin : 0}),
      model_b(s.mesh_b, {.motion_margin = motion_margin});
  QueryCache cache;
  for (int step = 0; step < 4; ++step) {
    for (Model* model : {&model_a, &model_b}) {
      const std::vector<Vec3>& start = (model == &model_a ? s.mesh_a : s.mesh_b).positions();
      std::vector<Vec3> positions = start;
      for (Vec3& p : positions) p += (0.5 * motion_margin) * uniform_point(rng);
      RC_ASSERT(static_cast<bool>(model->move_all(positions)));
      model->commit();
      RC_ASSERT(static_cast<bool>(model->validate()));
    }
    // Only a mesh that was nearly a point may have been refitted, because it has grown. All other moves were absorbed.
    RC_ASSERT(model_b.maintenance_stats().refits == 0 || 0x1p40 * extent(s.mesh_b) < motion_margin);
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    const double truth = brute_force_distance({model_a.mesh(), s.pose_a}, {model_b.mesh(), s.pose_b});
    for (const DistanceResult& found : {distance(a, b), distance(a, b, {.cache = &cache})}) {
      RC_ASSERT(std::abs(found.upper - truth) <= 100 * s.tolerance);
      RC_ASSERT((found.upper == 0) == (truth == 0));
    }
    RC_ASSERT(collide(a, b).is_yes() == (truth == 0));
    RC_ASSERT(within(a, b, 2 * truth).is_yes());
    RC_ASSERT(!within(a, b, 0.5 * truth).is_yes() || truth <= 200 * s.tolerance);
  }
}

}  // namespace
}  // namespace limber::testing
