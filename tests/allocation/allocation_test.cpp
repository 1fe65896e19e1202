// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries do not touch the heap, and in real time updates do not either: ticks make no system call but to read the
// clock, so they take no lock that may wait. What changes a scene does touch the heap, and each of its allocations
// fails once, alone or with all that follow: afterwards the scene is as before the call, and the same call works.
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <tuple>
#include <vector>

#include "heap.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/elements.h"
#include "limber/limber.h"
#include "limber/model.h"
#include "limber/points.h"
#include "limber/scene.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

std::array<Contact, 20> contacts_found;
std::array<VertexFacePair, 20> vertex_face_found;
std::array<EdgeEdgePair, 20> edge_edge_found;

/// One of each query at every separation, near, touching and overlapping included.
void ask_everything(const Model& square, const ClosedSurface& surface, QueryCache& cache) {
  const Model& ball = surface.model();
  for (const double separation : {8.0, 1.0, 0.01, 0.0, -0.5}) {
    const Placed a{square}, b{ball, scenes::ball_over_square(ball.mesh(), separation, 0)};
    static_cast<void>(distance(a, b));
    static_cast<void>(distance(a, b, {.relative_error = 0.1, .absolute_error = 0.01}));
    static_cast<void>(distance(a, b, {.max_distance = 0.5}));
    static_cast<void>(distance(a, b, {.cache = &cache}));
    static_cast<void>(collide(a, b));
    static_cast<void>(collide(a, b, {.cache = &cache}));
    static_cast<void>(within(a, b, 0.5));
    static_cast<void>(within(a, b, 0.5, {.cache = &cache}));
    const Vec3 point{0, separation, 1};
    static_cast<void>(closest_point(b, point));
    static_cast<void>(closest_point(b, 1e9 * point, {.max_distance = 0.5}));
    static_cast<void>(surface.contains(point, b.pose));
    static_cast<void>(surface.signed_distance(point, b.pose));
    intersections(a, b, {});
    contacts(a, b, 0.5, contacts_found);
    closest_pairs(a, b, contacts_found);
    closest_pairs(a, b, contacts_found, {.max_distance = 0.5, .budget = {.max_steps = 20}});
    element_pairs(a, b, 0.5, vertex_face_found, edge_edge_found);
    if (const auto near = distance(a, b); near.witness) static_cast<void>(contact_of(a, b, *near.witness));
  }
  static_cast<void>(self_collide(ball));
  static_cast<void>(self_distance(ball));
  self_intersections(ball, {});
  self_contacts(ball, 0.1, contacts_found);
  self_closest_pairs(ball, contacts_found);
  static_cast<void>(self_collide(ball, {.cache = &cache}));
  static_cast<void>(self_distance(ball, {.cache = &cache}));
  self_element_pairs(ball, 0.1, vertex_face_found, edge_edge_found);
}

/// The first call of a function may allocate, and those that follow do not.
template <typename Function>
void expect_none_after_the_first(int count, const Function& function) {
  function(0);
  const std::uint64_t before = allocation_count();
  for (int i = 1; i < count; ++i) function(i);
  EXPECT_EQ(allocation_count(), before);
}

TEST(Allocation, DoesNotHappenInMemoryOfFeaturePairs) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  FeaturePairs found, of_one;
  expect_none_after_the_first(5, [&](int step) {
    const Placed above{ball, scenes::ball_over_square(ball.mesh(), 0.1 * step, 0)};
    feature_pairs({square}, above, 0.5, found);
    self_feature_pairs(ball, 0.1, of_one);
  });
  EXPECT_GT(of_one.list().size(), 0U);
}

TEST(Allocation, IsSeenByThisTest) {
  const std::uint64_t before = allocation_count();
  const Model model(scenes::thesis_ball());
  EXPECT_GT(allocation_count(), before);
}

