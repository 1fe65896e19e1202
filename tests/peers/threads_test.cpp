// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Questions from many threads at a time, which other libraries forbid, race in, or do not speak about.
#include <atomic>
#include <thread>

#include "limber/points.h"
#include "limber/scene.h"
#include "peers.h"

namespace limber::testing {
namespace {

/// Starts threads that call a function with their number, at one moment as far as possible.
template <typename Body>
void on_threads(int count, const Body& body) {
  std::atomic<int> waiting = count;
  std::vector<std::thread> threads;
  for (int i = 0; i < count; ++i) {
    threads.emplace_back([&, i] {
      --waiting;
      while (waiting > 0) std::this_thread::yield();
      body(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
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
      for (Vec3& p : positions) p += 0.01 * random_point(rng, 1);
      ring.move_all(positions).value();
      ring.commit();
    }
    std::vector<double> found(4);
    on_threads(4, [&](int i) { found[static_cast<std::size_t>(i)] = answers({ring}, {ring, pose}); });
    const Model alone(ring.mesh());
    const double truth = distance({alone}, {alone, pose}).upper;
    for (const double each : found) EXPECT_EQ(each, found.front()) << round;
    EXPECT_NEAR(distance({ring}, {ring, pose}).upper, truth, 1e-13);
  }
}

// Bullet #59: two worlds share globals and crash. OpenMW PR #2070, Godot PR #53183: without a build flag, threads get
// false answers and crashes.
TEST(Threads, MayDeformAndAskAboutModelsOfTheirOwn) {
  const Mesh rest = scenes::ball(16, 10);
  const auto life_of = [&](int seed) {
    scenes::Rng rng(static_cast<std::uint64_t>(seed));
    Model body(rest);
    const Model other(box({0.5, 0.5, 0.5}));
    limber::Scene scene;
    static_cast<void>(scene.add({body})), static_cast<void>(scene.add({other, at(1.2)}));
    double sum = 0;
    for (int frame = 0; frame < 15; ++frame) {
      std::vector<Vec3> positions = rest.positions();
      for (Vec3& p : positions) p += 0.1 * random_point(rng, 1);
      body.move_all(positions).value();
      body.commit();
      scene.commit();
      const ClosestObjectsResult closest = scene.closest_objects();
      sum += answers({body}, {other, at(1.2)}) + closest.result.upper;
    }
    return sum;
  };
  std::vector<double> together(4);
  on_threads(4, [&](int i) { together[static_cast<std::size_t>(i)] = life_of(i); });
  for (int i = 0; i < 4; ++i) EXPECT_EQ(together[static_cast<std::size_t>(i)], life_of(i)) << i;
}

// Warp #1258: two queries in one kernel overwrite each other's stack. A query is asked in the middle of another one,
// about the models that this one is about.
TEST(Threads, OneMayAskAQuestionInTheMiddleOfAnother) {
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

}  // namespace
}  // namespace limber::testing
