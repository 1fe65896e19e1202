// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "limber/contacts.h"
#include "contact_meshes.h"
#include "run_program.h"
#include "reference/reference.h"

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
}

TEST(ProgramContacts, ACubeInACubeIsCloseWithItsTop) {
  const Folder folder;
  // The top of the inner cube is half a unit below one of the two triangles of the outer top; all else is farther.
  const std::string outer = folder.store("outer.obj", cube({}, 3)), inner = folder.store("inner.obj", cube({}, 0.5));
  const auto ask = [&](const std::string& which) {
    const Outcome outcome = run("contacts " + outer + ' ' + inner + " --pose-b 1.5,-1.5,2,1,0,0,0 --json " + which);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(
        outcome.err,
        "limber: contacts: warning: B lies inside A without touching it; models are surfaces, not solids, so they "
        "do not collide\n");
    nlohmann::json json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json["inside"], "b_inside_a");
    EXPECT_EQ(json["intersecting"], 0);
    return json;
  };
  EXPECT_EQ(ask("--intersections")["count"], 0);
  EXPECT_EQ(ask("--margin 0")["count"], 0);
  EXPECT_EQ(ask("--margin 0.4")["count"], 0);
  const nlohmann::json close = ask("--margin 0.6");
  EXPECT_EQ(close["count"], 10);  // all triangles of the inner cube but those of its bottom reach up to its top
  for (const nlohmann::json& pair : close["pairs"]) {
    EXPECT_EQ(pair["triangle_a"], 10);
    EXPECT_GE(pair["triangle_b"].get<int>(), 2);
    EXPECT_EQ(pair["distance"], 0.5);
    EXPECT_EQ(pair["depth"], 0);
    EXPECT_EQ(point_of(pair["normal"]), (Vec3{0, 0, -1}));
    EXPECT_EQ(point_of(pair["point_a"]).z, 3);
    EXPECT_LE(max_abs(point_of(pair["point_b"]) - point_of(pair["point_a"]) + Vec3{0, 0, 0.5}), 1e-15);
    EXPECT_EQ(pair["feature_a"], "face");
    EXPECT_EQ(pair["normal_side"], "inward");  // from the inside of the outer cube
  }
  EXPECT_EQ(ask("--closest 7")["count"], 7);
  EXPECT_EQ(ask("--closest 7")["closest"], 7);
  EXPECT_EQ(ask("--closest 1000000")["count"], 144);
}

TEST(ProgramContacts, RowsAndObjectsAreTheContactsOfTheLibrary) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const PlacedSoups soups(seed);
    const Model a(soups.a), b(soups.b);
    std::map<std::pair<TriangleId, TriangleId>, Contact> expected;
    const auto collect = [&](const Contact& c) { return expected[{c.triangle_a, c.triangle_b}] = c, true; };
    visit_contacts({a}, {b, soups.world_from_b}, 0.1, collect);
    EXPECT_EQ(expected.size(), reference::contacts({soups.a}, {soups.b, soups.world_from_b}, 0.1).size());
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

TEST(ProgramContacts, PrintsExactlyTheDocumentedNames) {
  const PlacedSoups soups(1);
  const nlohmann::json json = json_of(soups.question + "--margin 0.1");
  EXPECT_EQ(keys_of(json), (Words{"build_us", "closest", "count", "inside", "intersecting", "margin", "node_tests",
                                  "pairs", "primitive_tests", "query", "query_us"}));
  EXPECT_EQ(json["query"], "contacts");
  EXPECT_EQ(json["margin"], 0.1);
  EXPECT_TRUE(json["closest"].is_null());
  EXPECT_EQ(keys_of(json["pairs"][0]),
            (Words{"depth", "distance", "face_a", "face_b", "feature_a", "feature_b", "normal", "normal_side",
                   "point_a", "point_b", "triangle_a", "triangle_b"}));
  const nlohmann::json ids = json_of(soups.question + "--intersections");
  EXPECT_EQ(keys_of(ids), keys_of(json));
  EXPECT_EQ(keys_of(ids["pairs"][0]), (Words{"face_a", "face_b", "triangle_a", "triangle_b"}));
  EXPECT_EQ(lines_of(answer_to(soups.question + "--margin 0.1 --out -")).front(),
            "triangle_a,triangle_b,distance,depth,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,"
            "normal_x,normal_y,normal_z,normal_side,feature_a,feature_b,face_a,face_b");
  EXPECT_EQ(lines_of(answer_to(soups.question + "--intersections --out -")).front(),
            "triangle_a,triangle_b,face_a,face_b");
}

TEST(ProgramContacts, TheDeepestComeFirstThenTheNearest) {
  const PlacedSoups soups(2);
  const std::vector<Row> rows = table_of(answer_to(soups.question + "--margin 0.2 --out -"));
  const auto key = [](const Row& row) {
    return std::tuple(-number(row.at("depth")), number(row.at("distance")), number(row.at("triangle_a")),
                      number(row.at("triangle_b")));
  };
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end(), [&](const Row& a, const Row& b) { return key(a) < key(b); }));
  EXPECT_GT(number(rows.front().at("depth")), 0);
  EXPECT_GT(number(rows.back().at("distance")), 0);
}

