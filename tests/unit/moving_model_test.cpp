// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Times of impact of models: known answers, options, budgets, visitors and mistakes of callers. Random scenes are in
// tests/property.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "limber/motion.h"
#include "scenes/scenes.h"
#include "unit/refusals.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

constexpr double no_time = std::numeric_limits<double>::infinity();

Transform shifted(const Vec3& by) { return {{}, by}; }

/// A model and its motion.
struct MovingBody {
  Model model;
  MovingModel moving;

  explicit MovingBody(const Mesh& mesh, const ModelOptions& options = {}) : model(mesh, options), moving(model) {
    shift({}, {});
  }
  /// Goes from one place to another without a change of shape.
  void shift(const Vec3& from, const Vec3& to) {
    moving.set_motion(model.mesh().positions(), shifted(from), shifted(to)).value();
  }
};

/// A cube of side 1 about the origin, and a plate of size 4 in the plane z = 0.
Mesh cube() { return box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}); }
Mesh plate() { return scenes::grid(3, 3, -2, -2, 4.0 / 3, 4.0 / 3); }

/// A box that falls through a plate: its lower face is at 2 - 4 t.
struct FallingBox : ::testing::Test {
  FallingBox() { box.shift({0, 0, 2.5}, {0, 0, -1.5}); }

  ImpactResult ask(const ImpactOptions& options = {}) const {
    return time_of_impact(box.moving, floor.moving, options);
  }
  PairCount visit(const ImpactVisitor& visitor, const ImpactOptions& options = {}) const {
    return visit_impacts(box.moving, floor.moving, visitor, options);
  }

  MovingBody box{cube()}, floor{plate()};
};

TEST_F(FallingBox, FallsOnAPlate) {
  box.shift({0.1, 0.2, 2.5}, {0.1, 0.2, -1.5});
  for (const bool is_swapped : {false, true}) {
    const ImpactResult found = is_swapped ? time_of_impact(floor.moving, box.moving) : ask();
    EXPECT_EQ(found.status, ImpactStatus::contact);
    EXPECT_LE(found.lower, 0.5);
    EXPECT_GE(found.upper, 0.5);
    EXPECT_EQ(found.normal, (Vec3{0, 0, is_swapped ? 1.0 : -1.0}));
    ASSERT_TRUE(found.elements && found.witness);
    EXPECT_NEAR(length(found.witness->point_a - found.witness->point_b), 0, 1e-15);
    EXPECT_EQ(found.stopped_by, StoppedBy::nothing);
  }
  // Without what a filter leaves out; crossings at the start count all the same.
  const auto nothing = [](const ElementPair&) { return false; };
  EXPECT_EQ(ask({.filter = nothing}).status, ImpactStatus::clear);
  EXPECT_EQ(time_of_impact(box.moving, box.moving, {.filter = nothing}).status, ImpactStatus::initial_contact);
  const auto no_edges = [](const ElementPair& p) { return p.kind != ElementPair::Kind::edge_edge; };
  EXPECT_NE(ask({.filter = no_edges}).elements.value().kind, ElementPair::Kind::edge_edge);
  EXPECT_EQ(visit([](const Impact&) { return true; }, {.filter = nothing}).count, 0U);
  const PairCount few = visit([](const Impact&) { return false; });
  EXPECT_EQ(few.count, 1U);
  EXPECT_FALSE(few.is_complete);
}

