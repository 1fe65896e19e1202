// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "limber/model.h"
#include "limber/points.h"
#include "page_decoding.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

std::vector<Vec3> placed(MeshView mesh, const Transform& pose) {
  std::vector<Vec3> points;
  for (const Vec3& p : mesh.positions) points.push_back(pose(p));
  return points;
}

void expect_near(const Vec3& found, const Vec3& expected, const nlohmann::json& step) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(found[axis], expected[axis], 0.5001 * step[axis].get<double>() + 1e-15 * std::abs(expected[axis]));
  }
}

double area(const Triangle& t) { return length(cross(t.v1 - t.v0, t.v2 - t.v0)) / 2; }

TEST(ProgramReport, HoldsMeshesThatNeedNoPartsWithinHalfAStep) {
  const Folder folder;
  const Mesh a = scenes::ball(24, 20), b = scenes::ball(16, 9);
  const Report report("distance " + folder.store("a.obj", a) + ' ' + folder.store("b.obj", b) +
                      " --pose-b 40,30,-20,0.3,-0.4,0.5,0.6");
  const Transform pose = transform_from_quaternion({40, 30, -20}, 0.3, -0.4, 0.5, 0.6).value();
  for (const auto& [m, mesh, world_from_mesh] : {std::tuple(0, &a, Transform{}), std::tuple(1, &b, pose)}) {
    const nlohmann::json& model = report.data["models"][m];
    EXPECT_FALSE(model.contains("parts"));
    EXPECT_EQ(model["triangles"], mesh->triangles().size());
    EXPECT_EQ(model["vertices"], mesh->positions().size());
    EXPECT_EQ(model["closed"], true);
    const std::vector<Vec3> found = points_of(model["positions"]), expected = placed(*mesh, world_from_mesh);
    const std::vector<Corners> triangles = corners_of(model["corners"]);
    ASSERT_EQ(triangles.size(), mesh->triangles().size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t i = 0; i < 3; ++i) {
        expect_near(found.at(triangles[t][i]), expected[mesh->triangles()[t][i]], model["positions"]["step"]);
      }
    }
    EXPECT_LT(model["positions"]["step"][0].get<double>(), 2e-7);  // of a size of 2
  }
}

TEST(ProgramReport, DividesLongEdgesSoThatTheMapSeesWhatIsNear) {
  const Folder folder;
  const Mesh floor = scenes::grid(1, 1, -50, -50, 100, 100), ball = scenes::ball(32, 16);
  const Report report("distance " + folder.store("floor.obj", floor) + ' ' + folder.store("ball.obj", ball) +
                      " --pose-b 7,-3,1.5,1,0,0,0");
  const nlohmann::json& model = report.data["models"][0];
  const std::vector<Vec3> points = points_of(model["positions"]);
  const std::vector<Corners> triangles = corners_of(model["corners"]);
  const std::vector<std::uint64_t> parts = counts_of(model["parts"]);
  ASSERT_EQ(parts.size(), 2U);
  ASSERT_EQ(parts[0] + parts[1], triangles.size());
  EXPECT_GT(triangles.size(), 500U);

  // The parts of each triangle cover it once: areas add up, and no edge but those of the square is used once.
  std::map<std::pair<VertexId, VertexId>, int> uses;
  std::vector<double> areas(2);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Corners& c = triangles[t];
    areas[t < parts[0] ? 0 : 1] += area({points.at(c[0]), points.at(c[1]), points.at(c[2])});
    for (std::size_t i = 0; i < 3; ++i) ++uses[std::minmax(c[i], c[(i + 1) % 3])];
  }
  EXPECT_NEAR(areas[0], 5000, 1e-2);
  EXPECT_NEAR(areas[1], 5000, 1e-2);
  double border = 0;
  for (const auto& [edge, count] : uses) {
    EXPECT_LE(count, 2);
    if (count == 1) border += length(points[edge.first] - points[edge.second]);
  }
  EXPECT_NEAR(border, 400, 1e-3);

  const nlohmann::json& map = model["distances"];
  const std::vector<double> distances = numbers_of(map["low"], map["step"], map["data"]);
  ASSERT_EQ(distances.size(), points.size());
  const Transform pose{{}, {7, -3, 1.5}};
  const Model tree(ball);
  for (std::size_t v = 0; v < points.size(); v += 17) {
    const auto expected = closest_point({tree, pose}, points[v]).closest->distance;
    EXPECT_NEAR(distances[v], expected, map["step"].get<double>() + 1e-5) << v;
  }
  EXPECT_NEAR(*std::min_element(distances.begin(), distances.end()), 0.5, 0.05);
}

