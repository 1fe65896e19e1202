// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What the kernel of leaves leaves out of a model that is compared with itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/shared_corners.h"
#include "limber/contacts.h"
#include "query/frames.h"
#include "query/placed_models.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"
#include "unit/kernel_cases.h"

namespace limber::testing {
namespace {

using query::Side;

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
    if (rng.below(3) == 0) {  // one far smaller than the other, about the origin; their products leave float32
      const Vec3 at = p[0];
      const double tiny = std::pow(10.0, rng.uniform(-40, 0));
      for (Vec3& v : p) v = v - at;
      p[3] = tiny * p[3], p[4] = tiny * p[4];
    }
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
  for (Corners& c : triangles) std::rotate(c.begin(), c.begin() + rng.below(3), c.end());
  return Mesh::create(std::move(p), std::move(triangles)).value();
}

TEST(SeparatedNeighbors, HaveNothingElseInCommon) {
  Rng rng(1401);
  const auto sets = simd::all_kernels();
  int left_out = 0, meeting = 0;
  for (int i = 0; i < 4000; ++i) {
    const Mesh mesh = nearly_meeting(rng);
    const Model model(mesh, {.rebuild_policy = RebuildPolicy::off});
    const bvh::Tree& tree = tree_of(model);
    const query::PlacedModels placed(Placed{model}, Placed{model});
    query::Frames frames(placed);
    const query::Pruning pruning(placed, std::numeric_limits<double>::min());
    for (std::uint32_t k = 0; k < tree.leaves.size(); ++k) {
      for (std::uint32_t l = k; l < tree.leaves.size(); ++l) {
        const simd::SelfPair self{tree.leaves[k], tree.leaves[l]};
        simd::Candidates found, again;
        const auto find = [&](const simd::Kernels& set, simd::Candidates& candidates) {
          set.find_candidates(at_slot(model, k, true), at_slot(model, l, true), frames.of(Side::a), pruning.of(Side::a),
                              &self, false, candidates);
        };
        find(sets[static_cast<std::size_t>(i) % sets.size()], found);
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
            const bool is_candidate = std::any_of(found.pairs, found.pairs + found.count, [&](const auto& pair) {
              return pair.slot_a == s && pair.slot_b == t;
            });
            const bool meet =
                geometry::meets_elsewhere(mesh.triangle(a), mesh.triangles()[a], mesh.triangle(b), mesh.triangles()[b]);
            meeting += meet ? 1 : 0, left_out += is_candidate ? 0 : 1;
            ASSERT_TRUE(is_candidate || !meet) << i << ": " << a << " and " << b;
          }
        }
      }
    }
  }
  EXPECT_GT(left_out, 2000);
  EXPECT_GT(meeting, 600);
}

TEST(SeparatedNeighbors, AreNearlyAllOfASmoothMesh) {
  const Model ball(scenes::ball(60, 40)), sheet(scenes::grid(50, 50, 0, 0, 1, 1));
  for (const Model* model : {&ball, &sheet}) {
    const CollideResult result = self_collide(*model);
    EXPECT_FALSE(result.collision);
    EXPECT_LT(result.stats.triangle_tests, model->mesh().triangles().size() / 8);
  }
}

}  // namespace
}  // namespace limber::testing
