// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <sstream>

#include "formats/scenes.h"
#include "limber/model.h"
#include "limber/points.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

std::string csv_of(const std::vector<Vec3>& points, const std::string& header) {
  std::ostringstream text;
  text.precision(17);
  text << header;
  for (const Vec3& p : points) text << p.x << ',' << p.y << ',' << p.z << '\n';
  return text.str();
}

std::vector<Vec3> some_points(std::size_t count) {
  scenes::Rng rng(31);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)};
  return points;
}

TEST(ProgramPoints, AnswersEachRowAsTheLibraryDoes) {
  const Folder folder;
  const Mesh mesh = scenes::ball(12, 7);
  const std::string model = folder.store("ball.obj", mesh.view());
  const std::vector<Vec3> points = some_points(300);
  const std::string file = folder.store("points.csv", csv_of(points, "x,y,z\n"));
  const Transform pose{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {0.5, 0.25, 0}};
  const std::string line =
      "points " + model + ' ' + file +
      " --pose 0.5,0.25,0,0.5,0.5,0.5,0.5 --max-distance 1.25 --signed --generalized-winding-number";
  const std::vector<nlohmann::json> objects = json_rows_of(line);
  ASSERT_EQ(objects.size(), points.size());
  const Model ball(mesh);
  const ClosedSurface surface = ClosedSurface::create(ball).value();
  int beyond = 0, inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    SCOPED_TRACE(i);
    const nlohmann::json& object = objects[i];
    const SignedDistance truth = surface.signed_distance(points[i], pose, {.max_distance = 1.25});
    EXPECT_EQ(object["row"], i);
    EXPECT_EQ(point_of(object["point"]), points[i]);
    EXPECT_EQ(object["is_inside"], truth.is_inside);
    EXPECT_NEAR(object["generalized_winding_number"].get<double>(), truth.is_inside ? 1 : 0, 1e-12);
    inside += truth.is_inside ? 1 : 0;
    if (!truth.closest) {
      ++beyond;
      EXPECT_TRUE(object["distance"].is_null() && object["closest"].is_null());
      continue;
    }
    EXPECT_EQ(object["distance"], truth.distance());
    EXPECT_EQ(point_of(object["closest"]["position"]), truth.closest->position);
    EXPECT_EQ(object["closest"]["triangle"], truth.closest->triangle);
    EXPECT_EQ(object["closest"]["face"], truth.closest->triangle);
    EXPECT_EQ(point_of(object["closest"]["weights"]), truth.closest->weights);
  }
  EXPECT_GT(beyond, 10);
  EXPECT_GT(inside, 5);
}

TEST(ProgramPoints, ReadsColumnsInAnyOrderOrNone) {
  const Folder folder;
  const std::string plain = folder.store("plain.csv", "# no names\n0,0,3\n\n1,2,3\n");
  const std::string named = folder.store("named.csv", "id,z,x,y\r\na,3,0,0\r\nb,3,1,2\r\n");
  const std::string answer = answer_to("points scene:ball " + plain);
  EXPECT_EQ(lines_of(answer)[1], "0,0,0,3,2,0,0,1,0,0,vertex 0,1,0,0");
  EXPECT_EQ(answer_to("points scene:ball " + named), answer);
}

}  // namespace
}  // namespace limber::program_tests
