// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// One model: `limber info` and `limber points`.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "limber/model.h"
#include "limber/points.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

TEST(ProgramInfo, CountsWhatAMeshIsMadeOf) {
  const Folder folder;
  // A unit square of two triangles, a copy of one turned over, a third triangle at their common edge, one segment-like
  // triangle apart from all others, a stray vertex. The last vertex repeats the first.
  const std::string file = folder.store("odd.obj",
                                        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 2\n"
                                        "v 5 5 5\nv 6 6 6\nv 7 7 7\nv 100 0 0\nv 0 0 0\n"
                                        "f 1 2 3 4\nf 3 2 10\nf 1 3 5\nf 6 7 8\n");
  const nlohmann::json json = json_of("info " + file);
  EXPECT_EQ(json["query"], "info");
  for (const auto& [key, count] : {std::pair{"vertices", 9},
                                   {"triangles", 5},
                                   {"faces", 4},
                                   {"open_edges", 2 + 2 + 3},
                                   {"non_manifold_edges", 1},
                                   {"degenerate_triangles", 1},
                                   {"duplicate_triangles", 1},
                                   {"unreferenced_vertices", 1}}) {
    EXPECT_EQ(json[key], count) << key;
  }
  EXPECT_EQ(json["extent"]["low"], (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(json["extent"]["high"], (std::vector<double>{7, 7, 7}));
  EXPECT_DOUBLE_EQ(json["extent"]["diagonal"].get<double>(), std::sqrt(147.0));
  EXPECT_EQ(json["closed"], false);
  for (const char* const key : {"nodes", "leaves", "levels"}) EXPECT_EQ(json["tree"][key], 1) << key;
}

TEST(ProgramInfo, TellsOfEachPart) {
  const Folder folder;
  const std::string file = folder.store("parts.obj",
                                        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                        "o lid\nf 1 2 3\no pot\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const nlohmann::json parts = json_of("info " + file)["parts"];
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0]["name"], "lid");
  EXPECT_EQ(parts[0]["extent"]["high"], (std::vector<double>{1, 1, 0}));
  EXPECT_EQ(parts[0]["closed"], false);
  EXPECT_EQ(parts[1]["triangles"], 4);
  EXPECT_EQ(parts[1]["closed"], true);
  EXPECT_NE(answer_to("info " + file).find("  pot: 4 triangles, 0 0 0 to 1 1 1, closed\n"), std::string::npos);
}

TEST(ProgramInfo, TellsNearlyDegenerateFromDegenerate) {
  const Folder folder;
  const std::string file = folder.store("thin.obj",
                                        "v 0 0 0\nv 1 1 0\nv 2 2 0\nv 2 2.0000000000000004 0\n"
                                        "f 1 2 3\nf 1 2 4\nf 1 1 1\n");
  EXPECT_EQ(json_of("info " + file)["degenerate_triangles"], 2);
}

TEST(ProgramInfo, FindsNothingWrongWithBuiltInMeshes) {
  const nlohmann::json json = json_of("info scene:ball");
  for (const auto& [key, count] : {std::pair{"triangles", 1024},
                                   {"vertices", 514},
                                   {"open_edges", 0},
                                   {"non_manifold_edges", 0},
                                   {"degenerate_triangles", 0},
                                   {"duplicate_triangles", 0},
                                   {"unreferenced_vertices", 0}}) {
    EXPECT_EQ(json[key], count) << key;
  }
  EXPECT_EQ(json["closed"], true);
  EXPECT_EQ(json["tree"]["levels"], 4);
  EXPECT_EQ(json["tree"]["nodes"], 128 + 16 + 2 + 1);
  EXPECT_EQ(json["tree"]["leaves"], 128);
  EXPECT_DOUBLE_EQ(json["tree"]["bytes_per_triangle"].get<double>(), json["tree"]["bytes"].get<double>() / 1024);
  const std::string text = answer_to("info scene:sheet");
  for (const char* line : {"vertices               10201\n", "triangles              20000\n",
                           "open edges             400\n", " of them leaves\n", "extent high            100 100 0\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
}

TEST(ProgramPoints, AnswersEachRowAsTheLibraryDoes) {
  const Folder folder;
  const Mesh mesh = scenes::ball(12, 7);
  const std::string model = folder.store("ball.obj", mesh.view());
  scenes::Rng rng(31);
  std::vector<Vec3> points(4200);
  std::ostringstream text;
  text.precision(17);
  text << "x,y,z\n";
  for (Vec3& p : points) {
    p = {rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)};
    text << p.x << ',' << p.y << ',' << p.z << '\n';
  }
  const std::string file = folder.store("points.csv", text.str());
  const Transform pose{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {0.5, 0.25, 0}};
  const std::string line =
      "points " + model + ' ' + file + " --pose 0.5,0.25,0,0.5,0.5,0.5,0.5 --max-distance 1.25 --signed";
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
