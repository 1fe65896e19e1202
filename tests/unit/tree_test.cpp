// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "bvh/partition.h"
#include "bvh/refit.h"
#include "bvh/tree.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "support/rational_geometry.h"
#include "unit/internals.h"
#include "unit/kernel_cases.h"

namespace limber::testing {
namespace {

using bvh::Tree;
using bvh::VertexIndex;

TEST(Tree, ShapeDependsOnTheNumberOfTrianglesAlone) {
  Rng rng(210);
  for (const std::uint32_t triangles : {1U, 2U, 8U, 9U, 64U, 65U, 512U, 513U, 700U, 4097U}) {
    const Model a(scenes::random_soup(rng, triangles, 1)), b(scenes::lattice_soup(rng, triangles, 2));
    const std::size_t leaves = (triangles + 7) / 8;
    std::size_t levels = 1;
    for (std::size_t leaves_below = 1; leaves_below < leaves; leaves_below *= 8) ++levels;
    for (const Model* model : {&a, &b}) {
      EXPECT_TRUE(static_cast<bool>(model->validate())) << triangles;
      EXPECT_EQ(model->tree_stats().leaves, leaves);
      EXPECT_EQ(model->tree_stats().levels, levels);
    }
    EXPECT_EQ(a.tree_stats().nodes, b.tree_stats().nodes);
    EXPECT_EQ(a.tree_stats().bytes, b.tree_stats().bytes);
  }
}

TEST(Tree, StaysWithinItsMemory) {
  const Model sheet(scenes::grid(200, 200, 0, 0, 1, 1));
  const double bytes = static_cast<double>(sheet.tree_stats().bytes);
  EXPECT_LE(bytes / static_cast<double>(sheet.mesh().triangles().size()), 44);
}

TEST(Tree, UnitIsTheNextPowerOfTwo) {
  EXPECT_EQ(bvh::unit_for(1024, 0), 1024);
  EXPECT_EQ(bvh::unit_for(std::nextafter(1024, 2000), 0), 2048);
  EXPECT_EQ(bvh::unit_for(std::nextafter(1024, 0), 0), 1024);
  EXPECT_EQ(bvh::unit_for(0, 0x1p60), 0x1p10);
}

TEST(Tree, RootIsHardlyLargerThanABall) {
  // The mesh is a ball of radius 1. Queries that are far enough from it should not have to expand the root.
  const Tree tree = bvh::build(scenes::ball(160, 80));
  EXPECT_LT(tree.unit * static_cast<double>(tree.nodes[0].bounds.radius[0]), 1.2);
}

TEST(Tree, IsTheSameOnAnyNumberOfThreads) {
  const Mesh mesh = scenes::thesis_sheet();  // 20 000 triangles: enough to be built on several threads
  const auto built_on = [&](std::size_t threads) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    return bvh::build(mesh);
  };
  const Tree one = built_on(1), many = built_on(4);
  ASSERT_EQ(one.nodes.size(), many.nodes.size());
  ASSERT_EQ(one.leaves.size(), many.leaves.size());
  for (std::size_t i = 0; i < one.nodes.size(); ++i) {
    ASSERT_EQ(std::memcmp(&one.nodes[i].bounds, &many.nodes[i].bounds, sizeof(bvh::ChildBounds)), 0) << i;
    ASSERT_EQ(std::memcmp(&one.nodes[i].sides, &many.nodes[i].sides, sizeof(bvh::SlabSides)), 0) << i;
    ASSERT_EQ(one.nodes[i].origin, many.nodes[i].origin) << i;
  }
  EXPECT_EQ(std::memcmp(one.leaves.data(), many.leaves.data(), one.leaves.size() * sizeof(bvh::Leaf)), 0);
}

/// Whether a corner lies in all volumes of a slot, in exact arithmetic.
bool holds_exactly(const Tree& tree, std::uint32_t node_id, std::uint32_t slot, const Vec3& corner) {
  const bvh::Node& node = tree.nodes[node_id];
  const bvh::ChildBounds& n = node.bounds;
  const auto exact = [](float x) { return Rational(static_cast<double>(x)); };
  const Rational unit(tree.unit);
  const RationalVec out = minus(rational(corner), rational(node.origin));
  const Rational x = out[0] / unit - exact(n.center_x[slot]), y = out[1] / unit - exact(n.center_y[slot]),
                 z = out[2] / unit - exact(n.center_z[slot]);
  const Rational r = exact(n.radius[slot]);
  const Rational h = x * exact(n.normal_x[slot]) + y * exact(n.normal_y[slot]) + z * exact(n.normal_z[slot]);
  const auto within = [](const Rational& value, const Rational& limit) { return value <= limit && -value <= limit; };
  // Directions as float64 has them, which are off by less than a hundredth of a step.
  const Vec3 normal{n.normal_x[slot], n.normal_y[slot], n.normal_z[slot]};
  const Vec3 side = bvh::in_plane(normal, node.sides.turn[slot]), sides[2] = {side, cross(normal, side)};
  for (std::size_t k = 0; k < 2; ++k) {
    const Rational at =
        (x * Rational(sides[k].x) + y * Rational(sides[k].y) + z * Rational(sides[k].z)) * exact(bvh::max_side);
    if (at < r * Rational(static_cast<double>(node.sides.low[k][slot])) ||
        at > r * Rational(static_cast<double>(node.sides.high[k][slot])))
      return false;
  }
  return x * x + y * y + z * z <= r * r && within(x, exact(n.half_x[slot])) && within(y, exact(n.half_y[slot])) &&
         within(z, exact(n.half_z[slot])) && h >= exact(n.low[slot]) && h <= exact(n.high[slot]);
}

/// Calls `visit` for the leaves below a slot.
void visit_leaves(const Tree& tree, std::uint32_t node_id, std::uint32_t slot,
                  const std::function<void(const bvh::Leaf&)>& visit) {
  const std::uint32_t child = tree.nodes[node_id].first_child + slot;
  if (node_id >= tree.first_lowest_node()) return visit(tree.leaves[child]);
  for (std::uint32_t k = 0; k < tree.nodes[child].child_count; ++k) visit_leaves(tree, child, k, visit);
}

/// The mesh with each triangle scaled by another power of two, so that specks lie next to large triangles.
Mesh shrunk(Rng& rng, const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle m = mesh.triangle(t);
    const double scale = std::ldexp(1.0, -static_cast<int>(rng.below(60)));
    triangles.push_back({m.v0, m.v0 + scale * (m.v1 - m.v0), m.v0 + scale * (m.v2 - m.v0)});
  }
  return soup(triangles);
}

