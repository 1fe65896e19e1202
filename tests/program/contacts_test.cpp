// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "limber/contacts.h"
#include "program/contact_meshes.h"
#include "program/run_program.h"
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

Vec3 point_in(const Row& row, const std::string& name) {
  return {number(row.at(name + "_x")), number(row.at(name + "_y")), number(row.at(name + "_z"))};
}

std::string name_of_feature(Feature feature) {
  if (feature.kind == FeatureKind::face) return "face";
  return (feature.kind == FeatureKind::vertex ? "vertex " : "edge ") + std::to_string(feature.index);
}

/// Two soups that meet in some places and are close in others.
struct Soups {
  Folder folder;
  Mesh a, b;
  std::string path_a, path_b;
  const std::string pose_b = "0.3,0.2,-0.1,0.3,-0.4,0.5,0.6";
  const Transform world_from_b = transform_from_quaternion({0.3, 0.2, -0.1}, 0.3, -0.4, 0.5, 0.6).value();

  explicit Soups(std::uint64_t seed) : Soups(scenes::Rng(seed)) {}

  /// The question about both, and `more`.
  Words ask(const Words& more) const {
    Words words = {"contacts", path_a, path_b, "--pose-b", pose_b};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

 private:
  explicit Soups(scenes::Rng rng)
      : a(scenes::random_soup(rng, 60, 0.8)),
        b(scenes::random_soup(rng, 50, 0.8)),
        path_a(folder.store("a.obj", a)),
        path_b(folder.store("b.obj", b)) {}
};

TEST(ProgramContacts, CrossingSquaresMeetInThreePairs) {
  const Folder folder;
  const std::string square = folder.store("square.obj", two_triangles());
  // The second square stands on the line y = 0 of the first, shifted along it by half a unit.
  const Words question = {"contacts", square, square, "--pose-b", "0.5,0,0,1,1,0,0"};
  const Ids expected = {{0, 0}, {0, 1}, {1, 1}};
  for (const Words& which : {Words{"--intersections"}, Words{"--margin", "0"}, Words{"--margin", "0.01"}}) {
    Words words = question;
    words.insert(words.end(), which.begin(), which.end());
    const Outcome text = run(words);
    EXPECT_EQ(text.exit_code, 0);
    EXPECT_EQ(text.out.find(which[0] == "--margin" ? "pairs     3, 3 of them at distance 0\n" : "pairs     3\n"), 0U)
        << text.out;
    EXPECT_EQ(count_of("more", text.out), 0U);
    words.emplace_back("--json");
    const nlohmann::json json = json_of(run(words));
    EXPECT_EQ(json["count"], 3);
    EXPECT_EQ(json["intersecting"], 3);
    EXPECT_EQ(ids_of(json), expected);
    EXPECT_EQ(json["margin"].is_null(), which[0] == "--intersections");
  }
}

TEST(ProgramContacts, ACubeInACubeIsCloseWithItsTop) {
  const Folder folder;
  // The top of the inner cube is half a unit below one of the two triangles of the outer top; all else is farther.
  const std::string outer = folder.store("outer.obj", cube({}, 3)), inner = folder.store("inner.obj", cube({}, 0.5));
  const auto ask = [&](const Words& which) {
    Words words = {"contacts", outer, inner, "--pose-b", "1.5,-1.5,2,1,0,0,0", "--json"};
    words.insert(words.end(), which.begin(), which.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(
        outcome.err,
        "limber: contacts: warning: B lies inside A without touching it; models are surfaces, not solids, so they "
        "do not collide\n");
    nlohmann::json json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json["inside"], "b_in_a");
    EXPECT_EQ(json["intersecting"], 0);
    return json;
  };
  EXPECT_EQ(ask({"--intersections"})["count"], 0);
  EXPECT_EQ(ask({"--margin", "0"})["count"], 0);
  EXPECT_EQ(ask({"--margin", "0.4"})["count"], 0);
  const nlohmann::json close = ask({"--margin", "0.6"});
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
  EXPECT_EQ(ask({"--closest", "7"})["count"], 7);
  EXPECT_EQ(ask({"--closest", "7"})["closest"], 7);
  EXPECT_EQ(ask({"--closest", "1000000"})["count"], 144);
}

TEST(ProgramContacts, RowsAndObjectsAreTheContactsOfTheLibrary) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const Soups soups(seed);
    const Model a(soups.a), b(soups.b);
    std::map<std::pair<TriangleId, TriangleId>, Contact> expected;
    const auto collect = [&](const Contact& c) { return expected[{c.triangle_a, c.triangle_b}] = c, true; };
    visit_contacts({a}, {b, soups.world_from_b}, 0.1, collect);
    EXPECT_EQ(expected.size(), reference::contacts({soups.a}, {soups.b, soups.world_from_b}, 0.1).size());
    ASSERT_GT(expected.size(), 20U);