TEST(ProgramReport, HasTheAnswerOfTheSameRun) {
  const std::string question = "distance scene:soup:1 scene:soup:2 --pose-b 3,0,0,1,2,3,4 --json";
  for (const std::string options :
       {"", " --relative-error 0.3", " --min-clearance 2.5", " --min-clearance 0.001", " --max-distance 0.01"}) {
    const Report report(question + options);
    const nlohmann::json json = nlohmann::json::parse(report.outcome.out);
    for (const char* key : {"status", "lower", "upper", "witness", "too_close", "inside", "clash", "solids", "depth",
                            "node_tests", "query_us"}) {
      EXPECT_EQ(report.data[key], json[key]) << key;
    }
    EXPECT_EQ(report.outcome.exit_code, json["too_close"] == true ? 3 : 0);
    EXPECT_EQ(report.data["witness_corners"].is_null(), json["witness"].is_null());
    EXPECT_EQ(report.data["intersections"], 0);
    EXPECT_EQ(report.data["command"].get<std::string>().find("limber distance scene:soup:1 scene:soup:2 --pose-b"), 0U);
  }
}

TEST(ProgramReport, MarksAllTrianglesThatIntersect) {
  const Folder folder;
  scenes::Rng rng(4);
  const Mesh a = scenes::random_soup(rng, 80, 0.5), b = scenes::random_soup(rng, 70, 0.5);
  std::vector<std::uint64_t> expected_a, expected_b;
  std::size_t pair_count = 0;
  std::vector<bool> marked_b(b.triangles().size());
  for (TriangleId t = 0; t < a.triangles().size(); ++t) {
    bool is_marked = false;
    for (TriangleId u = 0; u < b.triangles().size(); ++u) {
      if (!intersects(a.triangle(t), b.triangle(u))) continue;
      is_marked = marked_b[u] = true;
      ++pair_count;
    }
    if (is_marked) expected_a.push_back(t);
  }
  for (TriangleId u = 0; u < marked_b.size(); ++u) {
    if (marked_b[u]) expected_b.push_back(u);
  }
  ASSERT_GT(pair_count, 10U);
  const Report report("distance " + folder.store("a.obj", a) + ' ' + folder.store("b.obj", b));
  EXPECT_EQ(report.data["status"], "collision");
  EXPECT_EQ(report.data["intersections"], pair_count);
  EXPECT_TRUE(report.data["contact_normal"].is_array());
  for (const auto& [m, expected] : {std::pair(0, &expected_a), std::pair(1, &expected_b)}) {
    std::vector<std::uint64_t> ids = counts_of(report.data["models"][m]["intersecting"]);
    for (std::size_t i = 1; i < ids.size(); ++i) ids[i] += ids[i - 1];
    EXPECT_EQ(ids, *expected);
  }
}

TEST(ProgramReport, MeshesOf200000TrianglesTakeLessThan8Megabytes) {
  const Folder folder;
  const Mesh sheet = scenes::wave_sheet(250, 200, 1);  // 100 000 triangles
  const std::string file = folder.store("sheet.obj", sheet);
  const Report report("distance " + file + ' ' + file + " --pose-b 0,0,40,0.9,0.1,0.2,0.3");
  EXPECT_EQ(report.outcome.exit_code, 0) << report.outcome.err;
  EXPECT_EQ(report.data["models"][0]["triangles"], 100000);
  EXPECT_GT(report.page.size(), 1'000'000U);
  EXPECT_LT(report.page.size(), 8'000'000U);
}

TEST(ProgramReport, NeedsNothingButItselfAndHasTheLicensesOfWhatIsInside) {
  const std::string page = Report("distance scene:square scene:ball --pose-b 0,0,3,1,0,0,0").page;
  EXPECT_EQ(page.find("<!DOCTYPE html>"), 0U);
  for (const char* part : {" src=\"", "@import", "href=\"http", "fetch(\"http", "importScripts"}) {
    EXPECT_EQ(page.find(part), std::string::npos) << part;
  }
  for (const char* owner : {"The limber authors", "three.js authors", "Permission is hereby granted"}) {
    EXPECT_NE(page.find(owner), std::string::npos) << owner;
  }
}

TEST(ProgramReport, NamesOfFilesAreOnlyText) {
  const Folder folder;
  folder.store("<!--<script>'$.obj", scenes::ball(8, 5));
  const std::string in_shell = '\'' + folder.path("<!--<script>'\\''$.obj") + '\'';
  const Report report("distance " + in_shell + " scene:ball --pose-b 0,0,3,1,0,0,0");
  EXPECT_EQ(report.data["models"][0]["name"], "<!--<script>'$.obj");
  EXPECT_EQ(report.page.find("<!--<script>"), std::string::npos);
  const std::string typed = report.data["command"];
  EXPECT_EQ(typed.find("limber distance " + in_shell + " scene:ball --pose-b 0,0,3,1,0,0,0 --report"), 0U) << typed;
}

TEST(ProgramReport, IsRefusedWhereItHasNoPlace) {
  const Folder folder;
  const std::string page = folder.path("r.html");
  const std::string huge = folder.store("huge.obj", "v 1e60 0 0\nv 0 1e60 0\nv 0 0 1e60\nf 1 2 3\n");
  expect_refused("distance " + huge + " scene:ball --pose-a 1.6e60,0,0,1,0,0,0 --report " + page,
                 "--report: a pose moves a vertex");
}

}  // namespace
}  // namespace limber::program_tests