TEST(Allocation, DoesNotHappenInStepsOfMovingModels) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  MovingModel still(square), moving(ball);
  const Placed above{ball, scenes::ball_over_square(ball.mesh(), 0.5, 0)};
  std::vector<double> displacements(ball.mesh().positions().size());
  expect_none_after_the_first(5, [&](int step) {
    const double way = 0.1 * step;
    still.set_motion(square.mesh().positions()).value();
    moving.set_motion(ball.mesh().positions(), above.pose, above.pose * Transform{{}, {0, way, 0}}).value();
    static_cast<void>(time_of_impact(moving, still, {.budget = {.max_steps = 1000}}));
    static_cast<void>(self_time_of_impact(moving));
    visit_impact_candidates(moving, still, [](const ElementPair&) { return true; }, {.min_separation = 0.2});
    std::fill(displacements.begin(), displacements.end(), 1.0);
    limit_displacements(above, {square}, 0.01, displacements);
    limit_self_displacements(ball, 0, displacements);
  });
}

TEST(Allocation, HardlyHappensWhereSmallBodiesFlyPastEachOther) {
  const Shape crate = Shape::box({0.3, 0.5, 0.4}), bullet = Shape::sphere(0.02);
  scenes::Rng rng(17);
  std::size_t near = 0, allocating = 0;
  for (int i = 0; i < 300; ++i) {
    const std::uint64_t before = allocation_count();
    const Vec3 start{-3, rng.uniform(-1, 1), rng.uniform(-1, 1)}, end{3, rng.uniform(-1, 1), rng.uniform(-1, 1)};
    const PathImpact impact = time_of_impact(bullet, RigidMotion({{}, start}, {{}, end}), crate, {});
    near += impact.distance_count > 3 ? 1 : 0, allocating += allocation_count() > before ? 1 : 0;
  }
  EXPECT_GT(near, 100U);
  EXPECT_LT(allocating, 15U);  // those that pass so closely that shadows of both are worth it
}

TEST(Allocation, DoesNotHappenInQueriesWithABudget) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  QueryCache cache;
  expect_none_after_the_first(20, [&](int i) {
    const Placed a{square}, b{ball, {{}, {0.01 * i, 0, 3}}};
    const QueryBudget steps{.max_steps = 10};
    const QueryBudget time{.deadline = std::chrono::steady_clock::now() + std::chrono::microseconds(5)};
    for (const QueryBudget& budget : {steps, time}) {
      static_cast<void>(distance(a, b, {.cache = &cache, .budget = budget}));
      static_cast<void>(distance(a, b, {.budget = budget}));
      static_cast<void>(collide(a, b, {.cache = &cache, .budget = budget}));
      static_cast<void>(within(a, b, 1, {.cache = &cache, .budget = budget}));
    }
  });
}

