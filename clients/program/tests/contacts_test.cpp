// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "contact_meshes.h"
#include "limber/contacts.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

using Ids = std::set<std::pair<TriangleId, TriangleId>>;

Ids ids_of(const nlohmann::json& answer) {
  Ids ids;
  for (const nlohmann::json& pair : answer["pairs"]) ids.emplace(pair["triangle_a"], pair["triangle_b"]);
  EXPECT_EQ(ids.size(), answer["pairs"].size()) << "a pair came twice";
  return ids;
}

std::string name_of_feature(Feature feature) {
  if (feature.kind == FeatureKind::face) return "face";
  return (feature.kind == FeatureKind::vertex ? "vertex " : "edge ") + std::to_string(feature.index);
}

/// Two soups that meet in some places and are close in others, and the question about both.
struct PlacedSoups : Soups {
  Transform world_from_b = transform_from_quaternion({0.3, 0.2, -0.1}, 0.3, -0.4, 0.5, 0.6).value();
  std::string question = "contacts" + files() + "--pose-b 0.3,0.2,-0.1,0.3,-0.4,0.5,0.6 ";

  explicit PlacedSoups(std::uint64_t seed) : Soups(seed, 0.8) {}
};

TEST(ProgramContacts, CrossingSquaresMeetInThreePairs) {
  const Folder folder;
  const std::string square = folder.store("square.obj", two_triangles());
  // The second square stands on the line y = 0 of the first, shifted along it by half a unit.
  const std::string question = "contacts " + square + ' ' + square + " --pose-b 0.5,0,0,1,1,0,0 ";
  for (const std::string which : {"--intersections", "--margin 0", "--margin 0.01"}) {
    const std::string text = answer_to(question + which);
    const bool has_margin = which != "--intersections";
    EXPECT_EQ(text.find(has_margin ? "pairs     3, 3 of them at distance 0\n" : "pairs     3\n"), 0U) << text;
    EXPECT_EQ(count_of("more", text), 0U);
    const nlohmann::json json = json_of(question + which);
    EXPECT_EQ(json["count"], 3);
    EXPECT_EQ(json["intersecting"], 3);
    EXPECT_EQ(ids_of(json), (Ids{{0, 0}, {0, 1}, {1, 1}}));
    EXPECT_EQ(json["margin"].is_null(), !has_margin);
  }
  const nlohmann::json closest = json_of(question + "--closest 1000000");
  EXPECT_EQ(closest["closest"], 1000000);
  EXPECT_EQ(closest["count"], 4);  // of all pairs
}

TEST(ProgramContacts, RowsAndObjectsAreTheContactsOfTheLibrary) {
  for (const std::uint64_t seed : {1U, 2U}) {
    SCOPED_TRACE(seed);
    const PlacedSoups soups(seed);
    const Model a(soups.a), b(soups.b);
    std::map<std::pair<TriangleId, TriangleId>, Contact> expected;
    const auto collect = [&](const Contact& c) { return expected[{c.triangle_a, c.triangle_b}] = c, true; };
    visit_contacts({a}, {b, soups.world_from_b}, 0.1, collect);
    ASSERT_GT(expected.size(), 20U);

    const std::string csv = soups.folder.path("contacts.csv");
    const nlohmann::json json = json_of(soups.question + "--margin 0.1 --out " + csv);
    EXPECT_EQ(json["count"], expected.size());
    EXPECT_EQ(ids_of(json).size(), expected.size());
    const std::vector<Row> rows = table_of(text_of(csv));
    ASSERT_EQ(rows.size(), expected.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const nlohmann::json& object = json["pairs"][i];
      expect_same(rows[i], object);
      const Contact& contact = expected.at({object["triangle_a"], object["triangle_b"]});
      EXPECT_EQ(object["distance"], contact.distance);
      EXPECT_EQ(object["depth"], contact.depth);
      EXPECT_EQ(point_of(object["point_a"]), contact.point_a);
      EXPECT_EQ(point_of(object["point_b"]), contact.point_b);
      EXPECT_EQ(point_of(object["normal"]), contact.normal);
      EXPECT_EQ(object["feature_a"], name_of_feature(contact.feature_a));
      EXPECT_EQ(object["feature_b"], name_of_feature(contact.feature_b));
      EXPECT_EQ(object["normal_side"], "unknown");  // of soups
    }
  }
}