/// Crowds of small triangles, each around another place.
Mesh crowds(Rng& rng, int count, int each) {
  std::vector<Triangle> triangles;
  for (int crowd = 0; crowd < count; ++crowd) {
    const Vec3 at = uniform_point(rng);
    const double size = std::ldexp(1.0, -5 - static_cast<int>(rng.below(130)));  // float32 has no squares of most
    for (int i = 0; i < each; ++i) {
      const Vec3 p = at + size * uniform_point(rng);
      triangles.push_back({p, p + 0.1 * size * uniform_point(rng), p + 0.1 * size * uniform_point(rng)});
    }
  }
  return soup(triangles);
}

void require_exact_bounds(const Mesh& mesh, int which) {
  const Tree tree = bvh::build(mesh);
  ASSERT_TRUE(static_cast<bool>(bvh::validate(tree, mesh))) << bvh::validate(tree, mesh).error().text;
  for (std::uint32_t node_id = 0; node_id < tree.nodes.size(); ++node_id) {
    for (std::uint32_t slot = 0; slot < tree.nodes[node_id].child_count; ++slot) {
      visit_leaves(tree, node_id, slot, [&](const bvh::Leaf& leaf) {
        for (const TriangleId t : leaf.triangle) {
          for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_TRUE(holds_exactly(tree, node_id, slot, mesh.triangle(t)[k]))
                << "case " << which << " node " << node_id;
          }
        }
      });
    }
  }
}

TEST(Tree, BoundsHoldInExactArithmetic) {
  Rng rng(211);
  for (int i = 0; i < 60; ++i) {
    Mesh mesh = i % 3 == 0 ? scenes::lattice_soup(rng, 100, 3) : scenes::random_soup(rng, 100, 1 + i % 5);
    std::vector<Vec3> positions = mesh.positions();
    const Vec3 offset = i % 4 == 0 ? Vec3{1e6, -3e7, 1e5} : Vec3{};
    const double scale = i % 5 == 0 ? 0x1p-90 : i % 5 == 1 ? 0x1p150 : 1;
    for (Vec3& p : positions) p = (p + offset) * scale;
    mesh = Mesh::create(std::move(positions), mesh.triangles()).value();
    require_exact_bounds(i % 7 == 0 ? shrunk(rng, mesh) : mesh, i);
  }
  for (int i = 0; i < 10; ++i) require_exact_bounds(crowds(rng, 4, 70), 100 + i);
  for (int i = 0; i < 20; ++i) require_exact_bounds(crowds(rng, 24, 8), 110 + i);
  require_exact_bounds(scenes::ball(40, 21), 200);
  for (int i = 0; i < 10; ++i) require_exact_bounds(rods(rng, 40), 300 + i);
  require_exact_bounds(scenes::alpha_puzzle().robot, 310);
}

