// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Impacts between frames, of `limber track --continuous`: times known on paper, and brute force over all elements.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "contact_meshes.h"
#include "page_decoding.h"
#include "run_program.h"
#include "reference/reference.h"
#include "scenes/scenes.h"

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
  const std::vector<Row> rows = table_of(answer_to(line));
  ASSERT_EQ(objects.size(), 6U);
  ASSERT_EQ(rows.size(), 6U);
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
  for (std::size_t f = 0; f < 6; ++f) {
    nlohmann::json impact = objects[f]["impact"];
    EXPECT_EQ(rows[f].at("impact_query_us").empty(), f == 0);
    impact.erase("query_us");
    expect_same(rows[f], impact, "impact_");
  }
  const auto going_on = json_rows_of(line + " --ignore-crossings");
  EXPECT_EQ(going_on[5]["impact"]["status"], "clear");
  expect_interval(going_on[2]["impact"], 1.25);
}

TEST(ProgramImpacts, LeaveOtherColumnsAsTheyAre) {
  const Folder folder;
  std::string line = falling_cube(folder, {3, 1});
  const std::string header = lines_of(answer_to(line))[0], all = lines_of(answer_to(line + " --self --contacts"))[0];
  line.erase(line.find(" --continuous"), std::string(" --continuous").size());
  const std::string columns =
      "query_us,status,lower,upper,triangle_a,triangle_b,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,"
      "normal_x,normal_y,normal_z,feature_a,feature_b,face_a,face_b";
  const auto prefixed = [&](const std::string& name) {
    std::string text = ',' + name + columns;
    for (std::size_t at = name.size() + 1; (at = text.find(',', at)) != std::string::npos; at += name.size() + 1) {
      text.insert(at + 1, name);
    }
    return text;
  };
  EXPECT_EQ(header, lines_of(answer_to(line))[0] + prefixed("impact_"));
  EXPECT_EQ(all,
            lines_of(answer_to(line + " --self --contacts"))[0] + prefixed("impact_") + prefixed("impact_self_a_"));
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

/// A soup whose corners go somewhere else in each frame, and its files.
struct MovingSoup {
  Mesh mesh;
  std::vector<std::vector<Vec3>> frames;
  Words files;

  MovingSoup(const Folder& folder, const std::string& name, scenes::Rng& rng, const Vec3& way)
      : mesh(scenes::random_soup(rng, 16, 0.5)) {
    for (int f = 0; f < 4; ++f) {
      for (VertexId v = 0; f > 0 && v < mesh.positions().size(); ++v) {
        const Vec3 by{rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5};
        mesh.set_position(v, mesh.positions()[v] + 0.2 * by + way).value();
      }
      frames.push_back(mesh.positions());
      files.push_back(folder.store(name + std::to_string(f) + ".obj", mesh));
    }
  }

  /// The way from a frame to the next.
  reference::MovingMesh step(std::size_t frame, const Transform& start = {}, const Transform& end = {}) const {
    return {{frames[frame], mesh.triangles()}, frames[frame + 1], start, end};
  }
};

/// The element of a triangle that the answer names: a vertex, an edge of the mesh or the triangle.
std::uint32_t id_of(const MovingSoup& soup, std::uint32_t triangle, const std::string& feature) {
  if (feature == "face") return triangle;
  const auto index = static_cast<std::size_t>(feature.back() - '0');
  return feature.starts_with("vertex") ? soup.mesh.triangles()[triangle][index]
                                       : Model(soup.mesh).edges().of_triangles()[triangle][index];
}

ElementPair elements_of(const nlohmann::json& touch, const MovingSoup& a, const MovingSoup& b) {
  using enum ElementPair::Kind;
  const std::string feature_a = touch["feature_a"], feature_b = touch["feature_b"];
  return {feature_b.starts_with("vertex")   ? face_vertex
          : feature_a.starts_with("vertex") ? vertex_face
                                            : edge_edge,
          id_of(a, touch["triangle_a"], feature_a), id_of(b, touch["triangle_b"], feature_b)};
}

/// The answer is that of all pairs of elements, the first of which touch in its interval. Returns whether any touch.
bool is_first(const nlohmann::json& impact, std::size_t frame, const std::vector<Impact>& all, const MovingSoup& a,
              const MovingSoup& b) {
  if (all.empty()) {
    EXPECT_EQ(impact["status"], "clear");
    return false;
  }
  const Impact& first = *std::min_element(all.begin(), all.end(),
                                          [](const Impact& x, const Impact& y) { return x.time.lower < y.time.lower; });
  const auto start = static_cast<long double>(frame);  // has room for the sum, so its rounding shows
  const auto lower = impact["lower"].get<double>(), upper = impact["upper"].get<double>();
  EXPECT_EQ(impact["status"], first.time.upper == 0 ? "initial_contact" : "contact");
  EXPECT_LE(lower, start + first.time.upper);
  EXPECT_GE(upper, start + first.time.lower);
  EXPECT_LE(upper - lower, 0x1p-50);
  const ElementPair named = elements_of(impact["touch"], a, b);
  const auto found = std::find_if(all.begin(), all.end(), [&](const Impact& i) { return i.elements == named; });
  EXPECT_TRUE(found != all.end() && start + found->time.lower <= upper);
  return true;
}

TEST(ProgramImpacts, AreThoseOfAllPairsOfElements) {
  int contacts = 0, self_contacts = 0, clear = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const Folder folder;
    scenes::Rng rng(seed);
    const MovingSoup a(folder, "a", rng, {}), b(folder, "b", rng, {-0.7, 0.1, 0});
    // The second soup comes from the right, and turns.
    std::string poses;
    std::vector<Transform> pose_b;
    for (int f = 0; f < 4; ++f) {
      poses += "2.75,0,0,1,0,0." + std::to_string(f) + ",0\n";
      pose_b.push_back(transform_from_quaternion({2.75, 0, 0}, 1, 0, number("0." + std::to_string(f)), 0).value());
    }
    const auto rows = json_rows_of("track --continuous --ignore-crossings --self --a " + joined(a.files) + " --b " +
                                   joined(b.files) + " --poses-b " + folder.store("poses.csv", poses));
    ASSERT_EQ(rows.size(), 4U);
    for (std::size_t f = 0; f < 3; ++f) {
      SCOPED_TRACE(f);
      const reference::MovingMesh step_a = a.step(f), step_b = b.step(f, pose_b[f], pose_b[f + 1]);
      const nlohmann::json& row = rows[f + 1];
      (is_first(row["impact"], f, reference::impacts(step_a, step_b, {}), a, b) ? contacts : clear) += 1;
      self_contacts += is_first(row["impact_self_a"], f, reference::self_impacts(step_a, {}), a, a);
      self_contacts += is_first(row["impact_self_b"], f, reference::self_impacts(step_b, {}), b, b);
    }
  }
  EXPECT_GT(contacts, 5);
  EXPECT_GT(clear, 5);
  EXPECT_GT(self_contacts, 20);
}

}  // namespace
}  // namespace limber::program_tests
