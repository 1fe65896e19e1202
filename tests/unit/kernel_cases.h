// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "limber/model.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"
#include "unit/internals.h"

/// What tests of the query kernels compare.
namespace limber::testing {

/// More than any squared bound.
inline constexpr float no_limit_sq = 1e38F;

inline std::vector<Triangle> placed_triangles(const Mesh& mesh, const Transform& pose) {
  std::vector<Triangle> placed;
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    placed.push_back(mapped(mesh.triangle(t), pose));
  }
  return placed;
}

/// The closest points of the triangles of two leaves; `world_a` and `world_b` are the placed triangles.
inline ClosestPoints closest(const bvh::Leaf& a, const std::vector<Triangle>& world_a, const bvh::Leaf& b,
                             const std::vector<Triangle>& world_b) {
  ClosestPoints best;
  best.distance = std::numeric_limits<double>::infinity();
  for (const TriangleId s : a.triangle) {
    for (const TriangleId t : b.triangle) {
      const ClosestPoints found = closest_points(world_a[s], world_b[t]);
      if (found.distance < best.distance) best = found;
    }
  }
  return best;
}

/// The first of the nodes that have leaves.
inline const bvh::Node& lowest_node(const Model& model) {
  return tree_of(model).nodes[tree_of(model).first_lowest_node()];
}

/// A slot of that node, as a node or as a leaf.
inline simd::SlotRef at_slot(const Model& model, std::uint32_t slot, bool as_leaf) {
  return {&lowest_node(model), slot, as_leaf ? &tree_of(model).leaves[slot].corners : nullptr};
}

/// A limit that keeps what touches alone.
inline constexpr float contact_sq = std::numeric_limits<float>::min();

/// What a kernel says of the children of a node compared with a slot of the other tree.
struct BoundedChildren {
  alignas(32) float order[bvh::width] = {}, bound_sq[bvh::width] = {};
  simd::KeptSlots kept;

  BoundedChildren(const simd::Kernels& set, const bvh::Node& node, const simd::SlotRef& other,
                  const simd::FrameTransform& frame, const simd::PruneLimits& limits, float limit_sq,
                  bool has_bounds = true)
      : kept(set.bound_children(node, other, frame, limits, limit_sq, order, has_bounds ? bound_sq : nullptr)) {}

  bool keeps(std::uint32_t slot) const { return (kept.all >> slot & 1) != 0; }
  bool overlaps(std::uint32_t slot) const { return (kept.overlapping >> slot & 1) != 0; }
  double bound(std::uint32_t slot, const Model& model) const {
    return std::sqrt(static_cast<double>(bound_sq[slot])) * tree_of(model).unit;
  }
};

/// Prunes by a distance, and along a direction unless that is 0.
inline pair::Pruning pruning_along(const pair::PlacedPair& placed, double cutoff, const Vec3& direction) {
  pair::Pruning pruning(placed, cutoff);
  const double infinity = std::numeric_limits<double>::infinity();
  pruning.update({infinity, infinity, direction});
  return pruning;
}

/// Strips of eight triangles each, much longer than wide, in all directions, far enough from each other to be leaves.
inline Mesh rods(Rng& rng, std::size_t count, double spread = 10) {
  std::vector<Triangle> triangles;
  for (std::size_t rod = 0; rod < count; ++rod) {
    const Vec3 at = uniform_point(rng, -spread, spread), along = uniform_point(rng), across = 0.05 * uniform_point(rng);
    for (int j = 0; j < 8; ++j) {
      const Vec3 from = at + (0.125 * j) * along, bent = from + 0.005 * uniform_point(rng);
      triangles.push_back({from, bent + 0.25 * along, from + (j % 2 == 0 ? across : -across)});
    }
  }
  return soup(triangles);
}

/// Soups of one kind: spread out, in a small place, flat, thin, points, rods.
inline Mesh some_soup(Rng& rng, std::size_t count) {
  std::vector<Triangle> triangles;
  const std::uint64_t kind = rng.below(6);
  if (kind == 5) return rods(rng, (count + 7) / 8);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 at = uniform_point(rng, -2, 2);
    const double size = kind == 1 ? 1e-3 : 0.5;
    Triangle t{at, at + size * uniform_point(rng), at + size * uniform_point(rng)};
    if (kind == 2) t.v0.z = t.v1.z = t.v2.z = 0.25;
    if (kind == 3) t.v2 = t.v0 + 1e-6 * uniform_point(rng);
    if (kind == 4) t.v1 = t.v2 = t.v0;
    triangles.push_back(t);
  }
  return soup(triangles);
}

/// Two models of a few leaves each, at random poses.
struct KernelCase {
  Model a, b;
  Transform pose_a, pose_b;
  std::vector<Triangle> world_a, world_b;
  pair::PlacedPair placed;
  pair::Frames frames;

  explicit KernelCase(Rng& rng)
      : a(some_soup(rng, 9 + rng.below(56))),
        b(some_soup(rng, 9 + rng.below(56))),
        pose_a(random_pose(rng, 1)),
        pose_b(random_pose(rng, rng.below(3) == 0 ? 100 : 3)),
        world_a(placed_triangles(a.mesh(), pose_a)),
        world_b(placed_triangles(b.mesh(), pose_b)),
        placed({a, pose_a}, {b, pose_b}),
        frames(placed) {}
};

}  // namespace limber::testing