TEST(Tree, ValidateNamesWhatIsBroken) {
  const Mesh mesh = scenes::ball(16, 9);
  const Tree sound = bvh::build(mesh);
  ASSERT_TRUE(static_cast<bool>(bvh::validate(sound, mesh)));
  const std::size_t last = sound.nodes.size() - 1;
  ASSERT_EQ(sound.nodes[last - 1].child_count, bvh::width);
  const std::vector<std::pair<std::string, std::function<void(Tree&)>>> damages{
      {"I1", [](Tree& t) { t.nodes[0].child_count = 2; }},
      {"I1", [](Tree& t) { t.nodes[1].first_child += 1; }},
      {"I1", [](Tree& t) { t.level_begin.back() -= 1; }},
      {"I1", [](Tree& t) { t.nodes[2].parent += 1; }},
      {"I1", [](Tree& t) { t.nodes[1].child_count = 0; }},
      {"I1", [&](Tree& t) { t.nodes[last].child_count = bvh::width + 1; }},
      {"I2", [&](Tree& t) { t.nodes[last].first_child -= 1; }},
      {"I1",  // one slot too many in a node and one too few in the next: all sums are right
       [&](Tree& t) { ++t.nodes[last - 1].child_count, --t.nodes[last].child_count, ++t.nodes[last].first_child; }},
      {"I2", [](Tree& t) { t.leaves[3].triangle[2] = t.leaves[0].triangle[0]; }},
      {"I2", [](Tree& t) { t.leaves[3].triangle[2] = 100000; }},
      {"I2", [](Tree& t) { t.leaves[2].vertices[5][1] ^= 1; }},
      {"I4", [&](Tree& t) { t.nodes[last].bounds.radius[0] *= 0.99F; }},
      {"I4", [&](Tree& t) { t.nodes[0].bounds.half_y[0] *= 0.99F; }},
      {"I4", [&](Tree& t) { t.nodes[last].bounds.high[1] -= 1e-3F; }},
      {"I4", [&](Tree& t) { t.nodes[last].bounds.low[1] += 1e-3F; }},
      {"I5", [](Tree& t) { t.leaves[1].corners.corner[4][5] += 2; }},
      {"I6", [](Tree& t) { t.nodes[1].radius *= 0.9F; }},
      {"I6", [&](Tree& t) { t.nodes[last].radius *= 0.9F; }},
      {"I7", [](Tree& t) { t.nodes[0].coincident_slots = 1; }},
      {"I7", [&](Tree& t) { t.nodes[last].coincident_slots = 1; }}};
  for (std::size_t i = 0; i < damages.size(); ++i) {
    Tree tree = sound;
    damages[i].second(tree);
    const auto result = bvh::validate(tree, mesh);
    ASSERT_FALSE(static_cast<bool>(result)) << i;
    EXPECT_TRUE(result.error().text.starts_with(damages[i].first)) << i << ": " << result.error().text;
  }
}

TEST(Tree, ValidateNamesSidesThatAreBroken) {
  Rng rng(212);
  const Mesh mesh = rods(rng, 40);
  const Tree sound = bvh::build(mesh);
  const std::size_t last = sound.nodes.size() - 1;
  ASSERT_NE(sound.nodes[last].elongated_slots & 1, 0U);
  for (std::size_t k = 0; k < 2; ++k) {
    for (const bool is_low : {true, false}) {
      Tree tree = sound;
      bvh::SlabSides& sides = tree.nodes[last].sides;
      std::int16_t& steps = (is_low ? sides.low : sides.high)[k][0];
      steps = static_cast<std::int16_t>(steps + (is_low ? 3 : -3));
      const auto result = bvh::validate(tree, mesh);
      ASSERT_FALSE(static_cast<bool>(result)) << k;
      EXPECT_TRUE(result.error().text.starts_with("I4")) << result.error().text;
    }
  }
}

