// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "bvh/partition.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using bvh::PrimitiveRef;
using Primitives = std::vector<PrimitiveRef>;

constexpr float infinity = std::numeric_limits<float>::infinity();

struct Case {
  std::string name;
  std::function<float(Rng&, std::size_t)> coordinate;  // of primitive i along the longest side
};

/// Coordinates that make it hard to find a median by a sample.
std::vector<Case> cases() {
  return {
      {"uniform", [](Rng& rng, std::size_t) { return static_cast<float>(rng.uniform(-1, 1)); }},
      {"all equal but two", [](Rng&, std::size_t i) { return i == 3   ? -1.0F
                                                             : i == 4 ? 1.0F
                                                                      : 0.25F; }},
      {"two values", [](Rng& rng, std::size_t) { return rng.below(2) == 0 ? -1.0F : 1.0F; }},
      {"zeros of both signs",
       [](Rng& rng, std::size_t i) {
         return i == 0 ? -1.0F : i == 1 ? 1.0F : rng.below(2) == 0 ? -0.0F : 0.0F;
       }},
      {"many sizes",
       [](Rng& rng, std::size_t) {
         return static_cast<float>(std::ldexp(rng.uniform(-1, 1), -static_cast<int>(rng.below(140))));
       }},
      {"rows of a grid", [](Rng&, std::size_t i) { return static_cast<float>(i % 128); }},
      {"few below, far off", [](Rng&, std::size_t i) { return i % 512 == 0 ? -1e30F : 1.0F / static_cast<float>(i); }},
      {"sorted", [](Rng&, std::size_t i) { return static_cast<float>(i); }},
      {"backwards", [](Rng&, std::size_t i) { return -static_cast<float>(i); }},
      {"mostly infinite",
       [](Rng& rng, std::size_t i) {
         return i < 2 ? static_cast<float>(i) : rng.below(4) == 0 ? -infinity : infinity;
       }},
      {"all infinite but one", [](Rng&, std::size_t i) { return i == 0 ? 0 : infinity; }},
      {"huge", [](Rng& rng, std::size_t) { return static_cast<float>(rng.uniform(-1, 1) * 3e38); }},
  };
}

Primitives primitives_of(const Case& c, std::size_t axis, std::size_t count) {
  Rng rng(61);
  Primitives primitives(count);
  for (std::size_t i = 0; i < count; ++i) {
    primitives[i].center[axis] = c.coordinate(rng, i);
    primitives[i].triangle = static_cast<TriangleId>((i * 7919) % count);  // not in order
  }
  return primitives;
}

/// The same by sorting.
Primitives sorted(Primitives primitives, std::size_t axis) {
  std::sort(primitives.begin(), primitives.end(), [axis](const PrimitiveRef& s, const PrimitiveRef& t) {
    return s.center[axis] != t.center[axis] ? s.center[axis] < t.center[axis] : s.triangle < t.triangle;
  });
  return primitives;
}

std::vector<TriangleId> triangles_in(const Primitives& primitives, const bvh::BuildRange& range) {
  std::vector<TriangleId> ids;
  for (std::size_t i = range.begin; i < range.end; ++i) ids.push_back(primitives[i].triangle);
  std::sort(ids.begin(), ids.end());
  return ids;
}

TEST(Split, FindsTheMedianOfAnyCoordinatesInStepsOfAnySize) {
  for (const Case& c : cases()) {
    for (const std::size_t count : {std::size_t{9}, std::size_t{17}, std::size_t{64}, std::size_t{65}, std::size_t{512},
                                    std::size_t{513}, std::size_t{20'011}}) {
      for (const std::size_t axis : {std::size_t{0}, std::size_t{2}}) {
        SCOPED_TRACE(c.name + ", " + std::to_string(count));
        const Primitives wanted = sorted(primitives_of(c, axis, count), axis);
        Primitives at_once = primitives_of(c, axis, count), in_steps = at_once;
        const bvh::BuildRange range = bvh::build_range(0, count);
        const auto halves = bvh::split(at_once, range);
        ASSERT_EQ(halves[0].begin, 0U);
        ASSERT_EQ(halves[0].end, halves[1].begin);
        ASSERT_EQ(halves[1].end, count);
        for (const bvh::BuildRange& half : halves) ASSERT_EQ(triangles_in(at_once, half), triangles_in(wanted, half));
        bvh::Split split(range);
        std::size_t steps = 0;
        for (bool is_done = false; !is_done; ++steps) {
          base::WorkBudget least(1e-3);
          is_done = split.work(in_steps, least);
          ASSERT_LT(least.spent_ns(), 6000);
          ASSERT_LT(steps, 30 * (1 + count / 1000));
        }
        EXPECT_GE(steps, 1 + count / 1024);
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(in_steps[i].triangle, at_once[i].triangle) << i;
      }
    }
  }
}

/// All at the origin but one, which is larger.
Mesh mesh_with_one_larger(std::size_t count, std::size_t larger) {
  std::vector<Corners> triangles(count, {0, 0, 0});
  triangles[larger] = {1, 2, 3};
  return Mesh::create(std::vector<Vec3>{{}, {3, 0, 0}, {0, 40, 0}, {0, 0, -500}}, std::move(triangles)).value();
}

TEST(BoundingBox, HasAllTrianglesWhereverTheyAre) {
  for (const std::size_t count : {1U, 8192U, 8193U, 20'000U, 600'001U}) {
    for (const std::size_t larger : {std::size_t{0}, count / 2, count - 1}) {
      const Mesh mesh = mesh_with_one_larger(count, larger);
      bvh::BoundingBox expected;
      for (std::size_t t = 0; t < count; ++t) expected.add(mesh.view().triangle(static_cast<TriangleId>(t)));
      const bvh::BoundingBox box = bvh::bounding_box_of(mesh.view());
      EXPECT_EQ(box.center(), expected.center()) << count << " " << larger;
      EXPECT_EQ(box.unit(), expected.unit()) << count << " " << larger;
      EXPECT_EQ(box.center().z, -250);
    }
  }
}

}  // namespace
}  // namespace limber::testing
