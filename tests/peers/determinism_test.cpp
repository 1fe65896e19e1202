// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Answers that depended on the processor, on threads or on chance, and questions that never got one.
#include <oneapi/tbb/task_arena.h>

#include <bit>
#include <functional>

#include "limber/points.h"
#include "limber/scene.h"
#include "peers.h"
#include "simd/kernels.h"

namespace limber::testing {
namespace {

/// FNV-1a of whatever is answered.
class Bits {
 public:
  void add(std::uint64_t value) { hash_ = (hash_ ^ value) * 0x100000001b3; }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// Bits of all answers about some poses of two models: distances, points, names, and lists in their order.
std::uint64_t bits_of_answers(const Model& a, const Model& b) {
  Bits bits;
  scenes::Rng rng(51);
  for (int i = 0; i < 12; ++i) {
    const Placed there{b, random_pose(rng, 1.6)};
    const DistanceResult d = distance({a}, there);
    bits.add(d.upper), bits.add(d.witness->point_a), bits.add(d.witness->point_b);
    bits.add(std::uint64_t{d.witness->triangle_a}), bits.add(std::uint64_t{d.witness->triangle_b});
    const DistanceResult rough = distance({a}, there, {.relative_error = 0.2});
    bits.add(rough.lower), bits.add(rough.upper);
    for (const Contact& c : all_contacts({a}, there, 0.05)) {
      bits.add(c.distance), bits.add(c.depth), bits.add(c.normal), bits.add(c.point_a);
      bits.add(std::uint64_t{c.triangle_a}), bits.add(std::uint64_t{c.triangle_b});
    }
    const SurfacePoint p = closest_point({a}, there.pose.translation).closest.value();
    bits.add(p.position), bits.add(p.distance), bits.add(std::uint64_t{p.triangle});
  }
  return bits.value();
}

// Embree #51, #596, #149, Drake PR #14594, #14768: results differ between instruction sets, and tests with them.
TEST(Determinism, AllInstructionSetsGiveOneResultToTheBit) {
  const Mesh ring = scenes::ring(24, 12, 0.3), ball = scenes::ball(20, 12);
  std::vector<std::uint64_t> results;
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::use_kernels(&set);
    Model a(ring);
    const Model b(ball);
    results.push_back(bits_of_answers(a, b));
    std::vector<Vec3> positions = ring.positions();
    for (Vec3& p : positions) p.z += 0.2 * p.x * p.y;
    a.move_all(positions).value();
    a.commit();
    results.back() ^= 3 * bits_of_answers(a, b);
  }
  simd::use_kernels(nullptr);
  for (const std::uint64_t result : results) EXPECT_EQ(result, results.front());
}

// avian #1030: answers differ between processor architectures. The number is that of this scene on all of them.
TEST(Determinism, DistancesHaveTheBitsThatAreWrittenHere) {
  const Model a(scenes::ring(24, 12, 0.3)), b(scenes::ball(20, 12));
  Bits bits;
  scenes::Rng rng(1030);
  for (int i = 0; i < 50; ++i) {
    const Transform pose = random_pose(rng, 3);
    bits.add(distance({a}, {b, pose}).upper);
    bits.add(closest_point({b, pose}, random_point(rng, 2)).closest->distance);
  }
  EXPECT_EQ(bits.value(), 0xe160890c52257049U);
}

// Embree #423: an edge far from a triangle hits it, with all instruction sets but AVX2.
TEST(Determinism, NoInstructionSetSeesAnEdgeHitATriangleThatItMisses) {
  scenes::Rng rng(423);
  std::size_t hits = 0, misses = 0;
  for (int i = 0; i < 800; ++i) {
    const Triangle t{random_point(rng, 1.5), random_point(rng, 1.5), random_point(rng, 1.5)};
    // The edge passes by a corner, beyond it or short of it, or ends next to the plane.
    const double off = std::pow(10.0, rng.uniform(-17, -1)) * (i % 2 == 0 ? 1 : -1);
    const Vec3 inward = 0.5 * (t.v1 + t.v2) - t.v0, along = random_point(rng, 1);
    const Vec3 by = t.v0 + off * inward;
    const Segment edge = i % 3 == 0 ? Segment{by, by + 2.0 * along} : Segment{by - along, by + along};
    const Triangle edge_triangle{edge.p0, edge.p1, edge.p1};
    const bool truth = exact::squared_distance(t, edge_triangle) == 0;
    (truth ? hits : misses) += 1;
    const Model a(triangles_of({t})), b(triangles_of({edge_triangle}));
    ASSERT_EQ(intersects(edge, t), truth) << i;
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::use_kernels(&set);
      EXPECT_EQ(collide({a}, {b}).is_yes(), truth) << i << ' ' << set.name;
      EXPECT_EQ(distance({a}, {b}).upper == 0, truth) << i << ' ' << set.name;
    }
    simd::use_kernels(nullptr);
  }
  EXPECT_GT(hits, 100U);
  EXPECT_GT(misses, 100U);
}

// Embree #520, CloudCompare #2247, Charm++ #3067: one question gets several answers. Embree #20: building on many
// threads gives triangles other names in every run.
TEST(Determinism, AnswersDoNotDependOnThreadsOrOnWhatWasAskedBefore) {
  const Mesh ring = scenes::ring(80, 40, 0.3), ball = scenes::ball(40, 30);
  std::vector<std::uint64_t> results;
  for (const int threads : {1, 2, 3, 8}) {
    oneapi::tbb::task_arena arena(threads);
    arena.execute([&] {
      const Model a(ring), b(ball);
      results.push_back(bits_of_answers(a, b));
      results.push_back(bits_of_answers(a, b));
    });
  }
  for (const std::uint64_t result : results) EXPECT_EQ(result, results.front());
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

}  // namespace
}  // namespace limber::testing