TEST(MovingModel, TouchesSomethingThatGrowsByAnyFactor) {
  // A face of size 2^-150 that grows to 2^150 in its plane, and a vertex that falls through it right at the start.
  const double small = 0x1p-150, large = 0x1p150;
  const std::vector<Vec3> face{{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}}, point{{0.1, 0.2, 0.5}};
  const auto times = [](const std::vector<Vec3>& positions, double factor) {
    std::vector<Vec3> all;
    for (const Vec3& p : positions) all.push_back(factor * p);
    return all;
  };
  MovingBody a(small_mesh(times(point, small), {{0, 0, 0}})), b(small_mesh(times(face, small), {{0, 1, 2}}));
  a.moving.set_motion(std::vector<Vec3>{{0.1 * small, 0.2 * small, -large}}).value();
  b.moving.set_motion(times(face, large)).value();
  for (const double max_time : {0x1p-290, 0x1p-60, 1.0}) {
    EXPECT_EQ(time_of_impact(a.moving, b.moving, {.max_time = max_time}).status, ImpactStatus::contact) << max_time;
  }
  EXPECT_EQ(time_of_impact(a.moving, b.moving, {.max_time = 0x1p-310}).status, ImpactStatus::clear);
}

TEST(MovingModel, ThatCrossesAtTheStartIsSaidSo) {
  MovingBody needle(small_mesh({{0.1, 0.2, 1}, {0.15, 0.2, 1}, {0.1, 0.2, -1}}, {{0, 1, 2}})), floor(plate());
  needle.shift({}, {0, 0, 1.5});
  const ImpactResult found = time_of_impact(needle.moving, floor.moving);
  EXPECT_EQ(found.status, ImpactStatus::initial_contact);
  EXPECT_EQ(found.upper, 0);
  EXPECT_FALSE(found.elements);
  ASSERT_TRUE(found.witness);
  EXPECT_EQ(found.witness->point_a, found.witness->point_b);
  // No edge of the plate is crossed: an element touches another where the tip leaves the plate.
  const ImpactResult later = time_of_impact(needle.moving, floor.moving, {.ignore_crossings = true});
  EXPECT_NEAR(later.upper, 2.0 / 3, 1e-15);
  ASSERT_TRUE(later.elements);
  EXPECT_EQ(later.elements->kind, ElementPair::Kind::vertex_face);
  EXPECT_EQ(later.elements->a, 2U);
}

TEST_F(FallingBox, KeepsASeparation) {
  const ImpactResult found = ask({.min_separation = 0.5});
  EXPECT_EQ(found.status, ImpactStatus::contact);
  EXPECT_NEAR(found.upper, 0.375, 1e-12);
  ASSERT_TRUE(found.witness);
  EXPECT_NEAR(found.witness->point_a.z, 0.5, 1e-11);
  EXPECT_EQ(found.witness->point_b.z, 0);
  EXPECT_NEAR(found.normal.z, -1, 1e-14);
  box.shift({0, 0, 0.9}, {0, 0, 2});
  EXPECT_EQ(ask({.min_separation = 0.5}).status, ImpactStatus::initial_contact);
}

TEST_F(FallingBox, MayGoOnFromNearerThanTheSeparation) {
  box.shift({0.1, 0.2, 0.75}, {0.1, 0.2, 1.75});  // up, from 0.25 above the plate
  const auto ask_within = [&](double part) { return ask({.min_separation = 0.5, .separation_fraction = part}); };
  EXPECT_EQ(ask_within(0).status, ImpactStatus::initial_contact);
  EXPECT_EQ(ask_within(0.5).status, ImpactStatus::clear);
  box.shift({0.1, 0.2, 0.75}, {0.1, 0.2, -0.25});  // down
  EXPECT_EQ(ask_within(0.5).status, ImpactStatus::contact);
  EXPECT_LE(ask_within(0.5).upper, 0.125 + 1e-12);  // others, which are farther apart now, touch before
  EXPECT_GT(ask_within(0.5).lower, 0);
  const auto lowest = [](const ElementPair& p) { return p.kind == ElementPair::Kind::vertex_face && p.b == 8; };
  EXPECT_NEAR(ask({.min_separation = 0.5, .separation_fraction = 0.5, .filter = lowest}).upper, 0.125, 1e-12);
  const auto is_contact = [](const Impact& i) { return i.time.status == ImpactStatus::contact; };
  EXPECT_TRUE(visit(is_contact, {.min_separation = 0.5, .separation_fraction = 0.5}).is_complete);
  // Elements that touch at the start still do.
  box.shift({0.1, 0.2, 0.5}, {0.1, 0.2, 1.5});
  EXPECT_EQ(ask_within(0.5).status, ImpactStatus::initial_contact);
}