    const std::string csv = soups.folder.path("contacts.csv");
    const nlohmann::json json = json_of(run(soups.ask({"--margin", "0.1", "--json", "--csv", csv})));
    EXPECT_EQ(json["count"], expected.size());
    EXPECT_EQ(ids_of(json).size(), expected.size());
    const std::vector<Row> rows = table_of(text_of(csv));
    ASSERT_EQ(rows.size(), expected.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Row& row = rows[i];
      const nlohmann::json& object = json["pairs"][i];
      const Contact& contact = expected.at({object["triangle_a"], object["triangle_b"]});
      EXPECT_EQ(number(row.at("triangle_a")), contact.triangle_a);
      EXPECT_EQ(number(row.at("triangle_b")), contact.triangle_b);
      EXPECT_EQ(number(row.at("distance")), contact.distance);
      EXPECT_EQ(number(row.at("depth")), contact.depth);
      EXPECT_EQ(point_in(row, "point_a"), contact.point_a);
      EXPECT_EQ(point_in(row, "point_b"), contact.point_b);
      EXPECT_EQ(point_in(row, "normal"), contact.normal);
      EXPECT_EQ(row.at("feature_a"), name_of_feature(contact.feature_a));
      EXPECT_EQ(row.at("feature_b"), name_of_feature(contact.feature_b));
      EXPECT_EQ(object["distance"], contact.distance);
      EXPECT_EQ(object["depth"], contact.depth);
      EXPECT_EQ(point_of(object["point_a"]), contact.point_a);
      EXPECT_EQ(point_of(object["point_b"]), contact.point_b);
      EXPECT_EQ(point_of(object["normal"]), contact.normal);
      EXPECT_EQ(object["feature_a"], row.at("feature_a"));
      EXPECT_EQ(object["feature_b"], row.at("feature_b"));
      EXPECT_EQ(contact.normal_side, NormalSide::unknown);  // of soups
      EXPECT_EQ(row.at("normal_side"), "unknown");
      EXPECT_EQ(object["normal_side"], "unknown");
    }
  }
}

TEST(ProgramContacts, PrintsExactlyTheDocumentedNames) {
  const Soups soups(1);
  const auto keys_of = [](const nlohmann::json& json) {
    Words keys;
    for (const auto& [key, value] : json.items()) keys.push_back(key);
    return keys;  // in alphabetical order
  };
  const nlohmann::json json = json_of(run(soups.ask({"--margin", "0.1", "--json"})));
  EXPECT_EQ(keys_of(json), (Words{"build_us", "closest", "count", "inside", "intersecting", "margin", "node_tests",
                                  "pairs", "query", "query_us", "triangle_tests"}));
  EXPECT_EQ(json["query"], "contacts");
  EXPECT_EQ(json["margin"], 0.1);
  EXPECT_TRUE(json["closest"].is_null());
  EXPECT_EQ(keys_of(json["pairs"][0]),
            (Words{"depth", "distance", "face_a", "face_b", "feature_a", "feature_b", "normal", "normal_side",
                   "point_a", "point_b", "triangle_a", "triangle_b"}));
  const nlohmann::json ids = json_of(run(soups.ask({"--intersections", "--json"})));
  EXPECT_EQ(keys_of(ids), keys_of(json));
  EXPECT_EQ(keys_of(ids["pairs"][0]), (Words{"face_a", "face_b", "triangle_a", "triangle_b"}));
  EXPECT_EQ(lines_of(run(soups.ask({"--margin", "0.1", "--csv", "-"})).out).front(),
            "triangle_a,triangle_b,distance,depth,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,"
            "normal_x,normal_y,normal_z,normal_side,feature_a,feature_b,face_a,face_b");
  EXPECT_EQ(lines_of(run(soups.ask({"--intersections", "--csv", "-"})).out).front(),
            "triangle_a,triangle_b,face_a,face_b");
}

