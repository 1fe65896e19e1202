// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/front.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "base/access.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/placed_pair.h"
#include "pair/query_cache_impl.h"
#include "scenes/motions.h"
#include "support/random_geometry.h"
#include "support/right_answers.h"

namespace limber::testing {
namespace {

using pair::Frames;
using pair::Front;
using pair::PlacedPair;
using pair::Side;

Transform a_from_b(const PlacedPair& placed) { return Frames(placed).a_from_b(); }

/// How two models are placed before and after a motion.
struct Motion {
  Transform a_before, a_after, b_before, b_after;
};

/// The largest change of the distance of two vertices, as a part of the bound.
double part_of_bound(Rng& rng, const Model& a, const Model& b, const Motion& m) {
  const PlacedPair first({a, m.a_before}, {b, m.b_before}), second({a, m.a_after}, {b, m.b_after});
  const double bound = second.max_displacement(a_from_b(first), first.error(), a_from_b(second));
  double largest = 0;
  for (int k = 0; k < 20; ++k) {
    const Vec3& p = a.mesh().positions()[rng.below(a.mesh().positions().size())];
    const Vec3& q = b.mesh().positions()[rng.below(b.mesh().positions().size())];
    const double after = length(m.b_after(q) - m.a_after(p)), before = length(m.b_before(q) - m.a_before(p));
    largest = std::max(largest, std::abs(after - before) / bound);
  }
  return largest;
}

/// A pose followed by a stretch of the world, along z the most, that is_rigid() still allows. `part` is from -1 to 1.
Transform stretched(const Transform& pose, double part) {
  const double side = 1 + 0.49e-9 * part, up = 1 + 1.9e-9 * part;
  const Mat3& r = pose.rotation;
  const Vec3& t = pose.translation;
  return {{side * r.row0, side * r.row1, up * r.row2}, {side * t.x, side * t.y, up * t.z}};
}

TEST(Front, BoundsTheChangeOfDistanceByAnyMotion) {
  Rng rng(300);
  const Model a(scenes::thesis_square()), b(scenes::thesis_ball());
  double tightest = 0;
  for (int i = 0; i < 2000; ++i) {
    const double step = std::pow(10.0, rng.uniform(-6, 0));
    const Transform pose_a = random_pose(rng, 3), before = random_pose(rng, 3);
    const Vec3 axis = step * uniform_point(rng);
    const Transform turn = transform_from_quaternion({}, 1, axis.x, axis.y, axis.z).value();
    const Transform after{turn.rotation * before.rotation, before.translation + step * uniform_point(rng)};
    const double part = part_of_bound(rng, a, b, {pose_a, pose_a, before, after});
    ASSERT_LE(part, 1) << i;
    tightest = std::max(tightest, part);
  }
  EXPECT_GT(tightest, 0.5);
  // Poses that are not quite rigid: both models are stretched together. Neither moves as the other one sees it, but
  // their distance changes.
  for (int i = 0; i < 300; ++i) {
    const Transform pose_a = random_pose(rng, 3);
    const Transform pose_b{random_pose(rng, 1).rotation, std::pow(10.0, rng.uniform(0, 3)) * uniform_point(rng)};
    const double from = rng.uniform(-1, 1), to = rng.uniform(-1, 1);
    const Motion motion{stretched(pose_a, from), stretched(pose_a, to), stretched(pose_b, from), stretched(pose_b, to)};
    ASSERT_LE(part_of_bound(rng, a, b, motion), 1) << i;
  }
}

TEST(Front, IsTraversedToItsEndHoweverManyPairsAreQueued) {
  // The motion margin is larger than the triangles, so that few pairs are pruned and the bucket queue can become full.
  const scenes::Motion waves = scenes::waving_sheet(158, 158);
  Model sheet(waves.mesh, {.motion_margin = 0.07});
  const Model ball(mapped(scenes::thesis_ball(), [](const Vec3& p) { return 0.25 * p; }));
  QueryCache cache;
  for (int frame = 1; frame <= 30; ++frame) {
    ASSERT_TRUE(static_cast<bool>(sheet.move_all(waves.positions(frame))));
    sheet.commit();
    const double angle = 0.01 * frame;
    const Placed placed{ball, {{}, {2 + 1.2 * scenes::cosine(angle), 2 + 1.2 * scenes::sine(angle), 0.5}}};
    ASSERT_NEAR(distance({sheet}, placed, {.cache = &cache}).upper, distance({sheet}, placed).upper, 1e-14) << frame;
  }
}

TEST(Front, CoversTheRoundingOfThePlaceBefore) {
  // Many pairs of points are as far apart as the closest pair, up to the rounding of a place far from the origin. Then
  // the models move to the origin together.
  Rng rng(302);
  for (int i = 0; i < 20; ++i) {
    const auto points = [&](double height) {
      std::vector<Triangle> triangles;
      for (int k = 0; k < 256; ++k) {
        const Vec3 p{k % 16 - 8.0, k / 16 - 8.0, height + rng.uniform(0, 0x1p-11)};
        triangles.push_back({p, p, p});
      }
      return soup(triangles);
    };
    const Model a(points(0)), b(points(1));
    const Transform far{{}, {0x1p40, 0x1p40, 0x1p40}};
    QueryCache cache;
    const QueryBudget records{.max_steps = 1 << 20};  // with a budget, a front is used whatever it saves
    static_cast<void>(distance({a, far}, {b, far}, {.cache = &cache, .budget = records}));
    ASSERT_EQ(distance({a}, {b}, {.cache = &cache, .budget = records}).upper, distance({a}, {b}).upper) << i;
  }
}

TEST(Front, CoversTheRoundingOfThePlaceAfter) {
  // The models move far from the origin together, where some pairs are rounded to the same point.
  Rng rng(303);
  const double part = std::sqrt(1.0 / 3) * 0x1p-13;
  for (int i = 0; i < 20; ++i) {
    std::vector<Triangle> of_a, of_b;  // points, each next to one of the other model, at about the same distance
    for (int k = 0; k < 256; ++k) {
      const Vec3 p = Vec3{4.0 * (k % 16), 4.0 * (k / 16), 0} + uniform_point(rng, 0, 0.5);
      const Vec3 q = p + (1 + rng.uniform(0, 1e-12)) * Vec3{part, part, part};
      of_a.push_back({p, p, p}), of_b.push_back({q, q, q});
    }
    const Model a(soup(of_a)), b(soup(of_b));
    const Transform far{{}, {0x1p40, 0x1p40, 0x1p40}};
    ASSERT_TRUE(collide({a, far}, {b, far}).is_yes()) << i;
    QueryCache cache;
    const QueryBudget records{.max_steps = 1 << 20};  // with a budget, a front is used whatever it saves
    ASSERT_GT(distance({a}, {b}, {.cache = &cache, .budget = records}).lower, 0x1p-14) << i;
    ASSERT_TRUE(collide({a, far}, {b, far}, {.cache = &cache, .budget = records}).is_yes()) << i;
  }
}

TEST(Front, RemembersHowFarApartLeavesAreThatWereCompared) {
  const Model sheet(scenes::wave_sheet(100, 100, 0)), ball(scenes::thesis_ball());
  QueryCache cache;
  std::uint64_t node_tests = 0, node_tests_without = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const Placed a{sheet}, b{ball, {{}, {0.3 + 1e-6 * frame, 0.4, 2.5 + 1e-6 * frame}}};
    const DistanceResult found = distance(a, b, {.cache = &cache}), wanted = distance(a, b);
    ASSERT_DOUBLE_EQ(found.upper, wanted.upper) << frame;  // of pairs that tie, another may have come first
    if (frame == 0) continue;
    node_tests += found.stats.node_tests, node_tests_without += wanted.stats.node_tests;
  }
  // It is a twentieth. If compared leaves counted as no farther apart than the best pair, it would be an eighth.
  EXPECT_LT(12 * node_tests, node_tests_without);
}

TEST(Front, PrunesUntilTheMotionIsUsedUp) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  const PlacedPair here({square}, {ball, {{}, {0, 0, 5}}}), there({square}, {ball, {{}, {0, 0, 4.9}}});
  Front front;
  front.begin(here, a_from_b(here));
  const std::uint16_t record = front.add({1, 2}, Side::b);
  front.record_children(record, 0b101, Front::Kind::settled, 3.0);
  front.record_children(record, 0b010, Front::Kind::open, 2.0);
  EXPECT_EQ(front.bound_of(front.records()[record]), 2.0);
  front.finish();
  front.begin(there, a_from_b(there));
  EXPECT_NEAR(front.motion_bound(), 0.1, 1e-6);
  EXPECT_GE(front.motion_bound(), 0.1);
  EXPECT_NEAR(front.bound_of(front.records()[record]), 1.9, 1e-6);
  EXPECT_EQ(front.take_children(record, 1.5), 0U);
  EXPECT_EQ(front.take_children(record, 2.5), 0b010U);
  EXPECT_NEAR(front.bound_of(front.records()[record]), 2.9, 1e-6);
  EXPECT_EQ(front.take_children(record, 4), 0b101U);
  front.record_children(record, 0b001, Front::Kind::settled, 1.0);
  EXPECT_EQ(front.bound_of(front.records()[record]), 1);
  front.record_children(record, 0b100, Front::Kind::near, 0.5);
  EXPECT_EQ(front.bound_of(front.records()[record]), 0.5);
  EXPECT_EQ(front.take_children(record, 0.75), 0b100U);  // the others stay
  EXPECT_EQ(front.bound_of(front.records()[record]), 1);
}