TEST(Allocation, DoesNotHappenInReductionsInMemoryThatHasGrown) {
  const Model ball(scenes::thesis_ball());
  std::vector<Contact> contacts(100'000);
  ReductionMemory memory;
  constexpr std::array gaps{0.0, 0.2, 0.0, 0.1};  // the first has the most contacts
  expect_none_after_the_first(gaps.size(), [&](int i) {
    const Transform there{{}, {2 + gaps[static_cast<std::size_t>(i)], 0, 0}};
    const std::size_t count = limber::contacts({ball}, {ball, there}, 0.3, contacts).count;
    EXPECT_GT(reduce_contacts(std::span(contacts).first(count), 0.1, {.memory = &memory}), 2U);
  });
}

TEST(Allocation, DoesNotHappenInFramesOfAScene) {
  const Model ball(scenes::thesis_ball());
  Scene scene;
  std::array<ObjectId, 200> ids;
  for (ObjectId& id : ids) id = scene.add({ball});
  std::array<ObjectPair, 1000> pairs;
  scenes::Rng rng(11);
  std::size_t found = 0;
  expect_none_after_the_first(20, [&](int /*frame*/) {
    for (const ObjectId id : ids) {
      scene.set_pose(id, {scenes::random_rotation(rng), {rng.uniform(0, 8), rng.uniform(0, 8), rng.uniform(0, 8)}});
    }
    scene.commit();
    const auto counts = [](ObjectId a, ObjectId b) { return a % 2 != b % 2; };
    found += scene.candidate_pairs(0.1, pairs, counts).count;
    scene.remove(ids[7]);
    ids[7] = scene.add({ball});
  });
  EXPECT_GT(found, 1000U);
}

/// A sheet of which twenty vertices move in each tick, and how far a ball is from it.
class RealTimeSheet {
 public:
  void tick() {
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      ids_[i] = static_cast<VertexId>(rng_.below(model_.mesh().positions().size()));
      positions_[i] = model_.mesh().positions()[ids_[i]] + Vec3{0, 0, rng_.uniform(-0.5, 0.5)};
    }
    model_.move_vertices(ids_, positions_).value();
    model_.commit();
    const QueryBudget time{.deadline = std::chrono::steady_clock::now() + std::chrono::microseconds(20)};
    const QueryBudget steps{.max_steps = 20};
    static_cast<void>(distance({model_}, {ball_, {{}, {32, 32, 30}}}, {.cache = &cache_, .budget = steps}));
    static_cast<void>(distance({model_}, {ball_, {{}, {32, 32, 1.7}}}, {.cache = &cache_, .budget = time}));
  }
  std::uint64_t rebuilt_triangles() const { return model_.maintenance_stats().rebuilt_triangles; }

 private:
  Model model_{scenes::grid(64, 64, 0, 0, 1, 1), ModelOptions::real_time(20)}, ball_{scenes::thesis_ball()};
  QueryCache cache_;
  scenes::Rng rng_{9};
  std::array<VertexId, 20> ids_;
  std::array<Vec3, 20> positions_;
};

TEST(Allocation, DoesNotHappenInRealTime) {
#ifdef LIMBER_CHECKS
  GTEST_SKIP() << "commits of this build validate the tree, which allocates";
#endif
  RealTimeSheet sheet;
  expect_none_after_the_first(5000, [&](int /*frame*/) { sheet.tick(); });
  EXPECT_GT(sheet.rebuilt_triangles(), 20'000U);
}

constexpr int cannot_filter = 77;

/// From now on, any system call but those to read the clock and to exit ends the process with the signal SIGSYS.
bool allow_only_the_clock() {
  std::array filter = {sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                       sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_clock_gettime, 1, 0),
                       sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_exit_group, 0, 1),
                       sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
                       sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS)};
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

