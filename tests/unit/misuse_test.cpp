// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Mistakes of callers are refused in every build. They never cause a wrong answer, a hang or a crash.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/scenes.h"
#include "unit/refusals.h"

namespace limber::testing {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct Misuse : ::testing::Test {
  Model a{scenes::ball(6, 4)}, b{scenes::ball(5, 3)};
};

/// Poses that are no rigid motions, each for one reason.
std::vector<std::pair<std::string, Transform>> bad_poses() {
  std::vector<std::pair<std::string, Transform>> poses{
      {"zero", {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {}}},
      {"scaled", {{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {}}},
      {"reflected", {{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, {}}},
      {"sheared", {{{1, 1e-6, 0}, {0, 1, 0}, {0, 0, 1}}, {}}},
      {"third row too long", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1 + 1e-6}}, {}}},
      {"third row turned", {{{1, 0, 0}, {0, 1, 0}, {0, 1, 0}}, {}}},
      {"translation too large", {{}, {0, 0x1p201, 0}}},
  };
  for (const double bad : {not_a_number, unbounded, -unbounded}) {
    for (std::size_t i = 0; i < 12; ++i) {
      Transform pose;
      Vec3* const rows[] = {&pose.rotation.row0, &pose.rotation.row1, &pose.rotation.row2, &pose.translation};
      (*rows[i / 3])[i % 3] = bad;
      poses.emplace_back(std::to_string(bad) + " as number " + std::to_string(i), pose);
    }
  }
  return poses;
}

// Embree #300: what is no number goes through minima and maxima in one way on one instruction set and in another way on
// others. Every entrance refuses it here.
TEST_F(Misuse, OfPosesIsRefused) {
  for (const auto& [what, pose] : bad_poses()) {
    EXPECT_THROW(static_cast<void>(distance({a}, {b, pose})), std::invalid_argument) << what;
    EXPECT_THROW(static_cast<void>(distance({a, pose}, {b})), std::invalid_argument) << what;
    EXPECT_THROW(static_cast<void>(collide({a}, {b, pose})), std::invalid_argument) << what;
    EXPECT_THROW(static_cast<void>(within({a, pose}, {b}, 1)), std::invalid_argument) << what;
  }
}

TEST_F(Misuse, OfOptionsIsRefused) {
  const auto ask = [&](const DistanceOptions& options) { return distance({a}, {b}, options); };
  for (const double bad : {not_a_number, -1.0, -0x1p-1074, unbounded, -unbounded}) {
    EXPECT_THROW(static_cast<void>(ask({.relative_error = bad})), std::invalid_argument) << bad;
    EXPECT_THROW(static_cast<void>(ask({.absolute_error = bad})), std::invalid_argument) << bad;
    EXPECT_THROW(static_cast<void>(within({a}, {b}, bad)), std::invalid_argument) << bad;
    if (bad != unbounded) {
      EXPECT_THROW(static_cast<void>(ask({.max_distance = bad})), std::invalid_argument) << bad;
    }
  }
  EXPECT_NO_THROW(static_cast<void>(ask({.max_distance = unbounded})));
  EXPECT_NO_THROW(static_cast<void>(ask({.relative_error = -0.0, .absolute_error = -0.0, .max_distance = -0.0})));
}

TEST_F(Misuse, IsExplainedInOneLine) {
  const auto ask = [&] { static_cast<void>(distance({a}, {b, {{}, {not_a_number, 0, 0}}})); };
  EXPECT_TRUE(is_refused(ask, {"pose", "limber"}));
  EXPECT_FALSE(is_refused(ask, {"\n"}));
}

