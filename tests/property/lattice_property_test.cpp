// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries in scenes whose coordinates are small integers, against brute force. Centers, normals and heights of bounds
// coincide or are 0 there, to the bit, and nearly everything meets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/elements.h"
#include "limber/model.h"
#include "reference/reference.h"
#include "simd/kernels.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// One of the 24 turns of a cube, or with `mirrors` one of 48 maps.
Mat3 lattice_rotation(Rng& rng, bool mirrors = false) {
  std::size_t axis[3] = {0, 1, 2};
  for (std::size_t k = 2; k > 0; --k) std::swap(axis[k], axis[rng.below(k + 1)]);
  Mat3 m{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  Vec3* const rows[3] = {&m.row0, &m.row1, &m.row2};
  for (std::size_t k = 0; k < 3; ++k) (*rows[k])[axis[k]] = rng.below(2) == 0 ? 1 : -1;
  const bool is_mirror = dot(cross(m.row0, m.row1), m.row2) < 0;
  if (is_mirror && !(mirrors && rng.below(2) == 0)) m.row0 = -1 * m.row0;
  return m;
}

/// Triangles between lattice points, or a plane over a lattice, or some triangles many times.
Mesh lattice_mesh(Rng& rng) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  const std::uint64_t kind = rng.below(3);
  if (kind == 0) {
    const std::uint64_t side = 2 + rng.below(4), points = 3 + rng.below(20), count = 1 + rng.below(30);
    for (std::uint64_t i = 0; i < points; ++i) positions.push_back(lattice_point(rng, side));
    const auto some = [&] { return static_cast<VertexId>(rng.below(points)); };
    for (std::uint64_t i = 0; i < count; ++i) triangles.push_back({some(), some(), some()});
  } else if (kind == 1) {  // z = a x + b y
    const auto slope = [&] { return static_cast<double>(rng.below(3)) - 1; };
    const double a = slope(), b = slope();
    const auto n = static_cast<VertexId>(1 + rng.below(8));
    return mapped(scenes::grid(n, n, 0, 0, 1, 1), [&](const Vec3& p) { return Vec3{p.x, p.y, a * p.x + b * p.y}; });
  } else {
    for (int i = 0; i < 4; ++i) positions.push_back(lattice_point(rng, 4));
    const std::uint64_t count = 1 + rng.below(20);
    for (std::uint64_t i = 0; i < count; ++i) {  // of two triangles with a common edge, one twice as often
      Corners c{0, 1, rng.below(3) < 2 ? 2U : 3U};
      std::rotate(c.begin(), c.begin() + rng.below(3), c.end());
      if (rng.below(2) == 0) std::swap(c[0], c[1]);
      triangles.push_back(c);
    }
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// Two such meshes, or one and itself turned or mirrored, at integer places.
RandomScene lattice_scene(Rng& rng) {
  Mesh a = lattice_mesh(rng), b = lattice_mesh(rng);
  if (rng.below(2) == 0) {
    const Mat3 m = lattice_rotation(rng, true);
    b = mapped(a, [&](const Vec3& p) { return m * p; });
  }
  const auto place = [&] {
    const auto integer = [&] { return static_cast<double>(rng.below(5)) - 2; };
    const Transform pose{lattice_rotation(rng), {integer(), integer(), integer()}};
    return rng.below(3) == 0 ? Transform{} : pose;
  };
  const Transform pose_a = place(), pose_b = place();
  return {std::move(a), std::move(b), pose_a, pose_b, 20, 1e-13};
}

/// What is found is what brute force finds. Each scene runs on one instruction set, in turn.
class LatticeProperty : public ::testing::Test {
 protected:
  void TearDown() override { simd::use_kernels(nullptr); }

  void choose_kernels(std::size_t scene) {
    const std::span<const simd::Kernels> sets = simd::all_kernels();
    simd::use_kernels(&sets[scene % sets.size()]);
  }
};

TEST_F(LatticeProperty, OfTwoModels) {
  Rng rng(1601);
  int meeting = 0;
  for (std::size_t i = 0; i < 8000; ++i) {
    const RandomScene s = lattice_scene(rng);
    choose_kernels(i);
    const Model a(s.mesh_a), b(s.mesh_b);
    const Placed pa{a, s.pose_a}, pb{b, s.pose_b};
    const reference::Placed ra{s.mesh_a, s.pose_a}, rb{s.mesh_b, s.pose_b};
    const std::size_t expected = reference::intersections(ra, rb).size();
    ASSERT_EQ(intersections(pa, pb, {}).count, expected) << "scene " << i;
    ASSERT_EQ(collide(pa, pb).is_yes(), expected > 0) << "scene " << i;
    ASSERT_EQ(within(pa, pb, 0).is_yes(), expected > 0) << "scene " << i;
    ASSERT_EQ(contacts(pa, pb, 0, {}).count, expected) << "scene " << i;
    const double distance = reference::distance(ra, rb).upper;
    ASSERT_NEAR(limber::distance(pa, pb).upper, distance, s.tolerance) << "scene " << i;
    ASSERT_TRUE(within(pa, pb, distance + s.tolerance).is_yes()) << "scene " << i;
    ASSERT_TRUE(distance == 0 || within(pa, pb, distance - s.tolerance).is_no()) << "scene " << i;
    QueryCache cache;
    static_cast<void>(limber::distance(pa, pb, {.cache = &cache}));
    ASSERT_EQ(collide(pa, pb, {.cache = &cache}).is_yes(), expected > 0) << "scene " << i;
    meeting += expected > 0 ? 1 : 0;
  }
  EXPECT_GT(meeting, 1000);
  EXPECT_LT(meeting, 7500);
}

TEST_F(LatticeProperty, OfOneModel) {
  Rng rng(1602);
  int meeting = 0;
  for (std::size_t i = 0; i < 4000; ++i) {
    const Mesh mesh = lattice_mesh(rng);
    choose_kernels(i);
    const Model model(mesh);
    const std::size_t expected = reference::self_intersections(mesh).size();
    ASSERT_EQ(self_intersections(model, {}).count, expected) << "mesh " << i;
    ASSERT_EQ(self_collide(model).is_yes(), expected > 0) << "mesh " << i;
    ASSERT_EQ(self_contacts(model, 0, {}).count, expected) << "mesh " << i;
    meeting += expected > 0 ? 1 : 0;
  }
  EXPECT_GT(meeting, 1000);
}

TEST_F(LatticeProperty, OfPoints) {
  Rng rng(1603);
  for (std::size_t i = 0; i < 2000; ++i) {
    const Mesh mesh = lattice_mesh(rng);
    choose_kernels(i);
    const Model model(mesh);
    const Transform pose{lattice_rotation(rng), lattice_point(rng, 4)};
    for (int k = 0; k < 8; ++k) {
      const Vec3 point = 0.5 * lattice_point(rng, 12);
      const SurfacePoint found = closest_point({model, pose}, point).closest.value();
      const SurfacePoint expected = reference::closest_point({mesh, pose}, point).closest.value();
      ASSERT_EQ(found.distance, expected.distance) << "mesh " << i;
      ASSERT_EQ(found.triangle, expected.triangle) << "mesh " << i;
    }
  }
}

TEST_F(LatticeProperty, OfElements) {
  Rng rng(1604);
  for (std::size_t i = 0; i < 1500; ++i) {
    const RandomScene s = lattice_scene(rng);
    choose_kernels(i);
    const Model a(s.mesh_a), b(s.mesh_b);
    // Of no two lattice elements the distance, up to rounding: its square, 81 / 400, is the quotient of an integer and
    // the square of an edge or a normal only if 400 divides that. Edges are shorter. The length of a normal would be a
    // multiple of 20, as that of no primitive one is: 4 divides a sum of three squares if all of them are even.
    const double margin = 0.45;
    const ElementPairCount two = element_pairs({a, s.pose_a}, {b, s.pose_b}, margin, {}, {});
    const reference::ElementPairs expected =
        reference::element_pairs({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}, margin);
    ASSERT_EQ(two.vertex_face, expected.vertex_face.size()) << "scene " << i;
    ASSERT_EQ(two.edge_edge, expected.edge_edge.size()) << "scene " << i;
    const ElementPairCount one = self_element_pairs(a, margin, {}, {});
    const reference::ElementPairs expected_of_one = reference::self_element_pairs(s.mesh_a, margin);
    ASSERT_EQ(one.vertex_face, expected_of_one.vertex_face.size()) << "scene " << i;
    ASSERT_EQ(one.edge_edge, expected_of_one.edge_edge.size()) << "scene " << i;
  }
}

}  // namespace
}  // namespace limber::testing