/// How a child process ends that works under the filter, as waitpid() says it.
template <typename Work>
int end_of_filtered(const Work& work) {
  const pid_t child = fork();
  if (child == 0) {
    if (!allow_only_the_clock()) _exit(cannot_filter);
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(SystemCalls, AreNotMadeInRealTimeButToReadTheClock) {
#if defined(LIMBER_CHECKS) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "checks of commits allocate, and sanitizers make system calls of their own";
#endif
  RealTimeSheet sheet;
  sheet.tick();
  const int end = end_of_filtered([&] {
    for (int i = 0; i < 2000; ++i) sheet.tick();
  });
  if (WIFEXITED(end) && WEXITSTATUS(end) == cannot_filter) GTEST_SKIP() << "this kernel has no seccomp filters";
  EXPECT_TRUE(WIFEXITED(end) && WEXITSTATUS(end) == 0) << "ended by signal " << WTERMSIG(end);
  const int of_another = end_of_filtered([] { syscall(__NR_getpid); });
  EXPECT_TRUE(WIFSIGNALED(of_another) && WTERMSIG(of_another) == SIGSYS);
}

// FCL #38: each query copies the mesh and moves every vertex. SOFA #5: memory leaks while bodies are in contact.
// trimesh #806: memory of searches is never given back.
TEST(Allocation, DoesNotHappenInAWarmQuery) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  const ClosedSurface surface = ClosedSurface::create(ball).value();
  QueryCache cache;
  expect_none_after_the_first(2, [&](int /*round*/) { ask_everything(square, surface, cache); });
}

auto state_of_scene(const limber::Scene& scene) {
  std::vector<bool> contains;
  for (ObjectId id = 0; id <= scene.id_bound(); ++id) contains.push_back(scene.contains(id));
  return std::tuple(scene.size(), scene.id_bound(), scene.is_committed(), contains);
}

/// Calls on a heap whose allocation `k`, counted over all calls, fails. Calls that throw are made again.
class FailingCalls {
 public:
  FailingCalls(std::int64_t k, Failing failing) : k_(k), failing_(failing) {}

  template <typename Call>
  void operator()(const limber::Scene& scene, const Call& call) {
    const auto before = state_of_scene(scene);
    bool threw = false;
    {
      const FailingHeap heap(k_, failing_);
      const std::uint64_t count = allocation_count();
      try {
        call();
      } catch (const std::bad_alloc&) {
        threw = true;
      }
      has_failed_ = has_failed_ || heap.has_failed();
      k_ -= static_cast<std::int64_t>(allocation_count() - count);
      if (heap.has_failed()) k_ = 1'000'000;
    }
    if (!threw) return;
    ASSERT_EQ(state_of_scene(scene), before);
    call();
  }
  bool has_failed() const { return has_failed_; }

 private:
  std::int64_t k_;
  Failing failing_;
  bool has_failed_ = false;
};

/// Builds a scene, changes it and asks it, and checks the answers. Returns whether an allocation has failed.
bool play_scene(const Model& ball, std::int64_t k, Failing failing) {
  FailingCalls failing_call(k, failing);
  limber::Scene scene;
  std::vector<ObjectPair> pairs(100);
  std::vector<DistanceResult> distances;
  SceneCache cache(2);
  for (ObjectId i = 0; i < 12; ++i) {
    failing_call(scene, [&] { EXPECT_EQ(scene.add({ball, {{}, {1.5 * i, 0, 0}}}), i); });
  }
  for (int frame = 0; frame < 2; ++frame) {
    failing_call(scene, [&] { scene.remove(5); });
    failing_call(scene, [&] { scene.commit(); });
    failing_call(scene, [&] { EXPECT_EQ(scene.candidate_pairs(0.1, pairs).count, 9U); });
    failing_call(scene, [&] { EXPECT_EQ(scene.add({ball, {{}, {7.5, 0, 0}}}), 5U); });
    failing_call(scene, [&] { scene.commit(); });
    const std::size_t count = scene.candidate_pairs(0.1, pairs).count;
    EXPECT_EQ(count, 11U);
    distances.assign(count, {});
    failing_call(scene, [&] { scene.distance(std::span(pairs).first(count), distances, {.cache = &cache}); });
    for (const DistanceResult& d : distances) EXPECT_EQ(d.upper, 0);
    ClosestObjectsResult closest;
    const auto are_not_next = [](ObjectId a, ObjectId b) { return b != a + 1; };
    failing_call(scene, [&] { closest = scene.closest_objects({.filter = are_not_next, .cache = &cache}); });
    EXPECT_NEAR(closest.result.upper, 1, 0.1);
    const std::vector<ObjectId> ids{5};
    const std::vector<Transform> poses(17, {{}, {1.5 * 5, 0, 3}});
    std::vector<ClosestObjectsResult> results(poses.size());
    failing_call(scene, [&] { scene.closest_objects_many(ids, poses, results, {.filter = are_not_next}); });
    EXPECT_NEAR(results[16].result.upper, 1, 0.1);
    ObjectContacts contacts;
    failing_call(scene, [&] { scene.contacts(std::span(pairs).first(count), 0, contacts); });
    EXPECT_TRUE(contacts.offsets.size() == count + 1 && contacts.offsets[count] >= count);
  }
  return failing_call.has_failed();
}

TEST(FailingHeap, LeavesASceneAsItWas) {
  const Model ball(scenes::ball(8, 6));
  for (const Failing failing : {Failing::once, Failing::always}) {
    std::int64_t k = 0;
    while (play_scene(ball, k, failing) && !HasFailure()) ++k;
    EXPECT_GT(k, 30);
  }
}

}  // namespace
}  // namespace limber::testing
