// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <sstream>

#include "run_program.h"
#include "reference/reference.h"
#include "scenes/scenes.h"

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

TEST(ProgramPoints, AnswersEachRowAsBruteForceDoes) {
  const Folder folder;
  const Mesh mesh = scenes::ball(12, 7);
  const std::string model = folder.store("ball.obj", mesh.view());
  const std::vector<Vec3> points = some_points(300);
  const std::string file = folder.store("points.csv", csv_of(points, "x,y,z\n"));
  const Transform pose{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {0.5, 0.25, 0}};
  const std::string line =
      "points " + model + ' ' + file +
      " --pose 0.5,0.25,0,0.5,0.5,0.5,0.5 --max-distance 1.25 --signed --generalized-winding-number";
  const std::string csv = answer_to(line);
  EXPECT_EQ(lines_of(csv).front(),
            "row,x,y,z,distance,closest_x,closest_y,closest_z,triangle,face,feature,weight_0,weight_1,weight_2,"
            "is_inside,generalized_winding_number");
  const std::vector<Row> rows = table_of(csv);
  const std::vector<nlohmann::json> objects = json_lines_of(run(line + " --json"));
  ASSERT_EQ(rows.size(), points.size());
  ASSERT_EQ(objects.size(), points.size());
  int beyond = 0, inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    SCOPED_TRACE(i);
    const Row& row = rows[i];
    const nlohmann::json& object = objects[i];
    const PointResult truth = reference::closest_point({mesh, pose}, points[i], {.max_distance = 1.25});
    const bool is_inside = reference::contains({mesh, pose}, points[i]);
    inside += is_inside ? 1 : 0;
    EXPECT_EQ(row.at("row"), std::to_string(i));
    EXPECT_EQ(object["row"], i);
    EXPECT_EQ(number(row.at("y")), points[i].y);
    EXPECT_EQ(object["point"][2], points[i].z);
    EXPECT_EQ(row.at("is_inside"), is_inside ? "true" : "false");
    EXPECT_EQ(object["is_inside"], is_inside);
    EXPECT_NEAR(number(row.at("generalized_winding_number")), is_inside ? 1 : 0, 1e-12);
    EXPECT_EQ(object["generalized_winding_number"], number(row.at("generalized_winding_number")));
    if (!truth.closest) {
      ++beyond;
      for (const char* name : {"distance", "closest_x", "triangle", "face", "feature", "weight_2"}) {
        EXPECT_EQ(row.at(name), "") << name;
      }
      EXPECT_TRUE(object["distance"].is_null() && object["closest"].is_null());
      continue;
    }
    const double distance = is_inside ? -truth.closest->distance : truth.closest->distance;
    EXPECT_EQ(number(row.at("distance")), distance);
    EXPECT_EQ(object["distance"], distance);
    EXPECT_EQ(number(row.at("closest_z")), truth.closest->position.z);
    EXPECT_EQ(object["closest"]["position"][0], truth.closest->position.x);
    EXPECT_EQ(row.at("triangle"), std::to_string(truth.closest->triangle));
    EXPECT_EQ(object["closest"]["face"], std::stoi(row.at("face")));
    EXPECT_EQ(object["closest"]["feature"], row.at("feature"));
    EXPECT_EQ(number(row.at("weight_1")), truth.closest->weights[1]);
    EXPECT_EQ(object["closest"]["weights"][1], truth.closest->weights[1]);
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

TEST(ProgramPoints, WritesManyPointsInOrderIntoAFile) {
  const Folder folder;
  const std::vector<Vec3> points = some_points(10'000);
  const std::string file = folder.store("points.csv", csv_of(points, "")), out = folder.path("out.csv");
  EXPECT_EQ(answer_to("points scene:ball " + file + " --out " + out), "");
  const std::vector<Row> rows = table_of(text_of(out));
  ASSERT_EQ(rows.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(rows[i].at("row"), std::to_string(i));
    ASSERT_EQ(number(rows[i].at("z")), points[i].z) << i;
  }
}

}  // namespace
}  // namespace limber::program_tests
