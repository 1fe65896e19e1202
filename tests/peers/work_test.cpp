// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Work that other libraries do without need, in counts that do not depend on the machine, and questions from many
// threads at a time, which they forbid, race in, or do not speak about. The table of all cases is docs/peers.md.
#include <atomic>
#include <thread>

#include "bodies.h"
#include "limber/points.h"
#include "limber/scene.h"

namespace limber::testing {
namespace {

std::uint64_t steps(const QueryStats& stats) { return stats.node_tests + stats.triangle_tests; }

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
    const Transform there = at(0, 0, 0.9);
    const PairCount found = contacts({floor}, {body, there}, 0.001, {});
    EXPECT_EQ(found.count, reference::contacts({floor.mesh()}, {body.mesh(), there}, 0.001).size());
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

/// What a function returns on each of some threads for its number. They start at one moment as far as possible.
template <typename Body>
std::vector<double> on_threads(std::size_t count, const Body& body) {
  std::atomic<std::size_t> waiting = count;
  std::vector<double> results(count);
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < count; ++i) {
    threads.emplace_back([&, i] {
      --waiting;
      while (waiting > 0) std::this_thread::yield();
      results[i] = body(i);
    });
  }
  threads.clear();
  return results;
}

/// All answers about one pose, as one number.
double answers(const Placed& a, const Placed& b) {
  const DistanceResult d = distance(a, b);
  const SurfacePoint p = closest_point(a, b.pose.translation).closest.value();
  return d.upper + 3 * d.witness->point_a.x + 5 * d.witness->triangle_b + 7 * p.distance + 11.0 * p.triangle +
         13.0 * static_cast<double>(contacts(a, b, 0.1, {}).count) + (collide(a, b).is_yes() ? 17 : 0) +
         19.0 * static_cast<double>(self_intersections(a.model(), {}).count);
}

// FCL #224, Drake #10258, Bullet #258: nobody says whether queries are safe on many threads. Coal #870: those of one
// tree are not. CGAL PR #3240, PR #4675, ResInsight PR #14184: the first query builds a tree, and others read it while
// it does.
TEST(Threads, MayAskAboutOneModelFromItsFirstQueryOn) {
  const Mesh mesh = scenes::ring(32, 16, 0.3);
  for (int round = 0; round < 25; ++round) {
    scenes::Rng rng(static_cast<std::uint64_t>(round));
    const Transform pose = random_pose(rng, 1.5);
    Model ring(mesh);
    if (round % 2 == 1) {  // what a commit has left to do would show up now
      std::vector<Vec3> positions = mesh.positions();
      for (Vec3& p : positions) p += 0.01 * uniform_point(rng);
      ring.move_all(positions).value();
      ring.commit();
    }
    const std::vector<double> found = on_threads(4, [&](std::size_t) { return answers({ring}, {ring, pose}); });
    for (const double each : found) EXPECT_EQ(each, found.front()) << round;
    const Model alone(ring.mesh());
    EXPECT_NEAR(distance({ring}, {ring, pose}).upper, distance({alone}, {alone, pose}).upper, 1e-13);
  }
}

// Bullet #59: two worlds share globals and crash. OpenMW PR #2070, Godot PR #53183: without a build flag, threads get
// false answers and crashes.
TEST(Threads, MayDeformAndAskAboutModelsOfTheirOwn) {
  const Mesh rest = scenes::ball(16, 10);
  const auto life_of = [&](std::size_t seed) {
    scenes::Rng rng(seed);
    Model body(rest);
    const Model other(box({0.5, 0.5, 0.5}));
    limber::Scene scene;
    scene.add({body}), scene.add({other, at(1.2)});
    double sum = 0;
    for (int frame = 0; frame < 15; ++frame) {
      std::vector<Vec3> positions = rest.positions();
      for (Vec3& p : positions) p += 0.1 * uniform_point(rng);
      body.move_all(positions).value();
      body.commit();
      scene.commit();
      sum += answers({body}, {other, at(1.2)}) + scene.closest_objects().result.upper;
    }
    return sum;
  };
  const std::vector<double> together = on_threads(4, life_of);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(together[i], life_of(i)) << i;
}

// Warp #1258: two queries in one kernel overwrite each other's stack. A query is asked in the middle of another one,
// about the models that this one is about.
TEST(Threads, OneMayAskAQuestionInTheMiddleOfAnother) {
  const Model ring(scenes::ring(24, 12, 0.3)), ball(scenes::ball(16, 10));
  const Placed a{ring}, b{ball, at(0.9, 0.1, 0.4)};
  const std::size_t alone = contacts(a, b, 0.1, {}).count;
  const double truth = distance(a, b).upper, other = distance(a, {ball, at(3)}).upper;
  std::vector<TrianglePair> plain(intersections(a, b, {}).count), nested;
  intersections(a, b, plain);
  visit_intersections(a, b, [&](const TrianglePair& p) {
    nested.push_back(p);
    EXPECT_EQ(distance(a, b).upper, truth);
    EXPECT_EQ(distance(a, {ball, at(3)}).upper, other);
    std::size_t inner = 0;
    visit_contacts(a, b, 0.1, [&](const Contact&) {
      if (inner++ == 0) {
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

}  // namespace
}  // namespace limber::testing