TEST(ProgramContacts, TheDeepestComeFirstThenTheNearest) {
  const Soups soups(2);
  const std::vector<Row> rows = table_of(run(soups.ask({"--margin", "0.2", "--csv", "-"})).out);
  const auto key = [](const Row& row) {
    return std::tuple(-number(row.at("depth")), number(row.at("distance")), number(row.at("triangle_a")),
                      number(row.at("triangle_b")));
  };
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end(), [&](const Row& a, const Row& b) { return key(a) < key(b); }));
  EXPECT_GT(number(rows.front().at("depth")), 0);
  EXPECT_GT(number(rows.back().at("distance")), 0);
}

TEST(ProgramContacts, ALimitCutsRowsAndNotTheCount) {
  const Soups soups(3);
  const auto lines_with = [&](const Words& more) {
    Words words = soups.ask({"--margin", "0.2"});
    words.insert(words.end(), more.begin(), more.end());
    return lines_of(run(words).out);
  };
  const Words all = lines_with({"--csv", "-"});
  ASSERT_GT(all.size(), 20U);
  const auto count = static_cast<std::size_t>(all.size() - 1);
  for (const std::size_t limit : {std::size_t{0}, std::size_t{1}, std::size_t{15}, count, count + 1}) {
    const std::string text = std::to_string(limit);
    const std::size_t written = std::min(limit, count);
    const Words some = lines_with({"--csv", "-", "--limit", text});
    EXPECT_EQ(some, Words(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(written) + 1));
    const nlohmann::json json = nlohmann::json::parse(lines_with({"--json", "--limit", text}).at(0));
    EXPECT_EQ(json["count"], count);
    EXPECT_EQ(json["pairs"].size(), written);
    const Words lines = lines_with({"--limit", text});
    EXPECT_EQ(lines[0].find("pairs     " + std::to_string(count) + ", "), 0U) << lines[0];
    const std::size_t table = written == 0 ? 0 : 2 + written + (written < count ? 1 : 0);
    EXPECT_EQ(lines.size(), 3 + table);
  }
  // Without a limit a table has ten rows, and says how many others there are.
  EXPECT_EQ(lines_with({}).size(), 3U + 2 + 10 + 1);
  EXPECT_EQ(lines_with({}).back(), "and " + std::to_string(count - 10) + " more");
}

TEST(ProgramContacts, AMarginOfZeroFindsWhatIntersects) {
  for (int seed = 1; seed <= 2; ++seed) {  // of a lattice, where triangles touch in every way
    const std::string a = "scene:lattice:" + std::to_string(seed), b = "scene:lattice:" + std::to_string(seed + 100);
    const Words question = {"contacts", a, b, "--pose-b", "2,2,1,1,0,0,0", "--json"};
    const auto ask = [&](const Words& which) {
      Words words = question;
      words.insert(words.end(), which.begin(), which.end());
      return json_of(run(words));
    };
    const nlohmann::json by_ids = ask({"--intersections"}), at_zero = ask({"--margin", "0"});
    EXPECT_EQ(ids_of(by_ids), ids_of(at_zero));
    EXPECT_EQ(by_ids["count"], by_ids["intersecting"]);
    EXPECT_EQ(at_zero["count"], at_zero["intersecting"]);
    EXPECT_GT(at_zero["count"], 0);
  }
}

