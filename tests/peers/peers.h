// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "model/convex_hull.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/exact_distance.h"
#include "support/random_geometry.h"
#include "support/right_answers.h"
#include "unit/shapes.h"

/// Bodies that bug reports of other libraries describe, and what is asked about every pair of them.
///
/// Some reports are answered by other tests: RandomQueries and PointsProperty (FCL #171, #382, Embree #423,
/// three-mesh-bvh #91, #386, #447, Jolt #655, PhysX-3.4 #140), ContactsProperty (Coal #755, mujoco_warp #1649),
/// ElementsProperty (Jolt #1016), UpdateSequences (python-fcl #45, three-mesh-bvh #879, Warp #1507), TriangleContact
/// (FCL #221, Coal #357, Jolt #529), those that share models with threads (FCL #224, Coal #870, Bullet #59),
/// ContactNormals (IPC Toolkit PR #232), Coincident (libigl #226, trimesh #741), PointDistance (FCL PR #401, axom
/// #1307), SegmentDistance (IPC Toolkit PR #225), EnclosingSphere (scalismo #262), Model (Newton PR #3760), ExactScenes
/// (MuJoCo #3383).
namespace limber::testing {

inline Transform at(double x, double y = 0, double z = 0) { return {{}, {x, y, z}}; }

inline Mesh box(const Vec3& low, const Vec3& high) { return box_mesh(low, high); }
inline Mesh box(const Vec3& half) { return box(-half, half); }

inline Mesh hull(const std::vector<Vec3>& points) {
  model::Hull found = model::convex_hull(points);
  return Mesh::create(std::move(found.positions), std::move(found.triangles)).value();
}

/// A mesh with every coordinate multiplied by a factor of its axis.
inline Mesh stretched(const Mesh& mesh, const Vec3& factors) {
  return mapped(mesh, [&](const Vec3& p) { return Vec3{p.x * factors.x, p.y * factors.y, p.z * factors.z}; });
}

inline Mesh triangles_of(const std::vector<Triangle>& triangles) { return soup(triangles); }

inline Triangle placed_triangle(const Placed& placed, TriangleId id) {
  const Triangle t = placed.model().mesh().triangle(id);
  return {placed.pose(t.v0), placed.pose(t.v1), placed.pose(t.v2)};
}

inline reference::Placed in_reference(const Placed& placed) { return {placed.model().mesh(), placed.pose}; }

/// Each point lies on the triangle that the witness names, and they are `distance` apart. Where that is 0, they are one
/// point, and the triangles intersect.
inline void expect_witness(const Placed& a, const Placed& b, const Witness& w, double distance, double tolerance) {
  EXPECT_EQ(wrong_witness(w, a, b, distance, distance == 0, {distance, tolerance}), "");
}

/// What all queries of two models answer in agreement with each other and with brute force: their distance.
inline double agreed_distance(const Placed& a, const Placed& b, double tolerance) {
  const double truth = reference::distance(in_reference(a), in_reference(b)).upper;
  const bool meet = truth == 0;
  const DistanceResult found = distance(a, b), swapped = distance(b, a);
  for (const DistanceResult& result : {found, swapped}) {
    EXPECT_EQ(result.lower, result.upper);
    EXPECT_NEAR(result.upper, truth, tolerance);
    EXPECT_EQ(result.upper == 0, meet);
    EXPECT_EQ(result.status, meet ? DistanceStatus::collision : DistanceStatus::exact);
  }
  expect_witness(a, b, found.witness.value(), found.upper, tolerance);
  expect_witness(b, a, swapped.witness.value(), swapped.upper, tolerance);
  EXPECT_EQ(collide(a, b).is_yes(), meet);
  EXPECT_EQ(collide(b, a).is_yes(), meet);
  EXPECT_EQ(within(a, b, 0).is_yes(), meet);
  EXPECT_TRUE(within(a, b, found.upper).is_yes());
  EXPECT_EQ(within(a, b, 0.5 * found.upper).is_yes(), meet);
  const std::size_t pairs = reference::intersections(in_reference(a), in_reference(b)).size();
  EXPECT_EQ(intersections(a, b, {}).count, pairs);
  EXPECT_EQ(contacts(a, b, 0, {}).count, pairs);
  EXPECT_EQ(pairs > 0, meet);
  return found.upper;
}

/// The squared distance of two models without rounding, by exact arithmetic on all pairs of their placed triangles.
inline exact::Fraction exact_squared_distance(const Placed& a, const Placed& b) {
  exact::Fraction least = -1;
  for (TriangleId i = 0; i < a.model().mesh().triangles().size(); ++i) {
    for (TriangleId j = 0; j < b.model().mesh().triangles().size(); ++j) {
      const exact::Fraction squared = exact::squared_distance(placed_triangle(a, i), placed_triangle(b, j));
      if (least < 0 || squared < least) least = squared;
    }
  }
  return least;
}

inline void expect_exact(double found, const exact::Fraction& squared, double tolerance) {
  EXPECT_TRUE(exact::is_at_most(found, squared, tolerance)) << found << " is not " << std::sqrt(squared.get_d());
  EXPECT_TRUE(exact::is_at_least(found, squared, tolerance)) << found << " is not " << std::sqrt(squared.get_d());
}

inline std::vector<Contact> all_contacts(const Placed& a, const Placed& b, double margin) {
  std::vector<Contact> found(contacts(a, b, margin, {}).count);
  EXPECT_EQ(contacts(a, b, margin, found).count, found.size());
  return found;
}

inline bool is_finite(const Contact& c) {
  return std::isfinite(c.distance) && std::isfinite(c.depth) && limber::is_finite(c.point_a) &&
         limber::is_finite(c.point_b) && limber::is_finite(c.normal);
}

/// A point of the cube [-size, size]^3.
inline Vec3 random_point(Rng& rng, double size) { return uniform_point(rng, -size, size); }

}  // namespace limber::testing
