// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Impacts between frames, of `limber track --continuous`: times known on paper, and those of the library.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "contact_meshes.h"
#include "formats/scenes.h"
#include "limber/geometry.h"
#include "limber/motion.h"
#include "page_decoding.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

void expect_interval(const nlohmann::json& impact, double time) {
  EXPECT_EQ(impact["status"], "contact");
  EXPECT_LE(impact["lower"].get<double>(), time);
  EXPECT_GE(impact["upper"].get<double>(), time);
  EXPECT_LE(impact["upper"].get<double>() - impact["lower"].get<double>(), 0x1p-50);
}

/// Tracks a cube of side 1 whose middle is at these heights, above or below a square.
std::string falling_cube(const Folder& folder, const std::vector<double>& heights) {
  Words files;
  for (const double z : heights) {
    files.push_back(folder.store("cube" + std::to_string(files.size()) + ".obj", cube({0.125, 0.25, z}, 0.5)));
  }
  return "track --continuous --a " + joined(files) + " --b " + folder.store("square.obj", two_triangles());
}

TEST(ProgramImpacts, AreFoundBetweenFramesThatAreApart) {
  const Folder folder;
  const std::string line = falling_cube(folder, {3, 1, -1, -1.5, 0, 0});
  const auto objects = json_rows_of(line);
  ASSERT_EQ(objects.size(), 6U);
  for (const char* const key : {"query_us", "status", "lower", "upper", "touch"}) {
    EXPECT_TRUE(objects[0]["impact"][key].is_null()) << key;
  }
  EXPECT_EQ(objects[1]["impact"]["status"], "clear");
  EXPECT_TRUE(objects[1]["impact"]["lower"].is_null() && objects[1]["impact"]["touch"].is_null());
  EXPECT_GT(objects[2]["lower"].get<double>(), 0.4);  // below the square, as far as above it before
  expect_interval(objects[2]["impact"], 1.25);
  const nlohmann::json& touch = objects[2]["impact"]["touch"];
  EXPECT_EQ(point_of(touch["normal"]), (Vec3{0, 0, -1}));
  EXPECT_EQ(point_of(touch["point_a"]).z, 0);
  EXPECT_LE(touch["triangle_a"], 5);  // of the bottom, or with an edge of it
  EXPECT_EQ(objects[3]["impact"]["status"], "clear");
  expect_interval(objects[4]["impact"], 3 + 2.0 / 3);
  EXPECT_EQ(point_of(objects[4]["impact"]["touch"]["normal"]), (Vec3{0, 0, 1}));
  const nlohmann::json& crossing = objects[5]["impact"];
  EXPECT_EQ(crossing["status"], "initial_contact");
  EXPECT_EQ(crossing["lower"], 4);
  EXPECT_EQ(crossing["upper"], 4);
  EXPECT_TRUE(crossing["touch"]["feature_a"].is_null() && crossing["touch"]["feature_b"].is_null());
  const auto going_on = json_rows_of(line + " --ignore-crossings");
  EXPECT_EQ(going_on[5]["impact"]["status"], "clear");
  expect_interval(going_on[2]["impact"], 1.25);
}

TEST(ProgramImpacts, EachLoopStartsAnew) {
  const Folder folder;
  const auto rows = json_rows_of(falling_cube(folder, {3, 1, -1}) + " --loop 2");
  ASSERT_EQ(rows.size(), 6U);
  EXPECT_TRUE(rows[3]["impact"]["status"].is_null());
  expect_interval(rows[2]["impact"], 1.25);
  expect_interval(rows[5]["impact"], 4.25);
}

TEST(ProgramImpacts, AreInTheReport) {
  const Folder folder;
  const Report report(falling_cube(folder, {3, 1, -1, 0, 0}) + " --json");
  const std::vector<nlohmann::json> lines = json_lines_of(report.outcome);
  ASSERT_EQ(lines.size(), 5U);
  ASSERT_EQ(report.data["impacts"].size(), 1U);
  const nlohmann::json& impacts = report.data["impacts"][0];
  EXPECT_EQ(impacts["name"], "impact");
  for (std::size_t f = 0; f < lines.size(); ++f) {
    const nlohmann::json& impact = lines[f]["impact"];
    for (const char* const key : {"status", "lower"}) EXPECT_EQ(impacts[key][f], impact[key]) << f;
    EXPECT_EQ(impacts["touch"][f].is_null(), f < 2);
    if (f < 2) continue;
    const nlohmann::json& touch = impact["touch"];
    EXPECT_EQ(impacts["touch"][f], nlohmann::json::array({touch["feature_a"], touch["triangle_a"], touch["feature_b"],
                                                          touch["triangle_b"]}));
  }
}