void expect_state(const ElementState& found, const std::array<VertexId, 4>& vertices, std::uint32_t count_of_a,
                  const std::array<double, 4>& weights, const Vec3& normal) {
  EXPECT_EQ(found.vertices, vertices);
  EXPECT_EQ(found.count_of_a, count_of_a);
  EXPECT_EQ(found.weights, weights);
  EXPECT_EQ(found.normal, normal);
}

TEST(MovingModel, SaysHowElementsLie) {
  MovingBody point(small_mesh({{0, 0, 0}}, {{0, 0, 0}}));
  MovingBody face(small_mesh({{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}}, {{0, 1, 2}}));
  point.shift({0, 0, 1}, {0, 0, -1});
  const ElementPair down{ElementPair::Kind::vertex_face, 0, 0}, up{ElementPair::Kind::face_vertex, 0, 0};
  for (const double time : {0.25, 0.5, 0.75}) {  // before, while they touch, after
    const ElementState found = state_of(point.moving, face.moving, down, time);
    expect_state(found, {0, 0, 1, 2}, 1, {1, 0.5, 0.25, 0.25}, {0, 0, time == 0.75 ? 1.0 : -1.0});
    EXPECT_EQ(found.point_a, (Vec3{0, 0, 1 - 2 * time}));
    EXPECT_EQ(found.point_b, Vec3{});
  }
  expect_state(state_of(face.moving, point.moving, up, 0.25), {0, 1, 2, 0}, 3, {0.5, 0.25, 0.25, 1}, {0, 0, 1});
  MovingBody rods(small_mesh({{-1, 0, 0}, {1, 0, 0}, {0, -1, 1}, {0, 3, 1}}, {{0, 1, 1}, {2, 3, 3}}));
  expect_state(self_state_of(rods.moving, {ElementPair::Kind::edge_edge, 0, 1}, 0), {0, 1, 2, 3}, 2,
               {0.5, 0.5, 0.75, 0.25}, {0, 0, 1});
}

TEST(MovingModel, HasNormalsOfEveryScale) {
  for (const int exponent : {-1000, -540, -365, 0, 150}) {
    const double unit = std::ldexp(1.0, exponent);
    MovingBody box(scaled(cube(), unit)), floor(scaled(plate(), unit));
    box.shift(unit * Vec3{0.1, 0.2, 2.5}, unit * Vec3{0.1, 0.2, -1.5});
    EXPECT_EQ(time_of_impact(box.moving, floor.moving).normal, (Vec3{0, 0, -1})) << exponent;
  }
}

TEST_F(FallingBox, StopsWhenItsBudgetIsSpent) {
  const std::atomic<bool> cancelled{true};
  for (const QueryBudget& budget : {QueryBudget{.max_steps = 0}, QueryBudget{.cancel = &cancelled}}) {
    const StoppedBy reason = budget.cancel != nullptr ? StoppedBy::cancel : StoppedBy::max_steps;
    for (const bool ignore_crossings : {false, true}) {
      const ImpactResult found = ask({.ignore_crossings = ignore_crossings, .budget = budget});
      EXPECT_EQ(found.status, ImpactStatus::undecided);
      EXPECT_EQ(found.stopped_by, reason);
      EXPECT_EQ(found.lower, 0);
      EXPECT_EQ(found.upper, no_time);
    }
    const PairCount count = visit([](const Impact&) { return true; }, {.budget = budget});
    EXPECT_FALSE(count.is_complete);
    EXPECT_EQ(count.stopped_by, reason);
  }
}