TEST(Front, IsDroppedWhenIncomplete) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  const PlacedPair placed({square}, {ball});
  for (const bool is_finished : {true, false}) {  // false: as it would be after an exception
    Front front;
    front.begin(placed, a_from_b(placed));
    front.add({0, 0}, Side::a);
    if (is_finished) front.finish();
    front.begin(placed, a_from_b(placed));
    EXPECT_EQ(front.records().size(), is_finished ? 1U : 0U);
  }
}

TEST(Front, HasRoomForAThousandRecordsAndCountsWhatHasNone) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  const PlacedPair placed({square}, {ball});
  Front front;
  front.begin(placed, a_from_b(placed));
  for (int i = 0; i < 1024; ++i) ASSERT_NE(front.add({0, 0}, Side::a), pair::NodePair::no_record);
  for (int i = 0; i < 1024; ++i) ASSERT_EQ(front.add({0, 0}, Side::a), pair::NodePair::no_record);
  EXPECT_FALSE(front.overflows());
  front.add({0, 0}, Side::a);
  EXPECT_TRUE(front.overflows());
}

TEST(Front, IsOfUseOnlyInTheUnitsOfItsModels) {
  // A model that grows by more than 2^20 gets another unit; its leaves keep their triangles.
  Rng rng(305);
  int meeting = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const auto specks = [&](const Vec3& at, double size) {
      std::vector<Triangle> triangles;
      for (int k = 0; k < 40; ++k) {
        const Vec3 p = at + size * uniform_point(rng);
        triangles.push_back({p, p + 0.3 * size * uniform_point(rng), p + 0.3 * size * uniform_point(rng)});
      }
      return soup(triangles);
    };
    const double small = std::ldexp(1.0, -20 - static_cast<int>(rng.below(20)));
    const bool grows_a = rng.below(2) == 0;
    Model a(specks({}, small), {.rebuild_policy = RebuildPolicy::off});
    const Model b(specks({1, 0, 0}, 0.5));
    const auto ask = [&](QueryCache* cache, const QueryBudget& budget) {
      const Placed first{grows_a ? a : b}, second{grows_a ? b : a};
      return distance(first, second, {.cache = cache, .budget = budget});
    };
    QueryCache cache;
    static_cast<void>(ask(&cache, {.max_steps = 1 + rng.below(20)}));
    deform(a, [&](const Vec3& p) { return rng.below(3) == 0 ? (1.5 / small) * p : p; });
    const double truth = ask(nullptr, {}).upper;
    ASSERT_NEAR(ask(&cache, {}).upper, truth, 1e-12);
    ASSERT_EQ(collide({grows_a ? a : b}, {grows_a ? b : a}, {.cache = &cache}).is_yes(), truth == 0);
    meeting += truth == 0 ? 1 : 0;
  }
  EXPECT_GT(meeting, 20);
}