TEST(ProgramImpacts, OfModelsThatMeetThemselves) {
  const Folder folder;
  // The end of the strip comes down to its start half of the way to frame 1, and is below it there.
  const Words strips = {folder.store("0.obj", folded_strip(0.25, 0.25)),
                        folder.store("1.obj", folded_strip(0.25, -0.25)),
                        folder.store("2.obj", folded_strip(0.25, 0.75))};
  const std::string far = " --poses-a " + folder.store("far.csv", "9,0,0,1,0,0,0\n");
  const auto rows = json_rows_of("track --continuous --self --a " + joined(strips) + " --b " +
                                 joined({strips[0], strips[0], strips[1]}) + far);
  ASSERT_EQ(rows.size(), 3U);
  expect_interval(rows[1]["impact_self_a"], 0.5);
  EXPECT_NEAR(point_of(rows[1]["impact_self_a"]["touch"]["point_a"]).x, 9.3, 1e-14);
  EXPECT_EQ(rows[1]["impact_self_b"]["status"], "clear");
  EXPECT_EQ(rows[2]["impact_self_a"]["status"], "initial_contact");
  EXPECT_EQ(rows[2]["impact_self_a"]["lower"], 1);
  expect_interval(rows[2]["impact_self_b"], 1.5);
  for (const nlohmann::json& row : rows) EXPECT_NE(row["impact"]["status"], "contact");
  const auto going_on =
      json_rows_of("track --continuous --ignore-crossings --self --b scene:ball --a " + joined(strips) + far);
  EXPECT_EQ(going_on[2]["impact_self_a"]["status"], "initial_contact");  // edges along the sides cross
  EXPECT_TRUE(going_on[2]["impact_self_a"]["touch"]["feature_a"].get<std::string>().starts_with("edge "));
  EXPECT_FALSE(going_on[2].contains("impact_self_b"));
}

/// The distance of a point from the element that an answer names: "vertex 0", "edge 2" or "face".
double distance_from(const Vec3& point, const Triangle& triangle, const std::string& feature) {
  const auto i = static_cast<std::size_t>(feature.back() - '0');
  if (feature == "face") return closest_points(point, triangle).distance;
  const Vec3 start = triangle[i], end = feature.starts_with("vertex") ? start : triangle[(i + 1) % 3];
  return closest_points(Segment{point, point}, Segment{start, end}).distance;
}

TEST(ProgramImpacts, AreThoseOfTheLibraryAndOnTheElementsThatTheyName) {
  int contacts = 0, clear = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Soups soups(seed, 0.5);
    // The first soup goes on changing, the second comes from the right.
    Mesh end = soups.a;
    for (VertexId v = 0; v < end.positions().size(); ++v) {
      const Vec3 by{soups.rng.uniform(-0.1, 0.1), soups.rng.uniform(-0.1, 0.1), soups.rng.uniform(-0.1, 0.1)};
      end.set_position(v, end.positions()[v] + by).value();
    }
    const std::string far = seed % 2 == 0 ? "9" : "1.9";
    const auto row =
        json_rows_of("track --continuous --ignore-crossings --a " + soups.file_a + ' ' +
                     soups.folder.store("end.obj", end) + " --b " + soups.file_b + " --poses-b " +
                     soups.folder.store("poses.csv", far + ",0,0,1,0,0,0\n" + far.substr(0, 1) + ",0,0,1,0,0,0\n"))
            .at(1)["impact"];
    const Model a(soups.a), b(soups.b);
    const Transform start_b{{}, {number(far), 0, 0}}, end_b{{}, {number(far.substr(0, 1)), 0, 0}};
    MovingModel moving_a(a), moving_b(b);
    moving_a.set_motion(end.positions()).value();
    moving_b.set_motion(soups.b.positions(), start_b, end_b).value();
    const ImpactResult expected = time_of_impact(moving_a, moving_b, {.ignore_crossings = true});
    if (!expected.witness) {
      EXPECT_EQ(row["status"], "clear");
      ++clear;
      continue;
    }
    ++contacts;
    EXPECT_EQ(row["lower"], expected.lower);
    EXPECT_EQ(row["upper"], expected.upper);
    const nlohmann::json& touch = row["touch"];
    EXPECT_EQ(touch["triangle_a"], expected.witness->triangle_a);
    EXPECT_EQ(point_of(touch["normal"]), expected.normal);
    const Triangle from = soups.a.triangle(touch["triangle_a"]), to = end.triangle(touch["triangle_a"]);
    const auto at = [&](const Vec3& p, const Vec3& q) { return p + expected.upper * (q - p); };
    const Triangle there{at(from.v0, to.v0), at(from.v1, to.v1), at(from.v2, to.v2)};
    EXPECT_NEAR(distance_from(point_of(touch["point_a"]), there, touch["feature_a"]), 0, 1e-12);
    const Vec3 of_b = point_of(touch["point_b"]) - at(start_b.translation, end_b.translation);
    EXPECT_NEAR(distance_from(of_b, soups.b.triangle(touch["triangle_b"]), touch["feature_b"]), 0, 1e-12);
  }
  EXPECT_GT(contacts, 3);
  EXPECT_GT(clear, 3);
}

}  // namespace
}  // namespace limber::program_tests
