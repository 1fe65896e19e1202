// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Answers that depended on the processor, on threads or on chance, questions that never got one, and work without need,
// in counts that do not depend on the machine.
#include <oneapi/tbb/task_arena.h>

#include <bit>

#include "limber/points.h"
#include "limber/scene.h"
#include "peers.h"
#include "scenes/scenes.h"
#include "simd/kernels.h"

namespace limber::testing {
namespace {

// Embree #51, #596, #149, Drake PR #14594, #14768: results differ between instruction sets, and tests with them.
// Embree #520, CloudCompare #2247, Charm++ #3067: one question gets several answers. Embree #20: building on many
// threads gives triangles other names in every run.
TEST(Determinism, AllInstructionSetsAndAnyNumberOfThreadsGiveOneResultToTheBit) {
  std::vector<std::uint64_t> results;
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::use_kernels(&set);
    results.push_back(total(scenes::answer_hashes(1)));
  }
  simd::use_kernels(nullptr);
  for (const int threads : {1, 2, 8, 8}) {
    oneapi::tbb::task_arena(threads).execute([&] { results.push_back(total(scenes::answer_hashes(1))); });
  }
  for (const std::uint64_t result : results) EXPECT_EQ(result, results.front());
}

// avian #1030: answers differ between processor architectures. The number is that of this scene on all of them.
TEST(Determinism, DistancesHaveTheBitsThatAreWrittenHere) {
  const Model a(scenes::ring(24, 12, 0.3)), b(scenes::ball(20, 12));
  std::uint64_t bits = 0xcbf29ce484222325;  // FNV-1a
  const auto add = [&](double value) { bits = (bits ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3; };
  scenes::Rng rng(1030);
  for (int i = 0; i < 50; ++i) {
    const Transform pose = random_pose(rng, 3);
    add(distance({a}, {b, pose}).upper);
    add(closest_point({b, pose}, random_point(rng, 2)).closest->distance);
  }
  EXPECT_EQ(bits, 0xe160890c52257049U);
}

// Warp #1258: two queries in one kernel overwrite each other's stack. A query is asked in the middle of another one,
// about the models that this one is about.
TEST(Determinism, AQuestionMayBeAskedInTheMiddleOfAnother) {
  const Model ring(scenes::ring(24, 12, 0.3)), ball(scenes::ball(16, 10));
  const Placed a{ring}, b{ball, at(0.9, 0.1, 0.4)};
  const std::size_t alone = contacts(a, b, 0.1, {}).count;
  const double truth = distance(a, b).upper, other = distance(a, {ball, at(3)}).upper;
  std::vector<TrianglePair> plain, nested;
  visit_intersections(a, b, [&](const TrianglePair& p) {
    plain.push_back(p);
    return true;
  });
  visit_intersections(a, b, [&](const TrianglePair& p) {
    nested.push_back(p);
    EXPECT_EQ(distance(a, b).upper, truth);
    EXPECT_EQ(distance(a, {ball, at(3)}).upper, other);
    std::size_t inner = 0;
    visit_contacts(a, b, 0.1, [&](const Contact&) {
      inner += 1;
      if (inner == 1) {
        EXPECT_EQ(contacts(a, b, 0.1, {}).count, alone);
      }
      return true;
    });
    EXPECT_EQ(inner, alone);
    return true;
  });
  EXPECT_GT(plain.size(), 10U);
  EXPECT_EQ(nested, plain);
}

// SOFA #2651, #571: at a distance of 0 a message is missing, or comes without end while the scene hangs.
TEST(Determinism, ZeroDistanceIsAnOrdinaryAnswerThatComesSoon) {
  const Model cube(box({1, 1, 1})), floor(scenes::grid(40, 40, -4, -4, 0.2, 0.2));
  for (const Vec3& place : {Vec3{0.3, 0.2, 1}, Vec3{0, 0, 1}, Vec3{0, 0, 0}, Vec3{4, 4, 1}, Vec3{5, 5, 1}}) {
    const Placed a{floor}, b{cube, {{}, place}};
    ASSERT_EQ(agreed_distance(a, b, 1e-15), 0);
    const DistanceResult found = distance(a, b);
    EXPECT_EQ(found.status, DistanceStatus::collision);
    EXPECT_LT(found.stats.node_tests + found.stats.primitive_tests, 2000U);
    for (const Contact& c : all_contacts(a, b, 0)) {
      EXPECT_NEAR(length(c.normal), 1, 1e-15);
      EXPECT_TRUE(is_finite(c));
    }
  }
  // Two adjacent edges of one line, which make the determinant of their equations vanish: SOFA #2077.
  const ClosestPoints line = closest_points(Segment{{0, 0, 0}, {1, 0, 0}}, Segment{{1, 0, 0}, {2, 0, 0}});
  EXPECT_EQ(line.distance, 0);
  EXPECT_EQ(line.point_a, (Vec3{1, 0, 0}));
}

std::uint64_t steps(const QueryStats& stats) { return stats.node_tests + stats.primitive_tests; }

// FCL #276: a distance costs ten to a hundred times as much as a collision. It takes fewer steps than a body has
// triangles, and fewer yet where a rough one will do.
TEST(Effort, OfADistanceIsBelowTheNumberOfTriangles) {
  scenes::Rng rng(276);
  const Model a(scenes::ring(60, 30, 0.3)), b(scenes::ball(48, 32));
  const int poses = 60;
  std::uint64_t exactly = 0, roughly = 0;
  for (int i = 0; i < poses; ++i) {
    const Placed there{b, random_pose(rng, 3)};
    exactly += steps(distance({a}, there).stats);
    roughly += steps(distance({a}, there, {.relative_error = 0.1}).stats);
  }
  EXPECT_LT(exactly / poses, a.mesh().triangles().size());
  EXPECT_LT(roughly, exactly);
}

// Drake #15080, PR #15221: contact of a body that deforms compares all pairs, because trees are made for rigid meshes.
TEST(Effort, ContactsOfABodyThatDeformsNeedNoPassOverAllPairs) {
  const Mesh rest = scenes::ball(24, 16);
  Model body(rest);
  const Model floor(scenes::grid(20, 20, -2, -2, 0.2, 0.2));
  const std::size_t all_pairs = rest.triangles().size() * floor.mesh().triangles().size();
  for (int frame = 1; frame <= 5; ++frame) {
    std::vector<Vec3> positions = rest.positions();
    for (Vec3& p : positions) p.x += 0.08 * frame * p.y * p.z, p.z *= 1 + 0.08 * frame;
    body.move_all(positions).value();
    body.commit();
    const Placed there{body, at(0, 0, 0.9)};
    const PairCount found = contacts({floor}, there, 0.001, {});
    EXPECT_EQ(found.count, reference::contacts(in_reference({floor}), in_reference(there), 0.001).size());
    EXPECT_LT(steps(found.stats), all_pairs / 100) << frame;
  }
}

// PhysX (Omniverse) #399: whether bodies are closer than a tolerance is asked by listing all pairs that are, which is
// slow.
TEST(Effort, AThresholdIsCheaperThanTheListOfPairsBelowIt) {
  const Model a(scenes::ball(48, 32));
  const Placed there{a, at(1.99, 0.05, 0.02)};
  const CollideResult near = within({a}, there, 0.3);
  const PairCount listed = contacts({a}, there, 0.3, {});
  EXPECT_TRUE(near.is_yes());
  EXPECT_GT(listed.count, 1000U);
  EXPECT_LT(steps(near.stats), 200U);
  EXPECT_LT(20 * steps(near.stats), steps(listed.stats));
}

}  // namespace
}  // namespace limber::testing
