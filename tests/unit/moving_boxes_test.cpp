// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bounds of moving models: boxes contain what they should at both ends, and the time at which two boxes meet is never
// overstated, next to rational arithmetic.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "bvh/tree.h"
#include "simd/kernels.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// Numbers of one kind: integers, with their last bits changed, any, or of any size.
double some_number(Rng& rng, std::uint64_t kind) {
  const double integer = static_cast<double>(rng.below(8)) - 4;
  switch (kind) {
    case 0:
      return integer;
    case 1:
      return integer * (1 + static_cast<double>(rng.below(5)) * 0x1p-52);
    case 2:
      return rng.uniform(-4, 4);
    default:
      return std::ldexp(rng.uniform(-4, 4), -static_cast<int>(rng.below(1060)));
  }
}

struct Intervals {
  double low[2], high[2];
};

Intervals some_intervals(Rng& rng, std::uint64_t kind) {
  Intervals i{};
  for (int end = 0; end < 2; ++end) {
    const double x = some_number(rng, kind), y = rng.below(3) == 0 ? x : some_number(rng, kind);
    i.low[end] = std::min(x, y), i.high[end] = std::max(x, y);
  }
  return i;
}

struct ExactMeeting {
  mpq_class first, last;
};

/// When boxes that are within a separation from `before.first` to `before.last` along other axes are so along this one
/// too; nothing if they never are.
std::optional<ExactMeeting> exact_meeting(ExactMeeting before, const Intervals& a, const Intervals& b,
                                          double separation) {
  const mpq_class gaps[2][2] = {
      {mpq_class(a.low[0]) - b.high[0] - separation, mpq_class(a.low[1]) - b.high[1] - separation},
      {mpq_class(b.low[0]) - a.high[0] - separation, mpq_class(b.low[1]) - a.high[1] - separation}};
  for (const auto& gap : gaps) {
    if (gap[0] > 0 && gap[1] > 0) return std::nullopt;
    if (gap[0] <= 0 && gap[1] <= 0) continue;
    const mpq_class closed = gap[0] / (gap[0] - gap[1]);
    if (gap[0] > 0) {
      before.first = std::max(before.first, closed);
    } else {
      before.last = std::min(before.last, closed);
    }
  }
  if (before.first > before.last) return std::nullopt;
  return before;
}

TEST(MovingBoxes, MeetOnlyWhileTheyAreSaidTo) {
  Rng rng(3210);
  std::size_t met = 0, tight = 0, parted = 0;
  for (int i = 0; i < 20000 && !HasFailure(); ++i) {
    const std::uint64_t kind = rng.below(4);
    bvh::MovingNode node{};
    bvh::MovingBox other{};
    const ExactMeeting window{rng.below(4) == 0 ? rng.uniform(0, 0.5) : 0, rng.below(4) == 0 ? rng.uniform(0.5, 1) : 1};
    std::vector<std::optional<ExactMeeting>> exact(bvh::width, window);
    const double separation = rng.below(2) == 0 ? 0 : std::abs(some_number(rng, kind));
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const Intervals b = some_intervals(rng, kind);
      for (int end = 0; end < 2; ++end) other.low[end][axis] = b.low[end], other.high[end][axis] = b.high[end];
      for (std::uint32_t k = 0; k < bvh::width; ++k) {
        const Intervals a = some_intervals(rng, kind);
        for (int end = 0; end < 2; ++end) node.low[end][axis][k] = a.low[end], node.high[end][axis][k] = a.high[end];
        if (exact[k]) exact[k] = exact_meeting(*exact[k], a, b, separation);
      }
    }
    const simd::MotionLimits limits{window.first.get_d(), window.last.get_d(), separation};
    simd::MeetingTimes times;
    const unsigned found = simd::scalar_kernels.find_meeting_children(node, other, limits, times);
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::MeetingTimes again;
      EXPECT_EQ(set.find_meeting_children(node, other, limits, again), found) << set.name;
      EXPECT_TRUE(std::equal(times.first, times.first + bvh::width, again.first)) << set.name;
      EXPECT_TRUE(std::equal(times.last, times.last + bvh::width, again.last)) << set.name;
    }
    for (std::uint32_t k = 0; k < bvh::width; ++k) {
      const double first = times.first[k], last = times.last[k];
      EXPECT_EQ((found >> k & 1) != 0, first <= last);
      parted += first > last ? 1 : 0;
      if (!exact[k]) continue;
      EXPECT_LE(mpq_class(first), exact[k]->first);
      EXPECT_GE(mpq_class(last), exact[k]->last);
      EXPECT_GE(first, limits.begin);
      EXPECT_LE(last, limits.end);
      ++met;
      tight +=
          first >= exact[k]->first.get_d() * (1 - 1e-12) - 1e-300 && last <= exact[k]->last.get_d() + 1e-12 ? 1 : 0;
    }
  }
  EXPECT_GT(met, 20000U);
  EXPECT_GT(tight * 100, met * 99);
  EXPECT_GT(parted, 20000U);
}

TEST(MovingTree, ContainsTheModelAtBothEnds) {
  Rng rng(3211);
  for (int i = 0; i < 60 && !HasFailure(); ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(rng.below(300)) - 150);
    const Mesh mesh = arbitrary_mesh(rng, 300, rng.below(2) == 0 ? uniform_point(rng, -1e6, 1e6) : Vec3{}, scale);
    std::vector<Vec3> end;
    for (const Vec3& p : mesh.positions()) end.push_back(p + scale * uniform_point(rng));
    const bvh::Tree tree = bvh::build(mesh);
    bvh::MovingTree moving;
    bvh::fit(moving, tree, mesh.positions(), end);
    const std::span<const Vec3> positions[2] = {mesh.positions(), end};
    for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
      for (std::uint32_t k = 0; k < tree.nodes[n].child_count; ++k) {
        const bvh::MovingBox box = moving.nodes[n].box(k);
        const bvh::SlotId slot = n * bvh::width + k;
        if (!bvh::has_leaf(tree, slot)) {
          const bvh::MovingNode& child = moving.nodes[bvh::child_of(tree, slot)];
          for (std::uint32_t j = 0; j < bvh::width; ++j) {
            for (int side = 0; side < 2; ++side) {
              for (std::uint32_t axis = 0; axis < 3; ++axis) {
                EXPECT_LE(box.low[side][axis], child.low[side][axis][j]);
                EXPECT_GE(box.high[side][axis], child.high[side][axis][j]);
              }
            }
          }
          continue;
        }
        const bvh::Leaf& leaf = bvh::leaf_of(tree, slot);
        const bvh::MovingLeaf& corners = moving.leaves[bvh::child_of(tree, slot)];
        for (int side = 0; side < 2; ++side) {
          for (std::uint32_t j = 0; j < bvh::width * 3; ++j) {
            const Vec3& p = positions[side][leaf.vertices[j / 3][j % 3]];
            for (std::uint32_t axis = 0; axis < 3; ++axis) {
              EXPECT_TRUE(box.low[side][axis] <= p[axis] && p[axis] <= box.high[side][axis]);
              const float corner = corners.corner[side][3 * (j % 3) + axis][j / 3];
              EXPECT_LE(std::abs(corner), 1);
              EXPECT_NEAR(corners.unit[side] * static_cast<double>(corner), p[axis] - corners.center[side][axis],
                          corners.unit[side] * 0x1.01p-24);
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace limber::testing