TEST(MovingModel, EndsAmongThePairsOfTwoLeaves) {
  MovingBody falls(scenes::grid(12, 12, 0, 0, 1, 1)), floor(scenes::grid(12, 12, 0, 0, 1, 1));
  falls.shift({0, 0, 1}, {0, 0, -1});
  std::atomic<bool> cancelled{false};
  int asked = 0, visited = 0;
  const auto cancels = [&](const ElementPair&) { return ++asked, cancelled = true, false; };
  const ImpactOptions options{.filter = cancels, .budget = {.cancel = &cancelled}};
  const PairCount count = visit_impacts(
      falls.moving, floor.moving, [&](const Impact&) { return ++visited, true; }, options);
  EXPECT_EQ(count.stopped_by, StoppedBy::cancel);
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(visited, 0);
  cancelled = false, asked = 0;
  const ImpactResult found = time_of_impact(falls.moving, floor.moving, options);
  EXPECT_EQ(found.status, ImpactStatus::undecided);
  EXPECT_LE(found.lower, 0.5);  // pairs of the leaves are left
  EXPECT_EQ(asked, 1);
}

TEST(MovingModel, ThatTurnsComparesFewPairs) {
  const auto turned = [](double angle) {
    return Transform{{{std::cos(angle), -std::sin(angle), 0}, {std::sin(angle), std::cos(angle), 0}, {0, 0, 1}}, {}};
  };
  for (const std::uint32_t n : {16U, 32U}) {
    MovingBody sheet(scenes::grid(n, n, 0, 0, 1.0 / n, 1.0 / n));
    for (const double angle : {1.0, 0.5 * std::numbers::pi, 2.0}) {
      sheet.moving.set_motion(sheet.model.mesh().positions(), {}, turned(angle)).value();
      const ImpactResult found = self_time_of_impact(sheet.moving);
      EXPECT_EQ(found.status, ImpactStatus::clear);
      EXPECT_LT(found.stats.primitive_tests, 16 * std::uint64_t{2} * n * n) << n << " by " << angle;
    }
  }
}

using MovingModelMisuse = FallingBox;

TEST_F(MovingModelMisuse, OfPositionsIsAnError) {
  std::vector<Vec3> end(8);
  end[5].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(box.moving.set_motion(end).error().code, ErrorCode::non_finite);
  EXPECT_EQ(box.moving.set_motion(end).error().where, 5U);
  end[5].y = 0x1p201;
  EXPECT_EQ(box.moving.set_motion(end).error().code, ErrorCode::too_large);
  end.pop_back();
  EXPECT_EQ(box.moving.set_motion(end).error().code, ErrorCode::size_mismatch);
  EXPECT_EQ(ask().status, ImpactStatus::contact);  // the motion is as before
}

