// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Limits of displacements: whatever vertices do within them, no two elements come nearer than the separation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "limber/motion.h"
#include "reference/reference.h"
#include "support/random_scene.h"
#include "unit/refusals.h"

namespace limber::testing {
namespace {

/// Moves each vertex by its displacement, rounded down, in some direction; of many towards the same point.
std::vector<Vec3> moved_within(Rng& rng, const Mesh& mesh, const Transform& pose, std::span<const double> most) {
  const Vec3 towards = uniform_point(rng);
  const bool gathers = rng.below(2) == 0;
  std::vector<Vec3> moved;
  for (std::size_t v = 0; v < most.size(); ++v) {
    const Vec3 p = pose(mesh.positions()[v]), way = gathers ? towards - p : uniform_point(rng);
    const double size = length(way);
    moved.push_back(size > 0 ? p + (most[v] * (1 - 0x1p-50) / size) * way : p);
  }
  return moved;
}

Mesh at(const Mesh& mesh, std::vector<Vec3> positions) {
  return Mesh::create(std::move(positions), mesh.triangles()).value();
}

/// Distances of all pairs of elements that are at most a margin apart, in one order.
std::vector<double> distances(const reference::ElementPairs& pairs) {
  std::vector<double> all;
  for (const VertexFacePair& p : pairs.vertex_face) all.push_back(p.distance);
  for (const EdgeEdgePair& p : pairs.edge_edge) all.push_back(p.distance);
  return all;
}

constexpr double any_distance = std::numeric_limits<double>::max();

void expect_apart(const std::vector<double>& before, const std::vector<double>& after, double separation,
                  double rounding) {
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_GE(after[i], std::min(before[i], separation) - rounding);
  }
}

/// Where vertices would like to go: towards a point, away from it, all one way, along a plane, or anywhere; some far,
/// and some stay.
std::vector<Vec3> wished_ends(Rng& rng, const Mesh& mesh, const Transform& pose, double size) {
  const std::uint64_t kind = rng.below(5);
  const Vec3 point = uniform_point(rng);
  std::vector<Vec3> ends;
  for (const Vec3& p : mesh.positions()) {
    const Vec3 from = pose(p), any = uniform_point(rng), to = 4 * point - from * (1 / size);
    const Vec3 ways[] = {to, -to, point, {any.x, point.y, 0}, any};
    ends.push_back(from + (rng.below(4) == 0 ? 0 : rng.below(8) == 0 ? 8 * size : size) * ways[kind]);
  }
  return ends;
}

TEST(Displacements, KeepElementsApart) {
  Rng rng(3230);
  std::size_t limited[2] = {0, 0}, free[2] = {0, 0};
  for (int i = 0; i < 300 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const bool is_along = i % 2 == 0;  // motions, at any pace; otherwise in any direction
    const RandomScene s = arbitrary_scene(rng);
    const double unit = s.size / 20;
    const double separation = rng.below(2) == 0 ? 0 : unit * std::ldexp(1.0, -static_cast<int>(rng.below(8)));
    const std::vector<Vec3> end_a = wished_ends(rng, s.mesh_a, s.pose_a, unit);
    const std::vector<Vec3> end_b = wished_ends(rng, s.mesh_b, s.pose_b, unit);
    std::vector<double> of_a(end_a.size()), of_b(rng.below(2) == 0 ? end_b.size() : 0);
    for (auto* all : {&of_a, &of_b}) {
      for (double& f : *all) f = (is_along ? 1 : unit) * (rng.below(4) == 0 ? 1 : rng.uniform());
      std::fill_n(all->begin(), rng.below(2) * all->size() / 2, 0);  // leaves that stay
    }
    const std::vector<double> wished = of_a;
    const Model a(s.mesh_a), b(s.mesh_b);
    MovingModel moving_a(a), moving_b(b);
    ASSERT_TRUE(moving_a.set_motion(end_a, s.pose_a) && moving_b.set_motion(end_b, s.pose_b));
    if (is_along) {
      limit_self_motions(moving_a, separation, of_a);
      limit_motions(moving_a, moving_b, separation, of_a, of_b);
    } else {
      limit_self_displacements(a, separation, of_a);
      limit_displacements({a, s.pose_a}, {b, s.pose_b}, separation, of_a, of_b);
    }
    for (std::size_t v = 0; v < of_a.size(); ++v) {
      EXPECT_TRUE(0 <= of_a[v] && of_a[v] <= wished[v]);
      ++(of_a[v] < wished[v] ? limited : free)[is_along];
    }
    of_b.resize(end_b.size());              // one that stays
    for (const double slow : {0.0, 0.5}) {  // all the way, or anywhere
      const auto moved = [&](const Mesh& mesh, const Transform& pose, const std::vector<Vec3>& end,
                             const std::vector<double>& most) {
        std::vector<Vec3> now = moved_within(rng, mesh, pose, most);
        for (std::size_t v = 0; is_along && v < end.size(); ++v) {
          const Vec3 from = pose(mesh.positions()[v]);
          now[v] = from + most[v] * (rng.uniform() < slow ? rng.uniform() : 1) * (end[v] - from);
        }
        return at(mesh, std::move(now));
      };
      const Mesh now_a = moved(s.mesh_a, s.pose_a, end_a, of_a), now_b = moved(s.mesh_b, s.pose_b, end_b, of_b);
      expect_apart(distances(reference::element_pairs({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}, any_distance)),
                   distances(reference::element_pairs({now_a}, {now_b}, any_distance)), separation, 10 * s.tolerance);
      expect_apart(distances(reference::self_element_pairs(s.mesh_a, any_distance)),
                   distances(reference::self_element_pairs(now_a, any_distance)), separation, 10 * s.tolerance);
    }
  }
  for (const bool is_along : {false, true}) {
    EXPECT_GT(limited[is_along], 250U);
    EXPECT_GT(free[is_along], 250U);
  }
}

TEST(Displacements, AlongMotionsAreThoseThatApproach) {
  for (const double unit : {1.0, 1e-160, 1e-200, 1e-300, 1e50}) {
    const Model floor(mapped(scenes::grid(8, 8, -1, -1, 0.25, 0.25), [&](const Vec3& p) { return unit * p; }));
    MovingModel still(floor);
    ASSERT_TRUE(still.set_motion(floor.mesh().positions()));
    for (const double height : {0.002, 0.001}) {
      const Model sheet(mapped(floor.mesh(), [&](const Vec3& p) { return 0.3 * p + Vec3{0, 0, unit * height}; }));
      for (const Vec3& way : {Vec3{0, 0, 1}, Vec3{0.5, 0.2, 0}, Vec3{0.5, 0.2, 1}, Vec3{0, 0, -1}, Vec3{1, 0, -0.5}}) {
        MovingModel moving(sheet);
        ASSERT_TRUE(moving.set_motion(mapped(sheet.mesh(), [&](const Vec3& p) { return p + unit * way; }).positions()));
        std::vector<double> fractions(floor.mesh().positions().size(), 1.0);
        limit_motions(moving, still, unit * 0.001, fractions);
        for (const double f : fractions) EXPECT_NEAR(f, way.z < 0 ? (height - 0.001) / -way.z : 1, 1e-9) << way.z;
      }
    }
  }
}

TEST(Displacements, OfAVertexThatAFaceNamesTwiceAreThoseOfTwoVertices) {
  const Model other(Mesh::create({{1, 2, 0.75}, {0.5, 1.5, 0}, {0.25, 0.75, 1.75}}, {{0, 1, 2}}).value());
  MovingModel still(other);
  ASSERT_TRUE(still.set_motion(other.mesh().positions()));
  for (const bool is_along : {false, true}) {
    std::vector<double> limits[2];
    for (const bool twice : {false, true}) {
      const std::vector<Vec3> start{{0.25, 0.5, 2}, {0, 1.25, 1.75}, {0, 1.25, 1.75}};
      const Model needle(Mesh::create(start, {{0, 1, twice ? 1U : 2U}}).value());
      MovingModel moving(needle);
      ASSERT_TRUE(moving.set_motion(std::vector<Vec3>{{0.5, 1, 0.5}, {0.5, 1.25, 0.5}, {0.5, 1.25, 0.5}}));
      limits[twice].assign(3, is_along ? 1 : 1e6);
      std::vector<double> stays;
      if (is_along) {
        limit_motions(moving, still, 0.01, limits[twice], stays);
      } else {
        limit_displacements({needle}, {other}, 0, limits[twice], stays);
      }
    }
    EXPECT_LT(limits[0][1], is_along ? 1 : 1e6);
    EXPECT_EQ(limits[1][0], limits[0][0]);
    EXPECT_EQ(limits[1][1], limits[0][1]);
  }
}

TEST(Displacements, LeaveWhatOneDoesNotWantToTheOther) {
  const Model low(scenes::grid(1, 1, 0, 0, 1, 1));
  const Model high(mapped(low.mesh(), [](const Vec3& p) { return p + Vec3{0, 0, 1}; }));
  const auto limited = [&](double of_low, double of_high) {
    std::vector<double> a(4, of_low), b(4, of_high);
    limit_displacements({low}, {high}, 0.25, a, b);
    return std::pair(a[0], b[0]);
  };
  const auto expect_near = [](const std::pair<double, double>& found, double a, double b) {
    EXPECT_LE(found.first, a);
    EXPECT_LE(found.second, b);
    EXPECT_NEAR(found.first, a, 1e-10);
    EXPECT_NEAR(found.second, b, 1e-10);
  };
  expect_near(limited(2, 3), 0.375, 0.375);
  expect_near(limited(2, 0.125), 0.625, 0.125);
  expect_near(limited(0.125, 2), 0.125, 0.625);
  expect_near(limited(0.25, 0.5), 0.25, 0.5);
  std::vector<double> alone(4, 2.0);
  limit_displacements({low}, {high}, 0.25, alone);
  EXPECT_NEAR(alone[3], 0.75, 1e-10);
  limit_displacements({low}, {high}, 1.5, alone);
  EXPECT_EQ(alone, std::vector<double>(4));
}

TEST(Displacements, MistakesAreRefused) {
  const Model model(scenes::grid(1, 1, 0, 0, 1, 1));
  std::vector<double> good(4, 1.0), few(3), bad(4, -1.0), infinite(4, std::numeric_limits<double>::infinity());
  MovingModel moving(model);
  ASSERT_TRUE(moving.set_motion(model.mesh().positions()));
  for (auto* wrong : {&few, &bad, &infinite}) {
    EXPECT_TRUE(is_refused([&] { limit_self_displacements(model, 0, *wrong); },
                           {"limber::limit_self_displacements", "displacement"}));
    EXPECT_TRUE(is_refused([&] { limit_displacements({model}, {model}, 0, good, *wrong); },
                           {"limber::limit_displacements", "displacement"}));
    EXPECT_TRUE(
        is_refused([&] { limit_motions(moving, moving, 0, good, *wrong); }, {"limber::limit_motions", "fraction"}));
  }
  for (const double separation : {-1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_TRUE(is_refused([&] { limit_self_displacements(model, separation, good); }, {"separation"}));
    EXPECT_TRUE(is_refused([&] { limit_self_motions(moving, separation, good); }, {"separation"}));
    EXPECT_TRUE(is_refused([&] { limit_displacements({model}, {model}, separation, good); }, {"separation"}));
  }
}

}  // namespace
}  // namespace limber::testing