TEST(Front, IsRightWhenItsCapacityIsExceeded) {
  // Two sheets lie on each other and are close everywhere, so that the query needs thousands of expansions.
  const Model lower(scenes::wave_sheet(150, 150, 0)), upper(scenes::wave_sheet(150, 150, 0));
  QueryCache cache;
  std::uint64_t cold = 0, warm = 0;
  for (int frame = 0; frame < 10; ++frame) {
    const Transform pose{{}, {0, 0, 1e-3 - 1e-5 * frame}};
    const DistanceResult fresh = distance({lower}, {upper, pose}),
                         cached = distance({lower}, {upper, pose}, {.cache = &cache});
    ASSERT_NEAR(cached.upper, fresh.upper, 1e-14) << frame;
    cold += fresh.stats.node_tests, warm += cached.stats.node_tests;
  }
  EXPECT_GT(cold, 10U * 8 * 1024);
  EXPECT_LE(warm, cold * 11 / 10);
  // At rest there is nothing to do once a front is there.
  const Transform pose{{}, {0, 0, 1e-3 - 1e-5 * 9}};
  static_cast<void>(distance({lower}, {upper, pose}, {.cache = &cache}));
  EXPECT_LT(distance({lower}, {upper, pose}, {.cache = &cache}).stats.node_tests, 10U);
}

