// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Every allocation of every function of a model fails once, alone or with all that follow. Afterwards the model is as
// before the call or as after it, the same call works, and all later answers are right.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "heap.h"
#include "limber/limber.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"
#include "support/brute_force.h"

namespace limber::testing {
namespace {

using scenes::Rng;

/// How much distances may differ in these tests, where they are about 1 to 10.
constexpr double tolerance = 1e-14 * 16;

Mesh some_mesh() { return scenes::wave_sheet(10, 10, 0); }

std::vector<Vec3> shaken(const std::vector<Vec3>& positions, double amplitude, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Vec3> result = positions;
  for (Vec3& p : result) {
    const double x = rng.uniform(-amplitude, amplitude), y = rng.uniform(-amplitude, amplitude),
                 z = rng.uniform(-amplitude, amplitude);
    p += Vec3{x, y, z};
  }
  return result;
}

/// A few triangles at the center of a model and above it.
const Model& probe() {
  static const Model model(
      Mesh::create({{0, 0, 0.3}, {0.1, 0, 2}, {0, 0.1, 2}, {0.4, 0.4, -1}, {0.5, 0.4, 1}, {0.4, 0.5, 1}},
                   {{0, 1, 2}, {3, 4, 5}})
          .value());
  return model;
}

void expect_right_answers(const Model& model) {
  const Result<void> valid = model.validate();
  ASSERT_TRUE(static_cast<bool>(valid)) << valid.error().text;
  ASSERT_TRUE(model.is_committed());
  for (const Vec3& offset : {Vec3{}, Vec3{1, -1, 4}}) {
    const Transform pose{{}, offset};
    const Placed a{model}, b{probe(), pose};
    const double truth = brute_force_distance({model.mesh()}, {probe().mesh(), pose});
    ASSERT_NEAR(distance(a, b).upper, truth, tolerance);
    ASSERT_EQ(collide(a, b).is_yes(), truth == 0);
  }
}

/// Whether `call` threw std::bad_alloc. Anything else fails the test.
template <typename Call>
bool throws_bad_alloc(const Call& call) {
  try {
    call();
  } catch (const std::bad_alloc&) {
    return true;
  }
  return false;
}

/// Runs `call` with each of its allocations failing once, and `check` after each run that threw. Returns how many
/// allocations there are.
template <typename Call, typename Check>
int fail_each(const Call& call, const Check& check) {
  for (int k = 0;; ++k) {
    bool threw = false, failed = false;
    {
      const FailingHeap heap(k, Failing::once);
      threw = throws_bad_alloc(call);
      failed = heap.has_failed();
    }
    EXPECT_EQ(threw, failed) << k;
    if (!failed) return k;
    check();
  }
}

/// A call on a model, after some preparation.
struct Step {
  std::string name;
  std::function<void(Model&)> prepare;
  std::function<void(Model&)> call;
};

/// The state of a model that a caller can see without a query.
struct VisibleState {
  std::vector<Vec3> positions;
  std::size_t triangle_count;
  std::uint64_t moved_vertices;
  double motion_margin;
  bool is_committed;