TEST(ProgramContacts, TheClosestAreTheFirstOfAll) {
  const Soups soups(4);
  const std::string apart = "2.5,0.3,-0.7,0.3,-0.4,0.5,0.6";
  const auto distances = [&](const Words& which) {
    Words words = {"contacts", soups.path_a, soups.path_b, "--pose-b", apart, "--json"};
    words.insert(words.end(), which.begin(), which.end());
    std::vector<double> found;
    const nlohmann::json answer = json_of(run(words));
    for (const nlohmann::json& pair : answer["pairs"]) found.push_back(pair["distance"]);
    return found;
  };
  const std::vector<double> all = distances({"--margin", "100"});
  EXPECT_EQ(all.size(), 60U * 50);
  for (const std::ptrdiff_t k : {1, 12, 500}) {
    EXPECT_EQ(distances({"--closest", std::to_string(k)}), std::vector<double>(all.begin(), all.begin() + k));
  }
}

TEST(ProgramContacts, FacesAreThoseOfTheFile) {
  const Folder folder;
  const std::string strip = folder.store("strip.obj",
                                         "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 3 1 0\n"
                                         "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n");
  const std::string far = folder.store("far.obj", "v 2.5 2 0\nf 1 1 1\n");
  const nlohmann::json json = json_of(run({"contacts", strip, far, "--margin", "1", "--json"}));
  ASSERT_EQ(json["count"], 1);
  const nlohmann::json& pair = json["pairs"][0];
  EXPECT_EQ(pair["triangle_a"], 5);
  EXPECT_EQ(pair["face_a"], 2);
  EXPECT_EQ(pair["face_b"], 0);
  EXPECT_EQ(pair["feature_a"], "edge 1");
  EXPECT_EQ(pair["feature_b"].get<std::string>().find("vertex "), 0U);
  EXPECT_EQ(point_of(pair["normal"]), (Vec3{0, 1, 0}));
}

TEST(ProgramContacts, ExitCodesTellWhetherThereIsAPairOnlyWhereAsked) {
  const auto ask = [](const std::string& pose, const Words& more) {
    Words words = {"contacts", "scene:ball", "scene:square", "--pose-a", pose};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.err, "");
    EXPECT_NE(outcome.out, "");
    return outcome.exit_code;
  };
  const std::string meeting = "0,0,0,1,0,0,0", two_apart = "0,0,3,1,0,0,0";
  EXPECT_EQ(ask(meeting, {"--intersections"}), 0);
  EXPECT_EQ(ask(meeting, {"--intersections", "--exit-code"}), 3);
  EXPECT_EQ(ask(meeting, {"--margin", "0", "--exit-code", "--json", "--limit", "0"}), 3);
  EXPECT_EQ(ask(two_apart, {"--intersections", "--exit-code"}), 0);
  EXPECT_EQ(ask(two_apart, {"--margin", "1.9", "--exit-code"}), 0);
  EXPECT_EQ(ask(two_apart, {"--margin", "2.1", "--exit-code"}), 3);
  EXPECT_EQ(ask(two_apart, {"--closest", "1", "--exit-code"}), 3);
}

TEST(ProgramContacts, AFileOfRowsLeavesTheAnswerAsItIs) {
  const Soups soups(5);
  const std::string csv = soups.folder.store("contacts.csv", "of yesterday\n");
  const Outcome outcome = run(soups.ask({"--margin", "0.1", "--csv", csv}));
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(outcome.out.find("pairs     "), 0U);
  EXPECT_NE(outcome.out.find("\n\ntriangle a  triangle b      distance         depth  features\n"), std::string::npos);
  EXPECT_EQ(text_of(csv), run(soups.ask({"--margin", "0.1", "--csv", "-"})).out);
  EXPECT_EQ(run(soups.ask({"--intersections", "--limit", "0", "--csv", csv})).exit_code, 0);
  EXPECT_EQ(text_of(csv), "triangle_a,triangle_b,face_a,face_b\n");
}

}  // namespace
}  // namespace limber::program_tests