TEST(ProgramContacts, TheDeepestComeFirstAndALimitCutsRowsButNotTheCount) {
  const PlacedSoups soups(3);
  const auto answer_with = [&](const std::string& options) {
    return answer_to(soups.question + "--margin 0.2 " + options);
  };
  const std::string csv = answer_with("--out -");
  const std::vector<Row> rows = table_of(csv);
  const auto key = [](const Row& row) {
    return std::tuple(-number(row.at("depth")), number(row.at("distance")), number(row.at("triangle_a")),
                      number(row.at("triangle_b")));
  };
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end(), [&](const Row& a, const Row& b) { return key(a) < key(b); }));
  EXPECT_GT(number(rows.front().at("depth")), 0);
  EXPECT_GT(number(rows.back().at("distance")), 0);
  const Words all = lines_of(csv);
  const std::size_t count = rows.size();
  ASSERT_GT(count, 20U);
  for (const std::size_t limit : {std::size_t{0}, std::size_t{15}, count, count + 1}) {
    const std::string text = std::to_string(limit);
    const std::size_t written = std::min(limit, count);
    EXPECT_EQ(lines_of(answer_with("--out - --max-count " + text)),
              Words(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(written) + 1));
    const nlohmann::json json = nlohmann::json::parse(answer_with("--json --max-count " + text));
    EXPECT_EQ(json["count"], count);
    EXPECT_EQ(json["pairs"].size(), written);
    EXPECT_EQ(lines_of(answer_with("--max-count " + text)).size(),
              3 + (written == 0 ? 0 : 2 + written + (written < count ? 1 : 0)));
  }
  // Without a limit a table has ten rows, and says how many others there are.
  const Words table = lines_of(answer_with(""));
  EXPECT_EQ(table[0].find("pairs     " + std::to_string(count) + ", "), 0U) << table[0];
  EXPECT_EQ(table[4], "triangle a  triangle b      distance         depth  features");
  EXPECT_EQ(table.size(), 3U + 2 + 10 + 1);
  EXPECT_EQ(table.back(), "and " + std::to_string(count - 10) + " more");
}

TEST(ProgramSelf, AStripThatIsFoldedThroughItselfMeetsItselfInThreePairs) {
  const Folder folder;
  const std::string line = "self " + folder.store("strip.obj", folded_strip(0.2, -0.2));
  const std::string text = answer_to(line);
  for (const char* const part :
       {"collision yes\npairs     3\nstatus    collision\nlower     0\nupper     0\npoint a   0.",
        "\n\ntriangle a  triangle b\n         0           6\n         0           7\n"}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_EQ(json_of(line)["distance"]["upper"], 0);
  for (const std::string which : {"", " --intersections", " --margin 0", " --margin 0.001"}) {
    const nlohmann::json json = json_of(line + which);
    EXPECT_EQ(json["is_yes"], true);
    EXPECT_EQ(json["count"], 3);
    EXPECT_EQ(json["intersecting"], 3);
    EXPECT_EQ(ids_of(json), (Ids{{0, 6}, {0, 7}, {1, 7}}));
    EXPECT_EQ(json["distance"].is_null(), !which.empty());
  }
}

TEST(ProgramSelf, AStripThatIsFoldedAboveItselfIsClose) {
  const Folder folder;
  const Model strip(folded_strip(0.25, 0.25));
  const std::string line = "self " + folder.store("strip.obj", strip.mesh());
  const nlohmann::json overview = json_of(line);
  EXPECT_EQ(overview["is_yes"], false);
  EXPECT_EQ(overview["count"], 0);
  EXPECT_EQ(overview["distance"]["upper"], self_distance(strip).upper);
  EXPECT_EQ(overview["distance"]["witness"]["triangle_a"], self_distance(strip).witness->triangle_a);
  EXPECT_EQ(json_of(line + " --closest 1")["pairs"][0]["distance"], overview["distance"]["upper"]);
  const nlohmann::json close = json_of(line + " --margin 0.3");
  Ids expected;
  visit_self_contacts(strip, 0.3, [&](const Contact& c) { return expected.emplace(c.triangle_a, c.triangle_b), true; });
  EXPECT_EQ(ids_of(close), expected);
  EXPECT_EQ(close["pairs"].back()["distance"], 0.25);  // the last square lies flat over the first
  const std::string text = answer_to(line + " --margin 0.1");
  EXPECT_EQ(text.find("collision no\npairs     0, 0 of them at distance 0\ntests"), 0U) << text;
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
}

}  // namespace
}  // namespace limber::program_tests