TEST(ProgramContacts, ALimitCutsRowsAndNotTheCount) {
  const PlacedSoups soups(3);
  const auto lines_with = [&](const std::string& options) {
    return lines_of(answer_to(soups.question + "--margin 0.2 " + options));
  };
  const Words all = lines_with("--out -");
  ASSERT_GT(all.size(), 20U);
  const auto count = static_cast<std::size_t>(all.size() - 1);
  for (const std::size_t limit : {std::size_t{0}, std::size_t{1}, std::size_t{15}, count, count + 1}) {
    const std::string text = std::to_string(limit);
    const std::size_t written = std::min(limit, count);
    const Words some = lines_with("--out - --max-count " + text);
    EXPECT_EQ(some, Words(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(written) + 1));
    const nlohmann::json json = nlohmann::json::parse(lines_with("--json --max-count " + text).at(0));
    EXPECT_EQ(json["count"], count);
    EXPECT_EQ(json["pairs"].size(), written);
    const Words lines = lines_with("--max-count " + text);
    EXPECT_EQ(lines[0].find("pairs     " + std::to_string(count) + ", "), 0U) << lines[0];
    const std::size_t table = written == 0 ? 0 : 2 + written + (written < count ? 1 : 0);
    EXPECT_EQ(lines.size(), 3 + table);
  }
  // Without a limit a table has ten rows, and says how many others there are.
  EXPECT_EQ(lines_with("").size(), 3U + 2 + 10 + 1);
  EXPECT_EQ(lines_with("").back(), "and " + std::to_string(count - 10) + " more");
}

TEST(ProgramContacts, AFileOfRowsLeavesTheAnswerAsItIs) {
  const PlacedSoups soups(5);
  const std::string csv = soups.folder.store("contacts.csv", "of yesterday\n");
  const std::string text = answer_to(soups.question + "--margin 0.1 --out " + csv);
  EXPECT_EQ(text.find("pairs     "), 0U);
  EXPECT_NE(text.find("\n\ntriangle a  triangle b      distance         depth  features\n"), std::string::npos);
  EXPECT_EQ(text_of(csv), answer_to(soups.question + "--margin 0.1 --out -"));
  answer_to(soups.question + "--intersections --max-count 0 --out " + csv);
  EXPECT_EQ(text_of(csv), "triangle_a,triangle_b,face_a,face_b\n");
}

/// Numbers of regions by brute force: a flood from pair to pair, whose triangles are compared corner by corner.
std::vector<std::size_t> flooded_regions(const std::vector<nlohmann::json>& pairs, MeshView a, MeshView b) {
  const auto share = [](const Corners& t, const Corners& u) {
    return std::any_of(t.begin(), t.end(), [&u](VertexId v) { return std::count(u.begin(), u.end(), v) > 0; });
  };
  const auto corners = [](MeshView mesh, const nlohmann::json& id) { return mesh.triangles[id.get<std::size_t>()]; };
  std::vector<std::size_t> region(pairs.size(), pairs.size());
  for (std::size_t start = 0; start < pairs.size(); ++start) {
    if (region[start] < pairs.size()) continue;
    std::vector<std::size_t> open = {start};
    region[start] = start;
    while (!open.empty()) {
      const nlohmann::json at = pairs[open.back()];
      open.pop_back();
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (region[i] < pairs.size()) continue;
        if (!share(corners(a, at["triangle_a"]), corners(a, pairs[i]["triangle_a"]))) continue;
        if (!share(corners(b, at["triangle_b"]), corners(b, pairs[i]["triangle_b"]))) continue;
        region[i] = start;
        open.push_back(i);
      }
    }
  }
  return region;
}

TEST(ProgramContacts, RegionsAreConnectedPairs) {
  const Folder folder;
  const Mesh sheet = scenes::wave_sheet(22, 22, 3), other = scenes::wave_sheet(22, 22, 9);
  const std::string a = folder.store("a.obj", sheet), b = folder.store("b.obj", other);
  for (const std::string margin : {"0", "0.05"}) {
    const std::string line = "contacts " + a + ' ' + b + " --margin " + margin + " --regions";
    const nlohmann::json json = json_of(line);
    const std::vector<nlohmann::json> pairs = json["pairs"], regions = json["regions"];
    const std::vector<std::size_t> expected = flooded_regions(pairs, sheet, other);
    ASSERT_GT(regions.size(), 2U);
    std::map<std::size_t, std::size_t> number_of;
    std::vector<std::size_t> counts(regions.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const std::size_t found = pairs[i]["region"];
      EXPECT_EQ(number_of.try_emplace(expected[i], found).first->second, found) << i;
      ++counts.at(found);
      const nlohmann::json& region = regions[found];
      EXPECT_LE(region["distance"], pairs[i]["distance"]);
      EXPECT_GE(region["depth"], pairs[i]["depth"]);
      for (const char* const point : {"point_a", "point_b"}) {
        const Vec3 p = point_of(pairs[i][point]), low = point_of(region["low"]), high = point_of(region["high"]);
        EXPECT_TRUE(min(p, low) == low && max(p, high) == high);
      }
    }
    EXPECT_EQ(number_of.size(), regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
      EXPECT_EQ(regions[r]["count"], counts[r]);
      EXPECT_GE(regions[r > 0 ? r - 1 : 0]["depth"], regions[r]["depth"]);
    }
    EXPECT_NE(answer_to(line).find("regions   " + std::to_string(regions.size())), std::string::npos);
    // Where few pairs are written, regions are still those of all.
    const nlohmann::json few = json_of(line + " --max-count 1");
    EXPECT_EQ(few["regions"], json["regions"]);
    EXPECT_EQ(few["pairs"].size(), 1U);
    EXPECT_EQ(table_of(answer_to(line + " --out -"))[0].at("region"), std::to_string(pairs[0]["region"].get<int>()));
  }
  expect_refused("contacts " + a + ' ' + b + " --intersections --regions", "--margin");
}

}  // namespace
}  // namespace limber::program_tests
