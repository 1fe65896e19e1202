// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <sstream>

#include "program/run_program.h"
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
  const Words words = {"points",         model,  file,       "--pose",          "0.5,0.25,0,0.5,0.5,0.5,0.5",
                       "--max-distance", "1.25", "--signed", "--winding-number"};
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(lines_of(outcome.out).front(),
            "row,x,y,z,distance,closest_x,closest_y,closest_z,triangle,face,feature,weight_0,weight_1,weight_2,"
            "inside,winding_number");
  Words json_words = words;
  json_words.emplace_back("--json");
  const std::vector<Row> rows = table_of(outcome.out);
  const std::vector<nlohmann::json> objects = json_lines_of(run(json_words));
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
    EXPECT_EQ(row.at("inside"), is_inside ? "true" : "false");
    EXPECT_EQ(object["inside"], is_inside);
    EXPECT_NEAR(number(row.at("winding_number")), is_inside ? 1 : 0, 1e-12);
    EXPECT_EQ(object["winding_number"], number(row.at("winding_number")));
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
    EXPECT_EQ(object["closest"]["point"][0], truth.closest->position.x);
    EXPECT_EQ(row.at("triangle"), std::to_string(truth.closest->triangle));
    EXPECT_EQ(object["closest"]["face"], std::stoi(row.at("face")));
    EXPECT_EQ(object["closest"]["feature"], row.at("feature"));
    EXPECT_EQ(number(row.at("weight_1")), truth.closest->barycentric[1]);
    EXPECT_EQ(object["closest"]["weights"][1], truth.closest->barycentric[1]);
  }
  EXPECT_GT(beyond, 10);
  EXPECT_GT(inside, 5);
}

TEST(ProgramPoints, ReadsColumnsInAnyOrderOrNone) {
  const Folder folder;
  const std::string plain = folder.store("plain.csv", "# no names\n0,0,3\n\n1,2,3\n");
  const std::string named = folder.store("named.csv", "id,z,x,y\r\na,3,0,0\r\nb,3,1,2\r\n");
  const Outcome answer = run({"points", "scene:ball", plain});
  EXPECT_EQ(answer.exit_code, 0);
  EXPECT_EQ(lines_of(answer.out)[1], "0,0,0,3,2,0,0,1,0,0,vertex 0,1,0,0");
  EXPECT_EQ(run({"points", "scene:ball", named}).out, answer.out);
}

TEST(ProgramPoints, WritesManyPointsInOrderIntoAFile) {
  const Folder folder;
  const std::vector<Vec3> points = some_points(10'000);
  const std::string file = folder.store("points.csv", csv_of(points, "")), out = folder.path("out.csv");
  EXPECT_EQ(run({"points", "scene:ball", file, "--out", out}).out, "");
  const std::vector<std::string> lines = lines_of(text_of(out));
  ASSERT_EQ(lines.size(), points.size() + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(lines[i + 1].starts_with(std::to_string(i) + ',')) << i;
    ASSERT_EQ(number(cells_of(lines[i + 1])[3]), points[i].z) << i;
  }
}

TEST(ProgramPoints, RefusesWhatMeansNothing) {
  const Folder folder;
  const std::string good = folder.store("good.csv", "0,0,3\n");
  const auto expect_refused_file = [&](const std::string& text, const std::string& part) {
    expect_refused({"points", "scene:ball", folder.store("bad.csv", text)}, part);
  };
  expect_refused_file("", "has no point");
  expect_refused_file("x,y,z\n", "has no point");
  expect_refused_file("x,y\n1,2\n", "line 1: there is no column z");
  expect_refused_file("0,0,0\n1,2\n", "line 2: a point is 3 numbers x,y,z, not 2");
  expect_refused_file("x,y,z\n0,0,0\n1,2,a\n", "line 3: column z: 'a' is not a number");
  expect_refused_file("0,nan,0\n", "line 1: column y: 'nan' is not a number of at most 2^200");
  expect_refused_file("1e61,0,0\n", "line 1: column x");
  expect_refused({"points", "scene:ball", folder.path("none.csv")}, "none.csv");
  expect_refused({"points", "scene:ball", good, "--max-distance", "-1"}, "--max-distance: must be a number >= 0");
  expect_refused({"points", "scene:ball", good, "--out", good}, "--out: " + good + " is one of the inputs");
  expect_refused({"points", "scene:square", good, "--signed"},
                 "--signed: scene:square: the surface is not closed: the edge of triangle 0 between vertices 0 and 1 "
                 "belongs to no other triangle");
  EXPECT_EQ(text_of(good), "0,0,3\n");
}

}  // namespace
}  // namespace limber::program_tests
