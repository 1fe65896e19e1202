// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "limber/motion.h"
#include "motion/element_impact.h"
#include "simd/kernels.h"
#include "support/random_motion.h"

namespace limber::testing {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
const Triangle floor_triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

ElementImpact impact_on_floor(const Vec3& start, const Vec3& end, const ElementImpactOptions& options = {}) {
  return time_of_impact(MovingPoint{start, end}, MovingTriangle{floor_triangle, floor_triangle}, options);
}

motion::MovingElements elements_of(const MovingCorners& m, bool is_face) {
  motion::MovingElements e{
      is_face ? motion::MovingElements::Kind::vertex_face : motion::MovingElements::Kind::edge_edge, {}};
  for (int i = 0; i < 4; ++i) e.corners[0][i] = m.start[i], e.corners[1][i] = m.end[i];
  return e;
}

MotionKind some_kind(Rng& rng) {
  return static_cast<MotionKind>(rng.below(static_cast<std::uint64_t>(MotionKind::count)));
}

/// Expects a contact at exactly `time`.
void expect_contact_at(const ElementImpact& found, double time) {
  EXPECT_EQ(found.status, ImpactStatus::contact);
  EXPECT_EQ(found.lower, time);
  EXPECT_EQ(found.upper, time);
}
void expect_clear(const ElementImpact& found) {
  EXPECT_EQ(found.status, ImpactStatus::clear);
  EXPECT_EQ(found.lower, never);
  EXPECT_EQ(found.upper, never);
}

TEST(Impact, OfAVertexAndAFaceHasKnownTimes) {
  const Triangle ones{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, minus_ones{{-1, -1, -1}, {-1, -1, -1}, {-1, -1, -1}};
  const Triangle tilts[] = {{{-1, -1, 1}, {1, -1, -1}, {0, 1, 0}}, {{-1, -1, -1}, {1, -1, 1}, {0, 1, 0}}};
  constexpr double tiny = 0x1p-1074;
  const struct {
    const char* what;
    Vec3 start, end;
    double time;
    Triangle from = floor_triangle, to = floor_triangle;
  } cases[] = {
      {"through the face", {0.25, 0.25, 1}, {0.25, 0.25, -1}, 0.5},
      {"faster", {0.25, 0.25, 1}, {0.25, 0.25, -3}, 0.25},
      {"not quite to the face", {0.25, 0.25, 1}, {0.25, 0.25, tiny}, never},
      {"through a corner", {0, 0, 1}, {0, 0, -1}, 0.5},
      {"on another corner", {1, 0, 1}, {1, 0, 0}, 1},
      {"through an edge", {0.5, 0, 1}, {0.5, 0, -1}, 0.5},
      {"on an oblique edge", {0.5, 0.5, 1}, {0.5, 0.5, 0}, 1},
      {"beside it", {0.5, std::nextafter(0.5, 1), 1}, {0.5, std::nextafter(0.5, 1), -1}, never},
      {"in the plane, through an edge", {-1, 0.25, 0}, {1, 0.25, 0}, 0.5},
      {"in the plane, along an edge", {3, 0, 0}, {-1, 0, 0}, 0.5},
      {"in the plane, not as far", {2, 2, 0}, {0.75, 0.75, 0}, never},
      {"a face that is a point", {0, 0, 0}, {0, 0, 0}, 0.5, ones, minus_ones},
      {"two points that pass", {-1, 1, 1}, {1, -1, -1}, 0.5, ones, minus_ones},
      {"two points that miss", {-1, 1, 1}, {1, -1, 0}, never, ones, minus_ones},
      // The plane of the face tilts through the vertex, which slides along its axis: a double root.
      {"for a moment", {-0.5, 0, 0}, {0.5, 0, 0}, 0.5, tilts[0], tilts[1]},
      {"from the start on, away", {0, 0, 0}, {0.25, 0.25, 1}, 0},
      {"from the start on, in the plane", {0, 0, 0}, {5, 5, 0}, 0},
      {"at rest", {0, 0, 0}, {0, 0, 0}, 0},
  };
  for (const auto& [what, start, end, time, from, to] : cases) {
    SCOPED_TRACE(what);
    const ElementImpact found = time_of_impact(MovingPoint{start, end}, MovingTriangle{from, to});
    EXPECT_EQ(found.status, time == 0       ? ImpactStatus::initial_contact
                            : time == never ? ImpactStatus::clear
                                            : ImpactStatus::contact);
    EXPECT_EQ(found.lower, time);
    EXPECT_EQ(found.upper, time);
  }
  // At 1/3 of the time: no double is that time.
  const Triangle end{{-1, -1, -2}, {1, -1, 2}, {0, 1, 0}};
  for (const ElementImpact& third :
       {impact_on_floor({0.25, 0.25, 1}, {0.25, 0.25, -2}),
        time_of_impact(MovingPoint{{-0.25, 0, 0}, {0.5, 0, 0}}, MovingTriangle{tilts[0], end})}) {
    EXPECT_EQ(third.status, ImpactStatus::contact);
    EXPECT_LE(third.upper - third.lower, 0x1p-53);
    EXPECT_LT(third.lower * 3, 1);
    EXPECT_GT(third.upper, 1.0 / 3);
  }
}

TEST(Impact, OfTwoEdges) {
  const Segment across{{0, -1, 0}, {0, 1, 0}}, above{{-1, 0, 1}, {1, 0, 1}}, below{{-1, 0, -1}, {1, 0, -1}};
  expect_contact_at(time_of_impact(MovingSegment{above, below}, MovingSegment{across, across}), 0.5);
  // Parallel ones, side by side, in one plane; and along their line.
  const Segment aside{{2, -1, 0}, {2, 1, 0}}, beyond{{0, 3, 0}, {0, 5, 0}};
  expect_contact_at(time_of_impact(MovingSegment{aside, across}, MovingSegment{across, across}), 1);
  expect_contact_at(time_of_impact(MovingSegment{beyond, across}, MovingSegment{across, across}), 0.5);
}

TEST(Impact, TellsTimesApartThatDifferInTheThousandthDigit) {
  constexpr double tiny = 0x1p-1074;
  // The vertex is in the plane of the face at 1/3, and beside its edge then by `tiny`.
  const Triangle face{{0, tiny, 0}, {1, tiny, 0}, {0, 1, 0}};
  expect_clear(time_of_impact(MovingPoint{{0.25, -1, 1}, {0.25, 2, -2}}, MovingTriangle{face, face}));
  expect_clear(
      time_of_impact(MovingPoint{{0.25, -1, 1}, {0.25, 2, -2}}, MovingTriangle{face, face}, {.max_time = 0.5}));
  const Triangle reached{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(time_of_impact(MovingPoint{{0.25, -1, 1}, {0.25, 2, -2}}, MovingTriangle{reached, reached}).status,
            ImpactStatus::contact);
  // The determinant is (1 - 3 t)^2 - tiny^2.
  const Triangle start{{1, tiny, 0}, {tiny, 1, 0}, {0, 0, 1}}, end{{-2, tiny, 0}, {tiny, -2, 0}, {0, 0, 1}};
  const ElementImpact found = time_of_impact(MovingPoint{{0, 0, 0}, {0, 0, 0}}, MovingTriangle{start, end});
  EXPECT_EQ(found.status, ImpactStatus::contact);
  EXPECT_LE(found.lower, 1.0 / 3);
  EXPECT_GT(found.upper, 1.0 / 3);
}

TEST(Impact, AfterTheLargestTimeIsNotLookedFor) {
  const Vec3 start{0.25, 0.25, 1}, end{0.25, 0.25, -1};
  expect_contact_at(impact_on_floor(start, end, {.max_time = 0.5}), 0.5);
  expect_clear(impact_on_floor(start, end, {.max_time = std::nextafter(0.5, 0)}));
  expect_clear(impact_on_floor(start, end, {.max_time = 0}));
  // At 1/3: no double is that time.
  const Vec3 lower{0.25, 0.25, -2};
  EXPECT_EQ(impact_on_floor(start, lower, {.max_time = 1.0 / 3 + 0x1p-54}).status, ImpactStatus::contact);
  expect_clear(impact_on_floor(start, lower, {.max_time = 1.0 / 3}));
}

TEST(Impact, IsInAnIntervalAsWideAsAskedForAndUpToATimeThatOfTheFirstContact) {
  Rng rng(32);
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    const bool is_face = rng.below(2) == 0;
    const MovingCorners m = random_motion(rng, some_kind(rng), is_face);
    const ElementImpact best = impact_of(m, is_face);
    const double limit = rng.below(2) == 0 ? rng.uniform(0, 1) : static_cast<double>(rng.below(5)) / 4;
    const ElementImpact limited = impact_of(m, is_face, {.max_time = limit});
    const bool is_later = limited.status == ImpactStatus::clear;
    EXPECT_TRUE(is_later ? best.upper >= limit : limited.status == best.status && limited.lower <= limit) << i;
    const double error = std::ldexp(1.0, -static_cast<int>(rng.below(60)));
    const ElementImpact rough = impact_of(m, is_face, {.time_error = error});
    ASSERT_EQ(rough.status, best.status) << i;
    if (best.status == ImpactStatus::clear) continue;
    ++touching;
    EXPECT_LE(rough.lower, best.upper) << i;
    EXPECT_GE(rough.upper, best.lower) << i;
    EXPECT_LE(best.upper - best.lower, 0x1p-53) << i;
    EXPECT_LE(rough.upper - rough.lower, std::max(error, 0x1p-53)) << i;
  }
  EXPECT_GT(touching, 500);
}

TEST(Impact, IsTheSameInEveryUnit) {
  Rng rng(33);
  for (int i = 0; i < 10000; ++i) {
    const bool is_face = rng.below(2) == 0;
    const MotionKind kind = some_kind(rng);
    if (kind == MotionKind::all_scales) continue;
    MovingCorners m = random_motion(rng, kind, is_face);
    // Where the filter's interval is about as wide, the next step decides how far it is narrowed.
    const double error = rng.below(2) == 0 ? 0 : std::ldexp(1.0, -20 - static_cast<int>(rng.below(30)));
    const ElementImpact before = impact_of(m, is_face, {.time_error = error});
    bool rounds = false;
    const double factor = std::ldexp(1.0, static_cast<int>(rng.below(1170)) - 1020);
    const MovingCorners original = m;
    scale_by(m, factor);
    for (int k = 0; k < 4; ++k) {
      rounds =
          rounds || !(m.start[k] * (1 / factor) == original.start[k]) || !(m.end[k] * (1 / factor) == original.end[k]);
    }
    if (rounds) continue;
    const ElementImpact after = impact_of(m, is_face, {.time_error = error});
    ASSERT_EQ(before.status, after.status) << i;
    ASSERT_EQ(before.lower, after.lower) << i << " factor " << factor;
    ASSERT_EQ(before.upper, after.upper) << i << " factor " << factor;
  }
}

TEST(Impact, OfTheFilterIsThatOfExactArithmetic) {
  Rng rng(34);
  int decided = 0;
  for (int i = 0; i < 6000; ++i) {
    const bool is_face = rng.below(2) == 0;
    const motion::MovingElements e = elements_of(random_motion(rng, some_kind(rng), is_face), is_face);
    const ElementImpactOptions options{.max_time = rng.below(2) == 0 ? 1 : rng.uniform(0, 1)};
    const motion::FilterResult filtered = motion::filter_impact(e, options);
    if (filtered.verdict == motion::FilterResult::Verdict::unknown) continue;
    ++decided;
    const ElementImpact exact = motion::exact_impact(e, options);
    const bool touches = filtered.verdict == motion::FilterResult::Verdict::contact;
    ASSERT_EQ(exact.status, touches ? ImpactStatus::contact : ImpactStatus::clear) << i;
    if (!touches) continue;
    ASSERT_LE(filtered.lower, exact.upper) << i;
    ASSERT_GE(filtered.upper, exact.lower) << i;
  }
  EXPECT_GT(decided, 2000);
}

TEST(Impact, IsExcludedOnlyWhereThereIsNone) {
  Rng rng(35);
  int clear = 0, excluded = 0;
  for (int i = 0; i < 4000; ++i) {
    const bool are_faces = rng.below(2) == 0;
    const MotionKind kind = some_kind(rng);
    const ElementImpactOptions options{.max_time = rng.below(2) == 0 ? 1 : rng.uniform(0, 1)};
    motion::MovingElements pairs[simd::MovingPairs::room];
    simd::MovingPairs vectors;
    for (std::uint32_t k = 0; k < simd::MovingPairs::room; ++k) {
      pairs[k] = elements_of(random_motion(rng, kind, are_faces), are_faces);
      for (int end = 0; end < 2; ++end) {
        const motion::Vectors x = motion::vectors_of(pairs[k].kind, pairs[k].corners[end]);
        vectors.u[end][k] = x.u, vectors.v[end][k] = x.v, vectors.w[end][k] = x.w;
      }
    }
    const unsigned found = simd::scalar_kernels.exclude_impacts(vectors, are_faces, {0, options.max_time, 0});
    for (const simd::Kernels& kernels : simd::all_kernels()) {
      ASSERT_EQ(kernels.exclude_impacts(vectors, are_faces, {0, options.max_time, 0}), found) << kernels.name;
    }
    for (std::uint32_t k = 0; k < simd::MovingPairs::room; ++k) {
      const bool is_excluded = (found >> k & 1) != 0;
      if (!is_excluded && kind != MotionKind::crossing) continue;
      const bool is_clear = motion::exact_impact(pairs[k], options).status == ImpactStatus::clear;
      ASSERT_TRUE(is_clear || !is_excluded) << i;
      if (kind == MotionKind::crossing && is_clear) ++clear, excluded += is_excluded ? 1 : 0;
    }
  }
  EXPECT_GT(excluded, 0.8 * clear) << clear;
}

TEST(Impact, OfWhatIsOutOfRangeIsRefused) {
  const Vec3 bad[] = {{std::nan(""), 0, 0}, {0, never, 0}, {0, 0, 2 * max_coordinate}};
  for (const Vec3& p : bad) {
    EXPECT_THROW(static_cast<void>(impact_on_floor(p, {0, 0, 1})), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(impact_on_floor({0, 0, 1}, p)), std::invalid_argument);
    const Segment s{{0, 0, 0}, p}, t{{0, 0, 0}, {1, 0, 0}};
    EXPECT_THROW(static_cast<void>(time_of_impact(MovingSegment{t, t}, MovingSegment{t, s})), std::invalid_argument);
  }
  for (const double time : {-0x1p-1074, 1.5, std::nan("")}) {
    EXPECT_THROW(static_cast<void>(impact_on_floor({0, 0, 1}, {0, 0, 2}, {.max_time = time})), std::invalid_argument);
  }
  for (const double error : {-1.0, std::nan("")}) {
    EXPECT_THROW(static_cast<void>(impact_on_floor({0, 0, 1}, {0, 0, 2}, {.time_error = error})),
                 std::invalid_argument);
  }
  expect_contact_at(impact_on_floor({0.25, 0.25, max_coordinate}, {0.25, 0.25, -max_coordinate}), 0.5);
}

}  // namespace
}  // namespace limber::testing
