// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What the kernel of leaves leaves out of a model that is compared with itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/shared_corners.h"
#include "limber/contacts.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"
#include "unit/kernel_cases.h"

namespace limber::testing {
namespace {

using pair::Side;

/// Two triangles that share an edge or a corner, and meet elsewhere or nearly do; others beside them, so that the leaf
/// is larger than the two. What they miss each other by is around the quantization of leaves.
Mesh nearly_meeting(Rng& rng) {
  const double nearly = std::pow(10.0, rng.uniform(-6, -2)), size = std::pow(10.0, rng.uniform(-1, 1));
  std::vector<Vec3> p;
  for (int i = 0; i < 5; ++i) p.push_back(size * uniform_point(rng));
  std::vector<Corners> triangles;
  if (rng.below(2) == 0) {  // a corner: the other triangle's edge ends at the far edge, or passes by it
    const double s = rng.uniform(0, 1), t = rng.uniform(0.5, 2);
    p[3] = p[0] + t * (p[1] + s * (p[2] - p[1]) - p[0]) + nearly * uniform_point(rng);
    triangles = {{0, 1, 2}, {0, 3, 4}};
  } else {  // an edge: slivers on the same side of it, in one plane or nearly so
    const double flat = rng.below(3) == 0 ? 0 : nearly;
    const Vec3 across = nearly * (p[2] - p[0]);
    p[2] = p[0] + rng.uniform(0, 1) * (p[1] - p[0]) + across;
    p[3] = p[0] + rng.uniform(0, 1) * (p[1] - p[0]) + rng.uniform(0, 2) * across + flat * nearly * uniform_point(rng);
    triangles = {{0, 1, 2}, {1, 0, 3}};
  }
  for (VertexId extra = 0, count = static_cast<VertexId>(rng.below(15)); extra < count; ++extra) {
    const auto first = static_cast<VertexId>(p.size());
    for (int i = 0; i < 3; ++i) p.push_back(2 * uniform_point(rng));
    triangles.push_back({first, first + 1, rng.below(2) == 0 ? first + 2 : static_cast<VertexId>(rng.below(4))});
  }
  if (rng.below(4) == 0) {  // vertices named twice
    const auto some = [&] { return static_cast<VertexId>(rng.below(4)); };
    for (int i = 0; i < 4; ++i) triangles.push_back({some(), some(), some()});
  }
  for (Corners& c : triangles) std::rotate(c.begin(), c.begin() + rng.below(3), c.end());
  return Mesh::create(std::move(p), std::move(triangles)).value();
}

/// Triangles and a fan of far smaller ones about one corner of theirs, some with an edge along one of theirs. Products
/// of both leave float32.
Mesh tiny_beside_huge(Rng& rng) {
  std::vector<Vec3> p{{}};
  std::vector<Corners> triangles;
  const double tiny = std::exp2(-static_cast<double>(rng.below(150)));
  for (const double size : {1.0, tiny}) {
    for (int i = 0; i < 10; ++i) {
      const auto next = static_cast<VertexId>(p.size());
      for (int k = 0; k < 2; ++k) {
        const bool is_along = size < 1 && rng.below(3) == 0;
        p.push_back(size * (is_along ? p[1 + rng.below(20)] : uniform_point(rng)));
      }
      triangles.push_back({0, next, next + 1});
    }
  }
  return Mesh::create(std::move(p), std::move(triangles)).value();
}

/// A model whose bounds are those of vertices elsewhere, by as much as the motion margin allows.
Model drifted(Rng& rng, const Mesh& mesh) {
  const double margin = std::pow(10.0, rng.uniform(-5, -1)) * max_abs(mesh.positions()[1]);
  std::vector<Vec3> before = mesh.positions();
  for (Vec3& p : before) p = p + (0.5 * margin) * uniform_point(rng);
  Model model(Mesh::create(before, mesh.triangles()).value(), {.rebuild_policy = RebuildPolicy::off});
  model.set_motion_margin(margin);
  model.move_all(mesh.positions()).value();
  model.commit();
  return model;
}

struct PairCounts {
  int left_out = 0, meeting = 0;
};

/// Compares the leaves of a model with each other and with themselves, by one instruction set and without one.
void expect_that_meeting_pairs_are_candidates(const Model& model, const simd::Kernels& set, PairCounts& counts) {
  const Mesh& mesh = model.mesh();
  const bvh::Tree& tree = tree_of(model);
  const pair::PlacedPair placed(Placed{model}, Placed{model});
  pair::Frames frames(placed);
  const pair::Pruning pruning(placed, std::numeric_limits<double>::min());
  for (std::uint32_t k = 0; k < tree.leaves.size(); ++k) {
    for (std::uint32_t l = k; l < tree.leaves.size(); ++l) {
      const simd::SelfPair self{tree.leaves[k], tree.leaves[l]};
      simd::Candidates found, again;
      const auto find = [&](const simd::Kernels& kernels, simd::Candidates& candidates) {
        kernels.find_candidates(at_slot(model, k, true), at_slot(model, l, true), frames.of(Side::a),
                                pruning.of(Side::a), &self, false, candidates);
      };
      find(set, found);
      find(simd::scalar_kernels, again);
      ASSERT_EQ(found.count, again.count);
      for (std::uint32_t c = 0; c < found.count; ++c) {
        ASSERT_EQ(found.pairs[c].slot_a, again.pairs[c].slot_a);
        ASSERT_EQ(found.pairs[c].slot_b, again.pairs[c].slot_b);
        ASSERT_EQ(found.pairs[c].bound_sq, again.pairs[c].bound_sq);
      }
      for (std::uint32_t s = 0; s < bvh::width; ++s) {
        for (std::uint32_t t = k == l ? s + 1 : 0; t < bvh::width; ++t) {
          const TriangleId a = self.a.triangle[s], b = self.b.triangle[t];
          if (a == b) continue;
          const bool is_candidate = std::any_of(found.pairs, found.pairs + found.count,
                                                [&](const auto& pair) { return pair.slot_a == s && pair.slot_b == t; });
          const bool meet =
              geometry::meets_elsewhere(mesh.triangle(a), mesh.triangles()[a], mesh.triangle(b), mesh.triangles()[b]);
          counts.meeting += meet ? 1 : 0, counts.left_out += is_candidate ? 0 : 1;
          ASSERT_TRUE(is_candidate || !meet) << a << " and " << b;
        }
      }
    }
  }
}

/// Compares the leaves of models that a function draws, each on another instruction set.
template <typename Draw>
void expect_nothing_else_in_common(std::uint64_t seed, std::size_t count, int left_out, const Draw& draw) {
  Rng rng(seed);
  const auto sets = simd::all_kernels();
  PairCounts counts;
  for (std::size_t i = 0; i < count; ++i) {
    const Model model = draw(rng);
    ASSERT_NO_FATAL_FAILURE(expect_that_meeting_pairs_are_candidates(model, sets[i % sets.size()], counts)) << i;
  }
  EXPECT_GT(counts.left_out, left_out);
  EXPECT_GT(counts.meeting, 600);
}

TEST(SeparatedNeighbors, HaveNothingElseInCommon) {
  constexpr ModelOptions as_built{.rebuild_policy = RebuildPolicy::off};
  expect_nothing_else_in_common(1401, 4000, 2000, [&](Rng& rng) { return Model(nearly_meeting(rng), as_built); });
  expect_nothing_else_in_common(1402, 4000, 1000, [](Rng& rng) { return drifted(rng, nearly_meeting(rng)); });
  expect_nothing_else_in_common(1403, 1000, 1000, [&](Rng& rng) { return Model(tiny_beside_huge(rng), as_built); });
}

TEST(SeparatedNeighbors, AreNearlyAllOfASmoothMesh) {
  const Model ball(scenes::ball(60, 40)), sheet(scenes::grid(50, 50, 0, 0, 1, 1));
  for (const Model* model : {&ball, &sheet}) {
    const CollideResult result = self_collide(*model);
    EXPECT_FALSE(result.is_yes());
    EXPECT_LT(result.stats.primitive_tests, model->mesh().triangles().size() / 8);
  }
}

}  // namespace
}  // namespace limber::testing
