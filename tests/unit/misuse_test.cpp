// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Mistakes of callers are refused in every build. They never cause a wrong answer, a hang or a crash.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "limber/distance.h"
#include "scenes/scenes.h"
#include "support/engines.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

template <typename Engine>
class Misuse : public ::testing::Test, public Asking<Engine> {
 protected:
  typename Asking<Engine>::Model a_{scenes::ball(6, 4)}, b_{scenes::ball(5, 3)};
};

TYPED_TEST_SUITE(Misuse, Engines);

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
  for (const double bad : {not_a_number, infinite, -infinite}) {
    for (std::size_t i = 0; i < 12; ++i) {
      Transform pose;
      Vec3* const rows[] = {&pose.rotation.row0, &pose.rotation.row1, &pose.rotation.row2, &pose.translation};
      (*rows[i / 3])[i % 3] = bad;
      poses.emplace_back(std::to_string(bad) + " as number " + std::to_string(i), pose);
    }
  }
  return poses;
}

TYPED_TEST(Misuse, OfPosesIsRefused) {
  for (const auto& [what, pose] : bad_poses()) {
    EXPECT_THROW(static_cast<void>(this->distance(this->a_, this->b_, pose)), std::invalid_argument) << what;
    EXPECT_THROW(static_cast<void>(this->distance(this->a_, this->b_, {}, {}, pose)), std::invalid_argument) << what;
    EXPECT_THROW(static_cast<void>(this->collide(this->a_, this->b_, pose)), std::invalid_argument) << what;
    EXPECT_THROW(static_cast<void>(this->within(this->a_, this->b_, 1, {}, pose)), std::invalid_argument) << what;
  }
}

TYPED_TEST(Misuse, OfOptionsIsRefused) {
  const auto ask = [&](const DistanceOptions& options) { return this->distance(this->a_, this->b_, {}, options); };
  for (const double bad : {not_a_number, -1.0, -0x1p-1074, infinite, -infinite}) {
    EXPECT_THROW(static_cast<void>(ask({.relative_error = bad})), std::invalid_argument) << bad;
    EXPECT_THROW(static_cast<void>(ask({.absolute_error = bad})), std::invalid_argument) << bad;
    EXPECT_THROW(static_cast<void>(this->within(this->a_, this->b_, bad)), std::invalid_argument) << bad;
    if (bad != infinite) {
      EXPECT_THROW(static_cast<void>(ask({.max_distance = bad})), std::invalid_argument) << bad;
    }
  }
  EXPECT_NO_THROW(static_cast<void>(ask({.max_distance = infinite})));
  EXPECT_NO_THROW(static_cast<void>(ask({.relative_error = -0.0, .absolute_error = -0.0, .max_distance = -0.0})));
}

TYPED_TEST(Misuse, IsExplainedInOneLine) {
  try {
    static_cast<void>(this->distance(this->a_, this->b_, {{}, {not_a_number, 0, 0}}));
    FAIL();
  } catch (const std::invalid_argument& thrown) {
    const std::string text = thrown.what();
    EXPECT_NE(text.find("pose"), std::string::npos) << text;
    EXPECT_NE(text.find("limber"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

template <typename Engine>
class MovingMisuse : public Misuse<Engine> {};
TYPED_TEST_SUITE(MovingMisuse, MovingEngines);

TYPED_TEST(MovingMisuse, QueriesOfUncommittedModelsAreRefused) {
  const std::vector<VertexId> ids{0};
  const std::vector<Vec3> positions{{0, 0, 3}};
  ASSERT_TRUE(static_cast<bool>(this->a_.move_vertices(ids, positions)));
  EXPECT_THROW(static_cast<void>(this->distance(this->a_, this->b_)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(this->distance(this->b_, this->a_)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(this->collide(this->a_, this->b_)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(this->within(this->b_, this->a_, 1)), std::invalid_argument);
  this->a_.commit();
  EXPECT_NO_THROW(static_cast<void>(this->distance(this->a_, this->b_)));
}

TEST(MisuseOfGeometry, NumbersOutOfRangeAreRefused) {
  const Triangle good{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Segment edge{{0, 0, 0}, {1, 0, 0}};
  for (const double bad : {not_a_number, infinite, -infinite, 0x1p201}) {
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

}  // namespace
}  // namespace limber::testing