  explicit VisibleState(const Model& model)
      : positions(model.mesh().positions()),
        triangle_count(model.mesh().triangles().size()),
        moved_vertices(model.maintenance_stats().moved_vertices),
        motion_margin(model.options().motion_margin),
        is_committed(model.is_committed()) {}
  bool operator==(const VisibleState&) const = default;
};

/// Uses a model as usual, and checks its answers.
void use(Model& model) {
  model.commit();
  expect_right_answers(model);
  const std::vector<Vec3>& positions = model.mesh().positions();
  for (const VertexId v : {VertexId{20}, VertexId{100}}) {
    const std::vector<Vec3> to{positions[v] + Vec3{0.2, -0.1, 0.7}};
    ASSERT_TRUE(static_cast<bool>(model.move_vertices(std::vector<VertexId>{v}, to)));
    model.commit();
    expect_right_answers(model);
  }
  ASSERT_TRUE(static_cast<bool>(model.move_all(shaken(positions, 0.3, 5))));
  model.commit();
  expect_right_answers(model);
}

/// Fails each allocation of a step in two runs; in the first of them the step is tried again. Returns the number of
/// allocations.
int fail_each_allocation(const Step& step, const ModelOptions& options, Failing failing) {
  for (int i = 0;; ++i) {
    const int k = i / 2;
    const bool tries_again = i % 2 == 0;
    Model model(some_mesh(), options);
    step.prepare(model);
    const VisibleState before(model);
    bool threw = false, failed = false;
    {
      const FailingHeap heap(k, failing);
      threw = throws_bad_alloc([&] { step.call(model); });
      failed = heap.has_failed();
    }
    if (threw) {
      EXPECT_TRUE(VisibleState(model) == before) << k;
      if (tries_again) step.call(model);
    }
    Model untroubled(some_mesh(), options);
    step.prepare(untroubled);
    if (!threw || tries_again) step.call(untroubled);
    EXPECT_TRUE(VisibleState(model) == VisibleState(untroubled)) << k;
    use(model);
    if (!failed || ::testing::Test::HasFailure()) return k;
  }
}

const std::vector<VertexId> few{30, 31, 90};

void move_few(Model& model) {
  const std::vector<Vec3> to{{1, 1, 0.5}, {1, -1, 0.75}, {-0.5, 0.25, 1}};
  ASSERT_TRUE(static_cast<bool>(model.move_vertices(few, to)));
}
void move_all(Model& model) {
  ASSERT_TRUE(static_cast<bool>(model.move_all(shaken(model.mesh().positions(), 0.5, 6))));
}
void commit(Model& model) { model.commit(); }
void nothing(Model&) {}

template <typename... Calls>
auto in_turn(Calls... calls) {
  return [=](auto& model) { (calls(model), ...); };
}

/// Moves each vertex to the position of its neighbour.
void move_to_own_positions(Model& model) {
  const std::vector<Vec3>& own = model.mesh().positions();
  std::vector<VertexId> ids;
  for (VertexId v = 1; v < 20; ++v) ids.push_back(v);
  ASSERT_TRUE(static_cast<bool>(model.move_vertices(ids, std::span(own).first(ids.size()))));
}

void be_rejected(Model& model) {
  ASSERT_FALSE(static_cast<bool>(model.move_vertices(few, std::vector<Vec3>(2))));
  ASSERT_FALSE(static_cast<bool>(model.move_all(std::vector<Vec3>(model.mesh().positions().size(), {1e70, 0, 0}))));
}

std::vector<Step> steps() {
  const auto moved_before = in_turn(move_few, commit);
  const auto moved_little = [](Model& model) {
    ASSERT_TRUE(static_cast<bool>(model.move_all(shaken(model.mesh().positions(), 0.01, 7))));
    model.commit();
    model.set_motion_margin(1e-3);
  };
  const auto rebuild = [](Model& model) { model.rebuild(); };
  const auto set_margin = [](double length) { return [=](Model& model) { model.set_motion_margin(length); }; };
  return {
      {"move_vertices, the first time", nothing, move_few},
      {"move_vertices, again", moved_before, move_few},
      {"move_vertices, twice before a commit", move_few, move_few},
      {"move_vertices to the model's own positions", moved_before, move_to_own_positions},
      {"move_all, the first time", nothing, move_all},
      {"move_all, again", moved_before, move_all},
      {"move_all, twice before a commit", move_all, move_all},
      {"rejected moves", moved_before, be_rejected},
      {"commit of a few", move_few, commit},
      {"commit of all", move_all, commit},
      {"move_vertices after rebuild", in_turn(move_few, rebuild), move_few},
      {"commit after the motion margin has been reduced", moved_little, commit},
      {"rebuild, the first time", nothing, rebuild},
      {"rebuild of what has moved", in_turn(move_few, commit, move_all), rebuild},
      {"set_motion_margin before anything moves", nothing, set_margin(0.25)},
      {"set_motion_margin to a length", move_few, set_margin(0.25)},
      {"set_motion_margin to 0", move_few, set_margin(0)},
      {"reset", move_few, [](Model& model) { model.reset(some_mesh()); }},
  };
}

TEST(FailingHeap, LeavesAModelAsItWas) {
  for (const double motion_margin : {0.0, 0.5}) {
    for (const Step& step : steps()) {
      for (const Failing failing : {Failing::once, Failing::always}) {
        SCOPED_TRACE(step.name + ", motion margin " + std::to_string(motion_margin));
        const int count = fail_each_allocation(step, ModelOptions{.motion_margin = motion_margin}, failing);
        if (HasFailure()) return;
        const bool takes_memory = step.name == "reset" || step.name == "rebuild, the first time";
        EXPECT_GT(count, takes_memory ? 5 : -1);
      }
    }
  }
}

/// Plays a motion in which triangles change places, on a heap whose allocation `k` fails. Returns whether it has.
bool play(const scenes::Motion& motion, const ModelOptions& options, int k, Failing failing,
          std::uint64_t& rebuilt_triangles) {
  Model model(motion.mesh, options);
  QueryCache cache;
  bool failed = false;
  int checks = 0;
  for (int frame = 1; frame <= 16; ++frame) {
    const std::vector<Vec3> positions = motion.positions(25 * frame);
    {
      const FailingHeap heap(k, failing);
      const std::uint64_t before = allocation_count();
      const auto move = [&] { EXPECT_TRUE(static_cast<bool>(model.move_all(positions))); };
      if (throws_bad_alloc(move) && failing == Failing::once) move();
      if (model.mesh().positions() == positions) {
        EXPECT_FALSE(throws_bad_alloc([&] { model.commit(); }));
      }
      if (heap.has_failed()) failed = true, checks = 3;
      k -= static_cast<int>(allocation_count() - before);
    }
    if (model.mesh().positions() != positions) {
      EXPECT_TRUE(static_cast<bool>(model.move_all(positions)));
      model.commit();
    }
    if (failing == Failing::always && failed) k = frame % 2 == 0 ? 0 : 1 << 20;  // memory comes and goes
    const double warm = distance({model}, {probe()}, {.cache = &cache}).upper;
    if (checks-- > 0 || frame == 16) {
      expect_right_answers(model);
      EXPECT_NEAR(warm, distance({model}, {probe()}).upper, tolerance);
    }
    if (::testing::Test::HasFailure()) return false;
    if (options.rebuild_policy == RebuildPolicy::on_worker) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  // A worker may need any number of further frames.
  for (int frame = 17; !failed && frame < 2000 && model.maintenance_stats().rebuilt_triangles == 0; ++frame) {
    EXPECT_TRUE(static_cast<bool>(model.move_all(motion.positions(25 * frame))));
    model.commit();
  }
  rebuilt_triangles = model.maintenance_stats().rebuilt_triangles;
  return failed;
}

TEST(FailingHeap, LosesNoTriangleWhileTheTreeIsRebuilt) {
  const scenes::Motion soup = scenes::shuffled_soup(256);
  for (const RebuildPolicy policy : {RebuildPolicy::in_commit, RebuildPolicy::on_worker}) {
    for (const double motion_margin : {0.0, 0.05}) {
      for (const Failing failing : {Failing::once, Failing::always}) {
        SCOPED_TRACE(std::to_string(static_cast<int>(policy)) + ", motion margin " + std::to_string(motion_margin));
        const ModelOptions options{.motion_margin = motion_margin, .rebuild_policy = policy, .rebuild_budget_us = 5};
        std::uint64_t rebuilt_triangles = 0;
        int k = 0;
        while (play(soup, options, k, failing, rebuilt_triangles)) ++k;
        if (HasFailure()) FAIL() << "after allocation " << k;
        EXPECT_GT(k, 10);
        EXPECT_GT(rebuilt_triangles, 0U);  // in the last run, in which no allocation has failed
      }
    }
  }
}

/// The number of allocations without which a call throws.
template <typename Call>
int needed_by(const Call& call) {
  int needed = 0;
  for (int k = 0;; ++k) {
    const FailingHeap heap(k, Failing::once);
    needed += throws_bad_alloc(call) ? 1 : 0;
    if (!heap.has_failed()) return needed;
  }
}

TEST(FailingHeap, IsReportedByConstructors) {
  const Mesh mesh = some_mesh();  // two allocations are those of its copy
  EXPECT_GT(needed_by([&] { const Model model(mesh); }), 7);
  EXPECT_GT(fail_each([&] { const NeighborRings rings(mesh, 2); }, [] {}), 5);
}

TEST(FailingHeap, LeavesAnEmptyCache) {
  const Model model(some_mesh()), ball(scenes::ball(12, 8));
  const Placed a{model}, b{probe(), {{}, {0, 0, 2}}};
  const double truth = distance(a, b).upper, own_truth = self_distance(ball).upper;
  QueryCache cache;
  const auto check = [&] {
    EXPECT_EQ(distance(a, b, {.cache = &cache}).upper, truth);
    EXPECT_FALSE(collide(a, b, {.cache = &cache}).is_yes());
    EXPECT_TRUE(within(a, b, truth * 1.01, {.cache = &cache}).is_yes());
    EXPECT_EQ(self_distance(ball, {.cache = &cache}).upper, own_truth);
    cache.clear();
  };
  fail_each([&] { static_cast<void>(distance(a, b, {.cache = &cache})); }, check);
  check();
  EXPECT_EQ(fail_each([&] { static_cast<void>(self_distance(ball, {.cache = &cache})); }, check), 1);
  check();
  EXPECT_EQ(fail_each([&] { static_cast<void>(self_collide(ball, {.cache = &cache})); }, check), 1);
}

TEST(FailingHeap, LeavesAMovingModelWithoutMotion) {
  const Model ball(scenes::ball(12, 8)), floor(scenes::grid(4, 4, -2, -2, 1, 1));
  MovingModel still(floor);
  still.set_motion(floor.mesh().positions()).value();
  const Transform start{{}, {0.1, 0.2, 3}}, end{{}, {0.1, 0.2, -1}};
  std::optional<MovingModel> moving;
  const auto set = [&] { moving->set_motion(ball.mesh().positions(), start, end).value(); };
  const auto ask = [&] { return time_of_impact(*moving, still).status; };
  const auto check = [&] {
    if (!moving) return;
    EXPECT_THROW(ask(), std::invalid_argument);
    set();  // the next call works
    EXPECT_EQ(ask(), ImpactStatus::contact);
  };
  EXPECT_GT(fail_each([&] { moving.reset(), moving.emplace(ball), set(); }, check), 4);
}

TEST(FailingHeap, LeavesContactsThatAreToBeReducedAsTheyWere) {
  const Model ball(scenes::ball(12, 8));
  std::vector<Contact> contacts(500);
  contacts.resize(std::min(limber::contacts({ball}, {ball, {{}, {1.9, 0, 0}}}, 0.1, contacts).count, contacts.size()));
  ASSERT_GT(contacts.size(), 20U);
  const std::vector<Contact> before = contacts;
  const auto expect_unchanged = [&] {
    for (std::size_t i = 0; i < before.size(); ++i) {
      ASSERT_EQ(contacts[i].triangle_a, before[i].triangle_a);
      ASSERT_EQ(contacts[i].triangle_b, before[i].triangle_b);
    }
  };
  for (const bool has_memory : {false, true}) {
    contacts = before;
    const auto reduce = [&] {
      std::optional<ReductionMemory> memory;
      if (has_memory) memory.emplace();
      static_cast<void>(reduce_contacts(contacts, 0.2, {.memory = memory ? &*memory : nullptr}));
    };
    EXPECT_EQ(fail_each(reduce, expect_unchanged), has_memory ? 7 : 6);
  }
}

}  // namespace
}  // namespace limber::testing