TEST_F(Misuse, ByQueriesOfUncommittedModelsIsRefused) {
  a.move_all(a.mesh().positions()).value();
  EXPECT_THROW(static_cast<void>(distance({a}, {b})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(distance({b}, {a})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(collide({a}, {b})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(within({b}, {a}, 1)), std::invalid_argument);
  a.commit();
  EXPECT_NO_THROW(static_cast<void>(distance({a}, {b})));
}

TEST(MisuseOfGeometry, NumbersOutOfRangeAreRefused) {
  const Triangle good{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Segment edge{{0, 0, 0}, {1, 0, 0}};
  for (const double bad : {not_a_number, unbounded, -unbounded, 0x1p201}) {
    const Vec3 point{0, bad, 0};
    const Triangle triangle{{0, 0, 0}, point, {1, 0, 0}};
    EXPECT_THROW(static_cast<void>(closest_points(good, triangle)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(closest_points(triangle, good)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(closest_features(good, triangle)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(contact(triangle, good)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(closest_points(point, good)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(closest_points(Vec3{}, triangle)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(closest_points(edge, Segment{point, {}})), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(closest_points(Segment{{}, point}, edge)), std::invalid_argument);
    if (bad == 0x1p201) continue;  // exact for all finite numbers
    EXPECT_THROW(intersects(good, triangle), std::invalid_argument);
    EXPECT_THROW(intersects(edge, triangle), std::invalid_argument);
    EXPECT_THROW(intersects(Segment{point, {}}, good), std::invalid_argument);
    EXPECT_THROW(orient3d(point, {}, {1, 0, 0}, {0, 1, 0}), std::invalid_argument);
    EXPECT_THROW(orient2d({}, {1, 0, 0}, point, 0), std::invalid_argument);
  }
  EXPECT_THROW(orient2d({}, {1, 0, 0}, {0, 1, 0}, 3), std::invalid_argument);
}

/// Expects that a call of a function is refused, as its model has been moved from.
template <typename Call>
void is_gone(const std::string& function, const Call& call) {
  EXPECT_TRUE(is_refused(call, {"limber::Model::" + function + ": the model has been moved from"}));
}

TEST(ModelMisuse, OfAModelThatWasMovedFromIsRefused) {
  for (const bool has_moved : {false, true}) {
    Model model(scenes::ball(12, 7));
    if (has_moved) model.move_all(scenes::ball(12, 7).positions()).value();
    const Model other(std::move(model));
    const Model& gone = model;
    EXPECT_TRUE(other.is_valid());
    EXPECT_FALSE(gone.is_valid());
    EXPECT_FALSE(gone.is_committed());
    is_gone("move_vertices", [&] { (void)model.move_vertices({}, {}); });
    is_gone("move_all", [&] { (void)model.move_all({}); });
    is_gone("commit", [&] { model.commit(); });
    is_gone("mesh", [&] { (void)gone.mesh(); });
    is_gone("options", [&] { (void)gone.options(); });
    is_gone("maintenance_stats", [&] { (void)gone.maintenance_stats(); });
    is_gone("tree_stats", [&] { (void)gone.tree_stats(); });
    is_gone("validate", [&] { (void)gone.validate(); });
    is_gone("rebuild", [&] { model.rebuild(); });
    is_gone("set_motion_margin", [&] { model.set_motion_margin(1); });
  }
}

TEST(ModelMisuse, OfAModelThatWasMovedFromEndsWhenItIsAssignedTo) {
  Model model(scenes::ball(12, 7)), other(std::move(model));
  model = Model(scenes::grid(6, 6, -3, -3, 1, 1));
  EXPECT_TRUE(model.is_committed());
  EXPECT_EQ(model.mesh().triangles().size(), 72U);
  EXPECT_TRUE(static_cast<bool>(model.validate()));
  // In the other direction, and from a model that has been moved from.
  other = std::move(model);
  EXPECT_EQ(other.mesh().triangles().size(), 72U);
  other = std::move(model);
  EXPECT_FALSE(other.is_valid());
  // Moves that are not committed yet are taken along.
  Model moved(scenes::ball(12, 7));
  const std::vector<Vec3> to{{3, 0, 0}};
  moved.move_vertices(std::vector<VertexId>{7}, to).value();
  other = std::move(moved);
  EXPECT_FALSE(other.is_committed());
  other.commit();
  EXPECT_EQ(other.mesh().positions()[7], to[0]);
  // To itself.
  Model& same = other;
  other = std::move(same);
  ASSERT_TRUE(other.is_valid());
  EXPECT_EQ(other.mesh().positions()[7], to[0]);
  EXPECT_TRUE(static_cast<bool>(other.validate()));
}

TEST(ModelMisuse, OfAModelThatWasMovedFromEndsWithReset) {
  Model model(scenes::ball(12, 7), {.motion_margin = 0.5});
  model.move_all(model.mesh().positions()).value();
  Model other(std::move(model));
  other.reset(scenes::ball(6, 4));
  EXPECT_EQ(other.options().motion_margin, 0.5);
  EXPECT_EQ(other.maintenance_stats().moved_vertices, 0U);
  model.reset(scenes::grid(6, 6, -3, -3, 1, 1));
  EXPECT_TRUE(model.is_committed());
  EXPECT_EQ(model.options().motion_margin, 0);  // the default: the options were moved away too
  EXPECT_EQ(model.mesh().triangles().size(), 72U);
  EXPECT_TRUE(static_cast<bool>(model.validate()));
}

TEST(ModelMisuse, OfAMeshThatWasMovedFromIsRefused) {
  Mesh mesh = scenes::ball(12, 7);
  const Mesh taken = std::move(mesh);
  EXPECT_TRUE(is_refused([&] { Model(std::move(mesh)); }, {"the mesh has been moved from"}));
  Model model(taken);
  EXPECT_TRUE(is_refused([&] { model.reset(std::move(mesh)); }, {"the mesh has been moved from"}));
  EXPECT_EQ(model.mesh().positions(), taken.positions());
  EXPECT_TRUE(model.is_committed());
}

TEST(ModelMisuse, OfOptionsIsRefused) {
  const Mesh mesh = scenes::ball(12, 7);
  for (const double bad : {double{NAN}, -0.5, -2.0, double{INFINITY}, double{-INFINITY}}) {
    EXPECT_TRUE(is_refused([&] { Model(mesh, {.motion_margin = bad}); }, {"limber::Model: options.motion_margin"}));
    EXPECT_TRUE(
        is_refused([&] { Model(mesh, {.rebuild_budget_us = bad}); }, {"limber::Model: options.rebuild_budget_us"}));
    for (const bool has_moved : {false, true}) {
      Model model(mesh, {.motion_margin = 0.25});
      if (has_moved) model.move_all(mesh.positions()).value();
      EXPECT_TRUE(is_refused([&] { model.set_motion_margin(bad); }, {"limber::Model::set_motion_margin: the margin"}));
      EXPECT_EQ(model.options().motion_margin, 0.25);
      EXPECT_EQ(model.maintenance_stats().motion_margin, 0.25);
      EXPECT_EQ(model.is_committed(), !has_moved);
    }
  }
}

// ifc-lite PR #3561: one vertex that is no number makes all boxes up to the root such, and nothing is found any more.
TEST(ModelMisuse, ByUpdatesIsRefusedAndChangesNothing) {
  Model model(scenes::ball(12, 7));
  const std::vector<Vec3> before = model.mesh().positions();
  const auto count = static_cast<VertexId>(before.size());
  const std::vector<VertexId> one{0}, pair{0, 1}, beyond{0, count};
  const std::vector<Vec3> two{{0, 0, 1}, {0, 0, 1}}, none{{0, 0, 1}, {0, NAN, 0}}, huge{{1e70, 0, 1}};
  std::vector<Vec3> all = before;
  all[5].x = INFINITY;
  const auto expect_refused = [&](const Result<void>& result, ErrorCode code, const std::string& text) {
    ASSERT_FALSE(static_cast<bool>(result));
    EXPECT_EQ(result.error().code, code);
    EXPECT_EQ(result.error().text, text);
    EXPECT_EQ(model.mesh().positions(), before);
    EXPECT_TRUE(model.is_committed());
    EXPECT_EQ(model.maintenance_stats().moved_vertices, 0U);
  };
  const std::string n = std::to_string(count);
  expect_refused(model.move_vertices(beyond, two), ErrorCode::index_out_of_range,
                 "entry 1 of the update names vertex " + n + ", but there are only " + n);
  expect_refused(model.move_vertices(one, two), ErrorCode::size_mismatch, "2 positions for 1 ids");
  expect_refused(model.move_vertices(pair, none), ErrorCode::non_finite, "entry 1 of the update is not finite");
  expect_refused(model.move_vertices(one, huge), ErrorCode::too_large,
                 "entry 0 of the update has a coordinate above the limit of 2^200");
  expect_refused(model.move_all(two), ErrorCode::size_mismatch, "2 positions for " + n + " vertices");
  expect_refused(model.move_all(all), ErrorCode::non_finite, "entry 5 of the update is not finite");
}

/// Ids and positions of an update that moves every vertex but one to the position of its neighbour, the previous one or
/// the next one.
struct Shift {
  std::vector<VertexId> ids;
  std::span<const Vec3> own;
  std::vector<Vec3> expected;

  Shift(const Mesh& mesh, bool forwards) : ids(mesh.positions().size() - 1), own(mesh.positions()) {
    std::iota(ids.begin(), ids.end(), forwards ? 1U : 0U);
    own = forwards ? own.first(ids.size()) : own.last(ids.size());
    expected = mesh.positions();
    const std::vector<Vec3> copy(own.begin(), own.end());
    for (std::size_t i = 0; i < ids.size(); ++i) expected[ids[i]] = copy[i];
  }
};

TEST(ModelMisuse, IsNotToMoveVerticesToPositionsOfTheModelItself) {
  for (const bool forwards : {true, false}) {
    Model model(scenes::ball(12, 7));
    const Shift shift(model.mesh(), forwards);
    model.move_vertices(shift.ids, shift.own).value();
    EXPECT_EQ(model.mesh().positions(), shift.expected);
    model.move_all(model.mesh().positions()).value();
    EXPECT_EQ(model.mesh().positions(), shift.expected);
    // Ids may be those of the model's own triangles.
    const Corners& corners = model.mesh().triangles()[5];
    const std::vector<Vec3> to{{1, 2, 3}, {2, 3, 1}, {3, 1, 2}};
    model.move_vertices(corners, to).value();
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(model.mesh().positions()[corners[k]], to[k]);
    model.commit();
    EXPECT_TRUE(static_cast<bool>(model.validate()));
  }
}

TEST(ModelMisuse, IsNotToReplacePositionsByThoseOfTheMeshItself) {
  for (const bool forwards : {true, false}) {
    Mesh mesh = scenes::ball(12, 7);
    const Shift shift(mesh, forwards);
    mesh.set_positions(shift.ids, shift.own).value();
    EXPECT_EQ(mesh.positions(), shift.expected);
    mesh.set_positions(mesh.positions()).value();
    EXPECT_EQ(mesh.positions(), shift.expected);
  }
}

}  // namespace
}  // namespace limber::testing