TEST_F(MovingModelMisuse, OfPosesAndModelsIsRefused) {
  const Transform bad{{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};
  const auto positions = box.model.mesh().positions();
  for (const auto& [start, end] : {std::pair(bad, Transform{}), std::pair(Transform{}, bad)}) {
    EXPECT_TRUE(is_refused([&, s = start, e = end] { static_cast<void>(box.moving.set_motion(positions, s, e)); },
                           {"limber::MovingModel::set_motion", "rigid"}));
  }
  Model gone = std::move(box.model);
  EXPECT_TRUE(is_refused([&] { MovingModel{box.model}; }, {"limber::MovingModel", "moved from"}));
}

TEST_F(MovingModelMisuse, OfAMotionThatHasEndedIsRefused) {
  const auto query = [&] { static_cast<void>(ask()); };
  const auto all = [](const Impact&) { return true; };
  const VertexId moved[] = {0};
  const Vec3 to[] = {{-0.6, -0.6, -0.6}};
  box.model.move_vertices(moved, to).value();
  EXPECT_TRUE(is_refused(query, {"limber::time_of_impact", "motion"}));
  EXPECT_TRUE(is_refused([&] { static_cast<void>(box.moving.set_motion(box.model.mesh().positions())); },
                         {"limber::MovingModel::set_motion", "commit"}));
  box.model.commit();
  EXPECT_TRUE(is_refused(query, {"limber::time_of_impact", "motion"}));
  EXPECT_TRUE(is_refused([&] { static_cast<void>(self_time_of_impact(box.moving)); },
                         {"limber::self_time_of_impact", "motion"}));
  EXPECT_TRUE(is_refused([&] { visit_impacts(floor.moving, box.moving, all); }, {"limber::visit_impacts"}));
  EXPECT_TRUE(is_refused([&] { visit_self_impacts(box.moving, all); }, {"limber::visit_self_impacts"}));
  box.shift({}, {});
  query();
  box.model.rebuild();
  EXPECT_TRUE(is_refused(query, {"limber::time_of_impact", "motion"}));
  box.model.reset(plate());
  EXPECT_TRUE(is_refused(query, {"limber::time_of_impact", "motion"}));
  box.shift({0, 0, 2}, {0, 0, -2});
  EXPECT_EQ(ask().status, ImpactStatus::contact);  // by its new edges
}

TEST_F(MovingModelMisuse, OfNoMotionIsRefused) {
  const MovingModel still(box.model);
  EXPECT_TRUE(is_refused([&] { static_cast<void>(self_time_of_impact(still)); }, {"motion"}));
  MovingModel gone(box.model);
  const MovingModel here = std::move(gone);
  EXPECT_TRUE(is_refused([&] { static_cast<void>(self_time_of_impact(gone)); }, {"moved from"}));
  EXPECT_TRUE(is_refused([&] { static_cast<void>(gone.set_motion({})); }, {"moved from"}));
}

TEST_F(MovingModelMisuse, OfElementsIsRefused) {
  using Kind = ElementPair::Kind;
  for (const ElementPair& wrong : {ElementPair{Kind::vertex_face, 8, 0}, ElementPair{Kind::vertex_face, 0, 18},
                                   ElementPair{Kind::face_vertex, 12, 0}, ElementPair{Kind::face_vertex, 0, 16},
                                   ElementPair{Kind::edge_edge, 18, 0}, ElementPair{Kind::edge_edge, 0, no_id}}) {
    EXPECT_TRUE(is_refused([&] { static_cast<void>(state_of(box.moving, floor.moving, wrong, 0)); },
                           {"limber::state_of", "id"}));
  }
  for (const double time : {-1.0, 1.5, std::nan("")}) {
    EXPECT_TRUE(is_refused(
        [&] {
          static_cast<void>(self_state_of(box.moving, {Kind::edge_edge, 0, 1}, time));
        },
        {"limber::self_state_of", "time"}));
  }
}

TEST_F(MovingModelMisuse, OfOptionsIsRefused) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<const char*, ImpactOptions> bad[] = {
      {"max_time", {.max_time = -0x1p-60}},
      {"max_time", {.max_time = std::nextafter(1.0, 2)}},
      {"max_time", {.max_time = nan}},
      {"time_error", {.time_error = -1}},
      {"time_error", {.time_error = nan}},
      {"min_separation", {.min_separation = -1}},
      {"min_separation", {.min_separation = nan}},
      {"min_separation", {.min_separation = no_time}},
      {"separation_fraction", {.separation_fraction = 1}},
      {"separation_fraction", {.separation_fraction = -0.5}},
  };
  const auto all = [](const Impact&) { return true; };
  const MovingModel& moving = box.moving;
  for (const auto& [what, options] : bad) {
    const ImpactOptions& o = options;
    EXPECT_TRUE(is_refused([&] { static_cast<void>(ask(o)); }, {"limber::time_of_impact", what}));
    EXPECT_TRUE(is_refused([&] { static_cast<void>(self_time_of_impact(moving, o)); }, {"self_time_of_impact", what}));
    EXPECT_TRUE(is_refused([&] { visit(all, o); }, {"limber::visit_impacts", what}));
    EXPECT_TRUE(is_refused([&] { visit_self_impacts(moving, all, o); }, {"limber::visit_self_impacts", what}));
  }
}

}  // namespace
}  // namespace limber::testing
