// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "limber/model.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

void expect_bounds_hold(const Model& model) {
  const Box box = model.bounding_box();
  const Sphere sphere = model.bounding_sphere();
  Vec3 low = model.mesh().triangle(0).v0, high = low;
  for (TriangleId t = 0; t < model.mesh().triangles().size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 p = model.mesh().triangle(t)[i];
      low = min(low, p), high = max(high, p);
      ASSERT_LE(length(p - sphere.center), sphere.radius);
    }
  }
  EXPECT_EQ(min(box.low, low), box.low);
  EXPECT_EQ(max(box.high, high), box.high);
  const double size = length(high - low), margin = model.maintenance_stats().motion_margin;
  const double tolerance = 1e-5 * size + 2 * margin + 1e-12 * max_abs(high) + 1e-280;
  EXPECT_LE(max_abs(box.high - high), tolerance);
  EXPECT_LE(max_abs(box.low - low), tolerance);
  EXPECT_LE(sphere.radius, 0.75 * size + tolerance);
}

TEST(ModelBounds, ContainEveryVertexWhateverTheScale) {
  Rng rng(710);
  for (const double scale : {0.0, 1e-300, 1e-3, 1.0, 1e6, 1e50}) {
    for (const double offset : {0.0, 1.0, 1e9}) {
      std::vector<Triangle> triangles;
      for (std::size_t i = 0; i < 1 + rng.below(200); ++i) {
        const Vec3 at = scale * (offset * Vec3{1, -1, 1} + uniform_point(rng));
        triangles.push_back({at, at + 0.1 * scale * uniform_point(rng), at + 0.1 * scale * uniform_point(rng)});
      }
      Model model(soup(triangles), {.motion_margin = rng.below(2) == 0 ? 0 : 0.1 * scale});
      expect_bounds_hold(model);
      for (int frame = 0; frame < 4; ++frame) {
        std::vector<Vec3> positions = model.mesh().positions();
        for (Vec3& p : positions) p += 0.05 * scale * uniform_point(rng);
        ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
        model.commit();
        expect_bounds_hold(model);
      }
    }
  }
}

/// Whether each level of spheres holds all triangles, each triangle in one of them.
void expect_spheres_hold(const Model& model) {
  const TreeStats stats = model.tree_stats();
  std::size_t count = 0;
  for (std::uint32_t level = 0; level < stats.levels; ++level) {
    const std::vector<Sphere> spheres = model.node_spheres(level);
    count += spheres.size();
    for (TriangleId t = 0; t < model.mesh().triangles().size(); ++t) {
      const auto holds = [&](const Sphere& sphere) { return contains(sphere, model.mesh().triangle(t)); };
      ASSERT_TRUE(std::any_of(spheres.begin(), spheres.end(), holds)) << "level " << level << ", triangle " << t;
    }
  }
  EXPECT_EQ(count, stats.nodes);
  EXPECT_EQ(model.node_spheres(stats.levels - 1).size(), stats.leaves);
  const Sphere root = model.bounding_sphere();
  ASSERT_EQ(model.node_spheres(0).size(), 1U);
  EXPECT_EQ(model.node_spheres(0)[0].center, root.center);
  EXPECT_EQ(model.node_spheres(0)[0].radius, root.radius);
  EXPECT_THROW(static_cast<void>(model.node_spheres(stats.levels)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(model.node_spheres(no_id)), std::invalid_argument);
}

TEST(ModelBounds, SpheresOfEveryLevelHoldEveryTriangle) {
  Rng rng(711);
  for (const double offset : {0.0, 1e9}) {
    for (const std::uint32_t triangles : {1U, 8U, 9U, 600U}) {
      std::vector<Vec3> positions = scenes::random_soup(rng, triangles, 0.1).positions();
      const std::vector<Corners> corners = scenes::random_soup(rng, triangles, 0.1).triangles();
      for (Vec3& p : positions) p += offset * Vec3{1, -1, 1};
      Model model(Mesh::create(positions, corners).value(), {.motion_margin = triangles > 8 ? 0.05 : 0});
      expect_spheres_hold(model);
      for (Vec3& p : positions) p += 0.02 * uniform_point(rng);
      ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
      EXPECT_THROW(static_cast<void>(model.node_spheres(0)), std::invalid_argument);
      EXPECT_THROW(static_cast<void>(model.bounding_box()), std::invalid_argument);
      EXPECT_THROW(static_cast<void>(model.bounding_sphere()), std::invalid_argument);
      model.commit();
      expect_spheres_hold(model);
    }
  }
}

}  // namespace
}  // namespace limber::testing
