// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>

#include "program/contact_meshes.h"
#include "program/run_program.h"

namespace limber::program_tests {
namespace {

/// A strip that folds over itself: first above, then through, then above again.
Words stored_strips(const Folder& folder) {
  return {folder.store("0.obj", folded_strip(0.25, 0.25)), folder.store("1.obj", folded_strip(0.2, -0.2)),
          folder.store("2.obj", folded_strip(0.25, 0.3))};
}

TEST(ProgramTrackContacts, EachFrameHasTheContactsOfStillModels) {
  const Folder folder;
  const Words strips = stored_strips(folder);
  const std::string poses = folder.store("poses.csv", "0.5,0.5,3,1,0,0,0\n0.5,0.5,1,1,0,0,0\n0.5,0.5,1.4,1,0,0,0\n");
  const Words heights = {"3", "1", "1.4"};
  const Words options = {"--poses-b", poses, "--contacts", "--margin", "0.2"};
  Words with_json = options;
  with_json.emplace_back("--json");
  const std::vector<Row> rows = table_of(run(track(strips, {"scene:ball"}, options)).out);
  const std::vector<nlohmann::json> objects = json_lines_of(run(track(strips, {"scene:ball"}, with_json)));
  ASSERT_EQ(rows.size(), 3U);
  ASSERT_EQ(objects.size(), 3U);
  for (std::size_t f = 0; f < 3; ++f) {
    SCOPED_TRACE(f);
    const nlohmann::json still = json_of(run({"contacts", strips[f], "scene:ball", "--pose-b",
                                              "0.5,0.5," + heights[f] + ",1,0,0,0", "--margin", "0.2", "--json"}));
    const nlohmann::json& contact = objects[f]["contact"];
    EXPECT_EQ(contact["count"], still["count"]);
    EXPECT_EQ(contact["intersecting"], still["intersecting"]);
    EXPECT_EQ(contact["count"] > 0, f > 0);
    EXPECT_EQ(number(rows[f].at("contact_count")), still["count"].get<double>());
    EXPECT_EQ(number(rows[f].at("contact_intersecting")), still["intersecting"].get<double>());
    EXPECT_GT(number(rows[f].at("contact_us")), 0);
    EXPECT_GT(contact["query_us"].get<double>(), 0);
    EXPECT_EQ(rows[f].count("self_a_count"), 0U);
    EXPECT_FALSE(objects[f].contains("self_a"));
    if (f == 0) {
      EXPECT_TRUE(contact["pair"].is_null());
      for (const char* column : {"contact_triangle_a", "contact_distance", "contact_normal_z", "contact_face_b"}) {
        EXPECT_EQ(rows[f].at(column), "") << column;
      }
      continue;
    }
    EXPECT_EQ(contact["pair"], still["pairs"][0]);
    EXPECT_EQ(number(rows[f].at("contact_triangle_b")), contact["pair"]["triangle_b"].get<double>());
    EXPECT_EQ(number(rows[f].at("contact_depth")), contact["pair"]["depth"].get<double>());
    EXPECT_EQ(number(rows[f].at("contact_normal_z")), contact["pair"]["normal"][2].get<double>());
    EXPECT_EQ(rows[f].at("contact_feature_a"), contact["pair"]["feature_a"].get<std::string>());
  }
}

TEST(ProgramTrackContacts, ModelsThatDeformMeetThemselves) {
  const Folder folder;
  const Words strips = stored_strips(folder);
  const Words counts = {"0", "3", "0"};
  const std::vector<Row> rows = table_of(run(track(strips, {"scene:ball"}, {"--self"})).out);
  ASSERT_EQ(rows.size(), 3U);
  for (std::size_t f = 0; f < 3; ++f) {
    EXPECT_EQ(rows[f].at("self_a_count"), counts[f]);
    EXPECT_EQ(rows[f].at("self_a_intersecting"), counts[f]);
    EXPECT_EQ(rows[f].count("self_b_count"), 0U);  // the ball does not deform
    EXPECT_EQ(rows[f].count("contact_count"), 0U);
    EXPECT_EQ(rows[f].at("self_a_triangle_b").empty(), f != 1);
  }
  const Words later = {strips[0], strips[2], strips[1]};
  const std::vector<nlohmann::json> both =
      json_lines_of(run(track(strips, later, {"--self", "--contacts", "--margin", "0.01", "--json"})));
  ASSERT_EQ(both.size(), 3U);
  for (const auto& [f, count_a, count_b] : {std::array{0, 0, 0}, std::array{1, 3, 0}, std::array{2, 0, 3}}) {
    const nlohmann::json& frame = both[static_cast<std::size_t>(f)];
    EXPECT_EQ(frame["self_a"]["count"], count_a);
    EXPECT_EQ(frame["self_b"]["count"], count_b);
    EXPECT_EQ(frame["self_a"]["pair"].is_null(), count_a == 0);
    EXPECT_EQ(frame["self_b"]["pair"].is_null(), count_b == 0);
  }
  EXPECT_GE(both[0]["contact"]["intersecting"].get<int>(), 8);  // each triangle with itself at least
}

TEST(ProgramTrackContacts, OtherColumnsStayAsTheyAre) {
  const Folder folder;
  const Words strips = stored_strips(folder);
  const auto header_with = [&](const Words& options) {
    return lines_of(run(track(strips, {"scene:ball"}, options)).out).at(0);
  };
  const std::string without = header_with({});
  EXPECT_EQ(header_with({"--contacts", "--self"}), without + header_with({"--contacts"}).substr(without.size()) +
                                                       header_with({"--self"}).substr(without.size()));
  EXPECT_EQ(header_with({"--contacts"})
                .find(without + ",contact_us,contact_count,contact_intersecting,"
                                "contact_triangle_a,contact_triangle_b,contact_distance,"),
            0U);
}

}  // namespace
}  // namespace limber::program_tests