TEST(Tree, FitsSidesOfWhatIsElongated) {
  Rng rng(213);
  const Mesh mesh = rods(rng, 64);
  Model model(mesh, {.rebuild_policy = RebuildPolicy::off});
  const auto elongated_in = [](const Tree& tree) {
    int count = 0;
    for (const bvh::Node& node : tree.nodes) count += std::popcount(node.elongated_slots);
    return count;
  };
  const auto elongated_count = [&] { return elongated_in(tree_of(model)); };
  const int built = elongated_count();
  EXPECT_GT(built, 30);
  // Turned as a whole, rods stay rods: their sides turn with them.
  std::vector<Vec3> turned = mesh.positions();
  const Transform pose = random_pose(rng, 1);
  for (Vec3& p : turned) p = pose(p);
  model.move_all(turned).value();
  model.commit();
  ASSERT_TRUE(static_cast<bool>(model.validate()));
  EXPECT_GT(elongated_count(), built * 3 / 4);
  // As specks they are no rods any more, nor as rods again, until the tree is built anew.
  model.move_all(std::vector<Vec3>(turned.size())).value();
  model.commit();
  std::vector<Vec3> specks;
  for (std::size_t i = 0; i < turned.size(); ++i) specks.push_back(uniform_point(rng));
  model.move_all(specks).value();
  model.commit();
  ASSERT_TRUE(static_cast<bool>(model.validate()));
  EXPECT_LT(elongated_count(), built / 4);
  model.move_all(mesh.positions()).value();
  model.commit();
  ASSERT_TRUE(static_cast<bool>(model.validate()));
  EXPECT_LT(elongated_count(), built / 4);
  Tree fitted = tree_of(model);
  for (std::uint32_t node = fitted.first_lowest_node(); node-- > 0;) bvh::fit_upper_node(fitted, mesh, node);
  ASSERT_TRUE(static_cast<bool>(bvh::validate(fitted, mesh)));
  EXPECT_EQ(elongated_in(fitted), built);
}

TEST(Tree, ValidateCountsLevels) {
  // A leaf below two nodes where one is enough. Each node by itself is sound.
  const Mesh mesh = scenes::grid(2, 2, 0, 0, 1, 1);
  Tree tree = bvh::build(mesh);
  ASSERT_TRUE(static_cast<bool>(bvh::validate(tree, mesh)));
  tree.nodes.push_back(tree.nodes[0]);
  tree.nodes[0].first_child = 1;
  tree.level_begin = {0, 1, 2};
  const auto result = bvh::validate(tree, mesh);
  ASSERT_FALSE(static_cast<bool>(result));
  EXPECT_EQ(result.error().text.substr(0, 2), "I3") << result.error().text;
}

/// The nodes at each vertex, found without an index.
std::vector<std::set<std::uint32_t>> nodes_at_vertices(const bvh::Tree& tree, std::size_t vertex_count) {
  std::vector<std::set<std::uint32_t>> nodes(vertex_count);
  for (std::uint32_t n = tree.first_lowest_node(); n < tree.nodes.size(); ++n) {
    for (std::uint32_t k = 0; k < tree.nodes[n].child_count; ++k) {
      for (const auto& corners : tree.leaves[tree.nodes[n].first_child + k].vertices) {
        for (const VertexId v : corners) nodes[v].insert(n);
      }
    }
  }
  return nodes;
}

void expect_complete(const VertexIndex& index, const bvh::Tree& tree, std::size_t vertex_count) {
  ASSERT_TRUE(index.is_complete());
  const std::vector<std::set<std::uint32_t>> expected = nodes_at_vertices(tree, vertex_count);
  for (VertexId v = 0; v < vertex_count; ++v) {
    const auto found = index.nodes_at(v);
    ASSERT_EQ(found.size(), expected[v].size()) << v;
    ASSERT_TRUE(std::is_permutation(found.begin(), found.end(), expected[v].begin())) << v;
  }
}

TEST(VertexIndex, ListsTheLowestNodesAtEachVertexOnceHoweverSmallTheSteps) {
  for (const Mesh& mesh : {scenes::grid(1, 1, 0, 0, 1, 1), scenes::grid(60, 50, 0, 0, 1, 1), scenes::ball(32, 17),
                           scenes::shuffled_soup(3000).mesh}) {
    const bvh::Tree tree = bvh::build(mesh);
    const std::size_t vertices = mesh.positions().size();
    VertexIndex index;
    index.start(vertices);
    base::WorkBudget unlimited = base::WorkBudget::unlimited(), none(0);
    EXPECT_TRUE(index.build(tree, unlimited));
    expect_complete(index, tree, vertices);
    index.drop();
    EXPECT_FALSE(index.is_complete());
    index.reserve(vertices, mesh.triangles().size());
    index.start(vertices);
    EXPECT_FALSE(index.build(tree, none));
    EXPECT_EQ(none.spent_ns(), 0);
    std::size_t calls = 0;
    for (bool is_done = false; !is_done; ++calls) {
      ASSERT_FALSE(index.is_complete());
      base::WorkBudget least(1e-3);
      is_done = index.build(tree, least);
      ASSERT_LT(least.spent_ns(), 5000);  // one step
    }
    EXPECT_GT(calls, mesh.triangles().size() / 120);
    expect_complete(index, tree, vertices);
  }
}

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

/// Primitives in order along an axis, by sorting.
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