TEST(Front, CostsNoTestsWherePosesHaveNothingInCommon) {
  const Model sheet(scenes::wave_sheet(60, 60, 0)), ball(scenes::thesis_ball());
  Rng rng(303);
  for (const double height : {0.2, 1.5}) {  // meeting and apart
    for (const int kind : {0, 1, 2}) {
      QueryCache cache;
      std::uint64_t cold = 0, warm = 0;
      for (int i = 0; i < 300; ++i) {
        const Vec3 at{rng.uniform(0, 4), rng.uniform(0, 4), rng.uniform(height, 2 * height)};
        const Placed a{sheet}, b{ball, {random_pose(rng, 1).rotation, at}};
        const DistanceOptions options{.relative_error = kind == 1 ? 0.1 : 0};
        cold += (kind == 2 ? collide(a, b).stats : distance(a, b, options).stats).node_tests;
        warm += (kind == 2 ? collide(a, b, {.cache = &cache}).stats : distance(a, b, with(options, &cache)).stats)
                    .node_tests;
      }
      EXPECT_LE(static_cast<double>(warm), 1.05 * static_cast<double>(cold)) << height << ", " << kind;
    }
  }
}

TEST(Front, IsRecordedWherePosesHaveMuchInCommon) {
  // To record costs a part of a query, and the first time it makes much memory present.
  const Model sheet(scenes::wave_sheet(60, 60, 0)), ball(scenes::thesis_ball());
  Rng rng(305);
  QueryCache cache;
  const auto records_after = [&](const Transform& pose) {
    static_cast<void>(distance({sheet}, {ball, pose}, {.cache = &cache}));
    return Access::impl(cache).front.records().size();
  };
  for (int i = 0; i < 40; ++i) {
    const Vec3 at{rng.uniform(0, 4), rng.uniform(0, 4), rng.uniform(1.5, 3)};
    ASSERT_EQ(records_after({random_pose(rng, 1).rotation, at}), 0U) << i;
  }
  const auto near = [](int i) { return Transform{{}, {2, 2 + 0.01 * i, 1.5}}; };
  EXPECT_EQ(records_after(near(0)), 0U);
  for (int i = 1; i < 4; ++i) EXPECT_GT(records_after(near(i)), 0U) << i;
  // A front is begun after a jump, too, once fronts have paid.
  EXPECT_GT(records_after({{}, {1, 0.5, 3}}), 0U);
}

TEST(Front, IsRecordedForSmallModelsToo) {
  // A query takes few steps here. The first one cannot use a bound, so it does not count against bounds.
  const Model ground(scenes::grid(12, 12, -3, -3, 0.5, 0.5)), ball(scenes::ball(12, 8));
  QueryCache cache;
  for (const double height : {1.3, 1.299}) {
    static_cast<void>(distance({ground}, {ball, {{}, {0.1, 0.2, height}}}, {.relative_error = 0.1, .cache = &cache}));
  }
  EXPECT_FALSE(Access::impl(cache).front.records().empty());
  // Beside the last answer a traversal is short, which is no reason to think less of what caches save.
  QueryCache::Impl judged;
  judged.judge_new_front(8), judged.judge_new_front(5);
  EXPECT_EQ(judged.work_of_new, 8);
  judged.judge_new_front(9);
  EXPECT_EQ(judged.work_of_new, 9);
}

[[gnu::noinline]] std::size_t count_of(const unsigned char* bytes, std::size_t size, unsigned char value) {
  return static_cast<std::size_t>(std::count(bytes, bytes + size, value));
}

TEST(Front, LeavesMostOfItsMemoryUntouchedUntilItIsRecorded) {
  // By way of functions that no compiler looks into: what was in memory before an object is there is nobody's business.
  void* (*volatile fill)(void*, int, std::size_t) = std::memset;
  std::size_t (*volatile count)(const unsigned char*, std::size_t, unsigned char) = count_of;
  const auto memory = std::make_unique<unsigned char[]>(sizeof(QueryCache::Impl));
  fill(memory.get(), 0xA5, sizeof(QueryCache::Impl));
  QueryCache::Impl* const cache = new (memory.get()) QueryCache::Impl();
  EXPECT_LT(sizeof(QueryCache::Impl) - count(memory.get(), sizeof(QueryCache::Impl), 0xA5), 1024U);
  cache->~Impl();
}

TEST(Front, IsOfUseAgainSoonAfterAJumpOrMany) {
  const Model sheet(scenes::wave_sheet(60, 60, 0)), ball(scenes::thesis_ball());
  Rng rng(304);
  QueryCache cache;
  const auto ask = [&](const Transform& pose) {
    return distance({sheet}, {ball, pose}, {.cache = &cache}).stats.node_tests;
  };
  for (int i = 0; i < 100; ++i) ask(random_pose(rng, 5));
  const auto slack = [](int i) { return Transform{{}, {2, 2, 1.5 + 1e-6 * i}}; };
  for (int i = 0; i < 40; ++i) ask(slack(i));
  EXPECT_LT(5 * ask(slack(40)), distance({sheet}, {ball, slack(40)}).stats.node_tests);
}

}  // namespace
}  // namespace limber::testing
