// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Closest points against brute force, to the bit: in random scenes, on every instruction set, and while models deform.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "limber/points.h"
#include "reference/reference.h"
#include "simd/kernels.h"
#include "support/random_points.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// Whether no two triangles of a mesh have equal corners, in order. Otherwise either of them may be named.
bool has_distinct_triangles(MeshView mesh) {
  std::set<std::array<double, 9>> seen;
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle c = mesh.triangle(t);
    if (!seen.insert({c.v0.x, c.v0.y, c.v0.z, c.v1.x, c.v1.y, c.v1.z, c.v2.x, c.v2.y, c.v2.z}).second) return false;
  }
  return true;
}

/// Asks for some points, with and without a limit, on every instruction set.
void check_points(Rng& rng, const Placed& model, double size, int count, const std::string& what) {
  const reference::Placed mesh{model.model().mesh(), model.pose};
  const bool is_distinct = has_distinct_triangles(mesh.mesh);
  for (int i = 0; i < count; ++i) {
    const Vec3 point = arbitrary_query_point(rng, mesh, size);
    const PointResult truth = reference::closest_point(mesh, point);
    const double limit = truth.closest->distance * (rng.below(3) == 0 ? 1 : rng.uniform(0, 2));
    const PointResult limited_truth = reference::closest_point(mesh, point, {.max_distance = limit});
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::use_kernels(&set);
      const std::string where = what + ", point " + std::to_string(i) + ", " + set.name;
      expect_same_point(closest_point(model, point), truth, where, is_distinct);
      expect_same_point(closest_point(model, point, {.max_distance = limit}), limited_truth, where + ", limited",
                        is_distinct);
      simd::use_kernels(nullptr);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(PointsProperty, AreThoseOfBruteForceInAnyScene) {
  Rng rng(801);
  for (int i = 0; i < 1500 && !HasFatalFailure(); ++i) {
    const RandomScene s = arbitrary_scene(rng);
    const Model model(s.mesh_a);
    check_points(rng, {model, s.pose_a}, s.size / 4, 10, "scene " + std::to_string(i));
  }
}

TEST(PointsProperty, AreThoseOfBruteForceAtEveryScale) {
  Rng rng(802);
  for (int i = 0; i < 400 && !HasFatalFailure(); ++i) {
    const double scale = std::pow(10.0, rng.uniform(-300, 58));
    Mesh mesh = arbitrary_mesh(rng, 60, {}, scale);
    if (rng.below(3) == 0) {  // and something tiny beside it
      const double tiny = scale * std::pow(10.0, rng.uniform(-40, 0));
      std::vector<Triangle> specks;
      while (specks.size() < 20) specks.push_back(uniform_triangle(rng));
      mesh = joined(mesh, moved(soup(specks), {}, tiny));
    }
    const Model model(mesh);
    Transform pose;
    if (rng.below(2) == 0) pose = random_pose(rng, 3), pose.translation *= scale;
    check_points(rng, {model, pose}, 6 * scale, 10, "scale " + std::to_string(scale) + ", case " + std::to_string(i));
  }
}

TEST(PointsProperty, AreThoseOfBruteForceWhileModelsDeform) {
  Rng rng(803);
  for (int i = 0; i < 150 && !HasFatalFailure(); ++i) {
    const RandomScene s = arbitrary_scene(rng);
    Model model(s.mesh_a);
    const double size = s.size / 4;
    for (int step = 0; step < 6 && !HasFatalFailure(); ++step) {
      const std::uint64_t kind = rng.below(8);
      if (kind == 0) model.rebuild();
      if (kind <= 2) model.set_motion_margin(kind == 1 ? 0 : size * std::pow(10.0, rng.uniform(-9, 0)));
      const double most = size * std::pow(10.0, rng.uniform(-12, rng.below(4) == 0 ? 1 : -1));
      const Vec3 place = model.mesh().positions()[0];
      deform(model, [&](const Vec3& p) {
        if (kind == 7) return place;  // all at one place
        return rng.below(3) == 0 ? p + most * uniform_point(rng) : p;
      });
      check_points(rng, {model, s.pose_a}, size, 6, "model " + std::to_string(i) + ", step " + std::to_string(step));
    }
  }
}

TEST(PointsProperty, WindingNumbersDependOnDirectionsAlone) {
  Rng rng(804);
  for (int i = 0; i < 2000; ++i) {
    // The point is the origin: inside of a ball, or outside of one beside it.
    const bool is_inside = rng.below(2) == 0;
    const Mesh ball = scenes::ball(3 + static_cast<std::uint32_t>(rng.below(9)), 8);
    const auto lowest = static_cast<int>(rng.below(1200)), range = static_cast<int>(1 + rng.below(1220 - lowest));
    const Mesh mesh = mapped(ball, [&](const Vec3& p) {
      const int exponent = lowest + static_cast<int>(rng.below(static_cast<std::uint64_t>(range))) - 1022;
      return std::ldexp(1.0, exponent) * (is_inside ? p : p + Vec3{3, 0, 0});
    });
    const Model model(mesh);
    const double truth = is_inside ? 1 : 0;
    ASSERT_NEAR(generalized_winding_number({model}, {}), truth, 1e-13) << "surface " << i;
    ASSERT_NEAR(reference::winding_number({mesh}, {}), truth, 1e-13) << "surface " << i;
    ASSERT_EQ(ClosedSurface::create(model).value().winding_number({}), truth) << "surface " << i;
  }
}

}  // namespace
}  // namespace limber::testing
