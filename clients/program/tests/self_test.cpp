// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "contact_meshes.h"
#include "run_program.h"
#include "reference/reference.h"

namespace limber::program_tests {
namespace {

const std::set<std::pair<int, int>> crossings_of_the_strip = {{0, 6}, {0, 7}, {1, 7}};

std::set<std::pair<int, int>> pairs_of(const nlohmann::json& answer) {
  std::set<std::pair<int, int>> ids;
  for (const nlohmann::json& pair : answer["pairs"]) ids.emplace(pair["triangle_a"], pair["triangle_b"]);
  return ids;
}

TEST(ProgramSelf, AStripThatIsFoldedThroughItselfMeetsItselfInThreePairs) {
  const Folder folder;
  const std::string strip = folder.store("strip.obj", folded_strip(0.2, -0.2));
  const std::string text = answer_to("self " + strip);
  EXPECT_EQ(text.find("collision yes\npairs     3\nstatus    collision\nlower     0\nupper     0\npoint a   0."), 0U)
      << text;
  EXPECT_NE(text.find("\n\ntriangle a  triangle b\n         0           6\n         0           7\n"),
            std::string::npos)
      << text;
  const nlohmann::json json = json_of("self " + strip);
  EXPECT_EQ(json["query"], "self");
  EXPECT_EQ(json["is_yes"], true);
  EXPECT_EQ(json["count"], 3);
  EXPECT_EQ(json["intersecting"], 3);
  EXPECT_EQ(pairs_of(json), crossings_of_the_strip);
  EXPECT_EQ(json["distance"]["status"], "collision");
  EXPECT_EQ(json["distance"]["upper"], 0);
  for (const std::string which : {" --intersections", " --margin 0", " --margin 0.001"}) {
    const nlohmann::json found = json_of("self " + strip + which);
    EXPECT_EQ(pairs_of(found), crossings_of_the_strip);
    EXPECT_EQ(found["is_yes"], true);
    EXPECT_TRUE(found["distance"].is_null());
  }
}

TEST(ProgramSelf, AStripThatIsFoldedAboveItselfIsClose) {
  const Folder folder;
  const Mesh strip = folded_strip(0.25, 0.25);
  const std::string path = folder.store("strip.obj", strip);
  const std::vector<Contact> expected = reference::self_contacts(strip, 0.3);
  const auto nearest = std::min_element(expected.begin(), expected.end(),
                                        [](const Contact& a, const Contact& b) { return a.distance < b.distance; });
  const nlohmann::json overview = json_of("self " + path);
  EXPECT_EQ(overview["is_yes"], false);
  EXPECT_EQ(overview["count"], 0);
  EXPECT_EQ(overview["distance"]["status"], "exact");
  EXPECT_EQ(overview["distance"]["upper"], nearest->distance);
  EXPECT_EQ(overview["distance"]["witness"]["triangle_a"], nearest->triangle_a);
  const nlohmann::json closest = json_of("self " + path + " --closest 1");
  EXPECT_EQ(closest["count"], 1);
  EXPECT_EQ(closest["pairs"][0]["distance"], nearest->distance);

  const std::vector<Row> rows = table_of(answer_to("self " + path + " --margin 0.3 --out -"));
  ASSERT_EQ(rows.size(), expected.size());
  for (const Contact& contact : expected) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
      return number(r.at("triangle_a")) == contact.triangle_a && number(r.at("triangle_b")) == contact.triangle_b;
    });
    ASSERT_NE(row, rows.end()) << contact.triangle_a << ' ' << contact.triangle_b;
    EXPECT_EQ(number(row->at("distance")), contact.distance);
    EXPECT_EQ(number(row->at("normal_z")), contact.normal.z);
  }
  // The last square lies flat over the first.
  const std::string text = answer_to("self " + path + " --margin 0.1");
  EXPECT_EQ(text.find("collision no\npairs     0, 0 of them at distance 0\ntests"), 0U) << text;
  EXPECT_NE(rows.front().at("distance"), "0.25");
  EXPECT_EQ(rows.back().at("distance"), "0.25");
}

TEST(ProgramSelf, EachPairOfASoupComesOnceAsBruteForceFindsIt) {
  const Folder folder;
  scenes::Rng rng(7);
  const Mesh soup = scenes::random_soup(rng, 80, 0.5);
  const std::string path = folder.store("soup.obj", soup);
  std::set<std::pair<int, int>> expected, meeting;
  for (const Contact& contact : reference::self_contacts(soup, 0.05)) {
    expected.emplace(contact.triangle_a, contact.triangle_b);
  }
  for (const TrianglePair& pair : reference::self_intersections(soup)) meeting.emplace(pair.a, pair.b);
  ASSERT_GT(meeting.size(), 3U);
  ASSERT_GT(expected.size(), meeting.size());
  const nlohmann::json close = json_of("self " + path + " --margin 0.05");
  EXPECT_EQ(pairs_of(close), expected);
  EXPECT_EQ(close["count"], expected.size());
  EXPECT_EQ(close["intersecting"], meeting.size());
  const nlohmann::json met = json_of("self " + path + " --max-count 2");
  EXPECT_EQ(met["count"], meeting.size());
  EXPECT_EQ(pairs_of(met), (std::set(meeting.begin(), std::next(meeting.begin(), 2))));
}

TEST(ProgramSelf, NeighborsDoNotCount) {
  const Folder folder;
  // Two triangles that touch at a corner; the file has that corner twice, and reading it makes it one vertex.
  const std::string tip_to_tip =
      folder.store("tips.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv -1 0 0\nv 0 -1 0\nf 1 2 3\nf 4 5 6\n");
  for (const std::string& model : {folder.store("square.obj", two_triangles()), tip_to_tip}) {
    const nlohmann::json json = json_of("self " + model);
    EXPECT_EQ(json["is_yes"], false);
    EXPECT_EQ(json["distance"]["status"], "beyond_limit");
    for (const char* key : {"lower", "upper", "witness"}) EXPECT_TRUE(json["distance"][key].is_null()) << key;
    EXPECT_EQ(json_of("self " + model + " --margin 1e9")["count"], 0);
    EXPECT_EQ(answer_to("self " + model).find("collision no\npairs     0\nstatus    beyond_limit\n"), 0U);
  }
  const nlohmann::json ball = json_of("self scene:ball");
  EXPECT_EQ(ball["is_yes"], false);
  EXPECT_GT(ball["distance"]["lower"].get<double>(), 0.01);
}

TEST(ProgramSelf, ExitCodesTellWhetherThereIsAPairOnlyWhereAsked) {
  const Folder folder;
  const std::string through = folder.store("through.obj", folded_strip(0.2, -0.2));
  const std::string above = folder.store("above.obj", folded_strip(0.25, 0.25));
  EXPECT_EQ(run("self " + through).exit_code, 0);
  EXPECT_EQ(run("self " + through + " --exit-code").exit_code, 3);
  EXPECT_EQ(run("self " + through + " --intersections --exit-code --json").exit_code, 3);
  EXPECT_EQ(run("self " + above + " --exit-code").exit_code, 0);
  EXPECT_EQ(run("self " + above + " --margin 0.1 --exit-code").exit_code, 0);
  EXPECT_EQ(run("self " + above + " --margin 0.3 --exit-code").exit_code, 3);
  EXPECT_EQ(run("self " + above + " --closest 1 --exit-code").exit_code, 3);
  EXPECT_EQ(run("self missing.obj --exit-code").exit_code, 2);
}

}  // namespace
}  // namespace limber::program_tests
