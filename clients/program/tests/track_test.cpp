// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <tuple>

#include "contact_meshes.h"
#include "formats/scenes.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

/// The files of a waving sheet of 128 triangles in frames 0 to `count` - 1; half of it stands still if it `is_partial`.
Words stored_waves(const Folder& folder, std::uint32_t count, bool is_partial = false) {
  Words files;
  const Mesh still = wave_sheet(8, 8, 0);
  for (std::uint32_t f = 0; f < count; ++f) {
    Mesh sheet = wave_sheet(8, 8, f);
    for (VertexId v = 0; is_partial && v < sheet.positions().size(); ++v) {
      if (sheet.positions()[v].x < 2) sheet.set_position(v, still.positions()[v]).value();
    }
    files.push_back(folder.store("wave" + std::to_string(f) + ".obj", sheet));
  }
  return files;
}

/// The line that tracks a deforming mesh below a ball.
std::string below_ball(const Folder& folder, const Words& frames) {
  return "track --a " + joined(frames) + " --b scene:ball --poses-b " + folder.store("pose.csv", "2,2,1.5,1,0,0,0\n");
}

TEST(ProgramTrack, FramesGiveTheDistancesOfStillModels) {
  const Folder folder;
  const Words waves = stored_waves(folder, 4);
  const auto rows = json_rows_of(below_ball(folder, waves));
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t f = 0; f < rows.size(); ++f) {
    const nlohmann::json still = json_of("distance " + waves[f] + " scene:ball --pose-b 2,2,1.5,1,0,0,0");
    EXPECT_EQ(rows[f]["frame"], f);
    EXPECT_EQ(rows[f]["moved_vertices"], f == 0 ? 0 : 81);
    EXPECT_DOUBLE_EQ(rows[f]["upper"].get<double>(), still["upper"].get<double>()) << f;
    // Of triangles that share the closest point, another may come first.
    for (const char* const point : {"point_a", "point_b"}) {
      const Vec3 off = point_of(rows[f]["witness"][point]) - point_of(still["witness"][point]);
      EXPECT_LE(max_abs(off), 1e-14);
    }
  }
  EXPECT_EQ(rows[1]["refits"], 4);  // 8-nodes: two above leaves, and their ancestors
}

TEST(ProgramTrack, AMotionMarginAbsorbsMovesAndKeepsTheDistances) {
  const Folder folder;
  const std::string line = below_ball(folder, stored_waves(folder, 4, true));
  const auto tight = json_rows_of(line), loose = json_rows_of(line + " --motion-margin 0.5");
  EXPECT_LT(tight[1]["moved_vertices"], 81);
  std::uint64_t absorbed = 0;
  for (std::size_t f = 0; f < 4; ++f) {
    EXPECT_NEAR(loose[f]["upper"].get<double>(), tight[f]["upper"], 1e-14);
    absorbed += loose[f]["absorbed"].get<std::uint64_t>();
  }
  EXPECT_GT(absorbed, 0U);
}

TEST(ProgramTrack, PosesMoveRigidModelsAndAClearanceIsKeptOrNot) {
  const Folder folder;
  const std::string line = "track --a scene:ball --b scene:square --poses-a " +
                           folder.store("poses.csv",
                                        "tx,ty,tz,qw,qx,qy,qz\r\n# closer and closer\r\n0,0,4,1,0,0,0\r\n\r\n"
                                        "0,0,3,1,0,0,0\r\n 0, 0, 1.5, 1, 0, 0, 0\r\n0,0,0.5,1,0,0,0");
  for (const auto& [options, marks, exit_code] :
       {std::tuple{" --min-clearance 0.25", "false false false true ", 3},  // distances are 3, 2, 0.5 and 0
        {" --min-clearance 2", "false false true true ", 3},
        {" --min-clearance 2.5 --max-distance 2.5", "false true true true ", 3},
        // Errors that are allowed do not decide.
        {" --min-clearance 2 --relative-error 1", "false false true true ", 3},
        {" --min-clearance 2 --absolute-error 1", "false false true true ", 3}}) {
    const Outcome outcome = run(line + options);
    std::string found;
    for (const Row& row : table_of(outcome.out)) found += row.at("too_close") + ' ';
    EXPECT_EQ(found, marks) << options;
    EXPECT_EQ(outcome.exit_code, exit_code) << options;
  }
  const std::vector<Row> rows = table_of(answer_to(line));
  ASSERT_EQ(rows.size(), 4U);
  const double distances[] = {3, 2, 0.5, 0};
  for (std::size_t f = 0; f < 4; ++f) EXPECT_EQ(number(rows[f].at("upper")), distances[f]);
  EXPECT_EQ(rows[1].at("point_a_z"), "2");
  EXPECT_EQ(rows[3].at("status"), "collision");
  EXPECT_EQ(rows[0].count("too_close"), 0U);
  expect_refused(line + " --min-clearance 2 --max-distance 1", "--max-distance");
  expect_refused(line + " --min-clearance 0", "--min-clearance");
}

TEST(ProgramTrack, TellsHowDeepClosedModelsAreInEachOther) {
  const Folder folder;
  const std::string small = folder.store("small.obj", scenes::ball(8, 4));
  Mesh half = scenes::ball(8, 4);
  for (VertexId v = 0; v < half.positions().size(); ++v) half.set_position(v, half.positions()[v] * 0.5).value();
  const Words balls = {small, folder.store("half.obj", half), small, small},
              poses = {"0,0,1.5,1,0,0,0", "0,0,0.25,1,0,0,0", "0,0,1.75,1,0,0,0", "0,0,5,1,0,0,0"};
  const std::string line =
      "track --a " + joined(balls) + " --b scene:ball --min-clearance 0.01 --poses-a " +
      folder.store("poses.csv", poses[0] + '\n' + poses[1] + '\n' + poses[2] + '\n' + poses[3] + '\n');
  const Report report(line + " --depth");
  const std::vector<Row> rows = table_of(report.outcome.out);
  const auto objects = json_lines_of(run(line + " --depth --json")), without = json_lines_of(run(line + " --json"));
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t f = 0; f < rows.size(); ++f) {
    SCOPED_TRACE(f);
    const nlohmann::json still =
        json_lines_of(run("distance --json " + balls[f] + " scene:ball --pose-a " + poses[f])).at(0);
    const double depth = still["depth"].is_null() ? 0 : still["depth"].get<double>();
    EXPECT_EQ(depth > 0, f < 3);
    EXPECT_EQ(number(rows[f].at("depth")), depth);
    EXPECT_EQ(objects[f]["depth"], depth);
    EXPECT_EQ(report.data["rows"]["depth"][f], depth);
    EXPECT_EQ(objects[f]["too_close"], f < 3);
    EXPECT_EQ(without[f]["too_close"], f % 2 == 0);  // surfaces do not meet where one ball has the other inside
    EXPECT_FALSE(without[f].contains("depth"));
  }
  expect_refused("track --a scene:ball --b scene:square --depth", "--depth: scene:square: the surface is not closed");
}

TEST(ProgramTrack, HeadersNameTheColumnsOfPosesInAnyOrder) {
  const Folder folder;
  const auto distance_with = [&](const std::string& csv) {
    const auto rows = json_rows_of("track --a scene:ball --b scene:square --poses-a " + folder.store("poses.csv", csv));
    return rows.size() == 1 ? rows[0]["upper"].get<double>() : -1;
  };
  // Half a turn about x and then 3 along z, as some programs order the numbers; and with a column of ours in between.
  EXPECT_NEAR(distance_with("tx,ty,tz,qx,qy,qz,qw\n0,0,3,1,0,0,0\n"), 2, 1e-14);
  EXPECT_EQ(distance_with("frame,tz,ty,tx,qw,qx,qy,qz\n17,3,0,0,1,0,0,0\n"), 2);
  EXPECT_EQ(distance_with("\xEF\xBB\xBF\"tx\",ty,tz,qw,qx,qy,qz\n\"0\",0,3,1,0,0,0\n"), 2);
}

TEST(ProgramTrack, BothModelsMayDeform) {
  const Folder folder;
  const Words waves = stored_waves(folder, 4);
  const auto rows = json_rows_of("track --a " + joined({waves[0], waves[1]}) + " --b " + joined({waves[2], waves[3]}));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1]["upper"], json_of("distance " + waves[1] + ' ' + waves[3])["upper"]);
  EXPECT_EQ(rows[1]["moved_vertices"], 2 * 81);
}

TEST(ProgramTrack, PartsThatTouchInTheFirstFrameMayPart) {
  const Folder folder;
  const auto two_triangles = [](const std::string& x) {
    return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv " + x + " 0 0\nv " + x + " 1 0\nv 9 0 0\nf 1 2 3\nf 4 6 5\n";
  };
  const std::string probe = folder.store("probe.obj", "v 3 0 0\nv 3 0 1\nv 3 1 1\nf 1 2 3\n");
  const std::string frames =
      folder.store("0.obj", two_triangles("1")) + " " + folder.store("1.obj", two_triangles("5"));
  EXPECT_EQ(json_rows_of("track --b " + probe + " --a " + frames)[1]["upper"], 2);
}

TEST(ProgramTrack, ErrorsOfLaterFramesKeepEarlierRows) {
  const Folder folder;
  Words waves = stored_waves(folder, 3);
  const auto error_with = [&](const std::string& last_frame) {
    waves[2] = last_frame;
    const Outcome outcome = run("track --b scene:ball --a " + joined(waves));
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(lines_of(outcome.out).size(), 3U) << outcome.out;  // the header and frames 0 and 1
    EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
    return outcome.err;
  };
  const std::string error = error_with(folder.store("other.obj", wave_sheet(8, 9, 0)));
  for (const char* part : {"limber: track: ", "frame 2", "144", "128", "90", "81"}) {
    EXPECT_NE(error.find(part), std::string::npos) << part << " in " << error;
  }
  error_with(folder.path("missing.obj"));
}

/// A strip that folds over itself: first above, then through, then above again.
Words stored_strips(const Folder& folder) {
  return {folder.store("0.obj", folded_strip(0.25, 0.25)), folder.store("1.obj", folded_strip(0.2, -0.2)),
          folder.store("2.obj", folded_strip(0.25, 0.3))};
}

TEST(ProgramTrackContacts, EachFrameHasTheContactsOfStillModels) {
  const Folder folder;
  const Words strips = stored_strips(folder), poses = {"0.5,0.5,3,1,0,0,0", "0.5,0.5,1,1,0,0,0", "0.5,0.5,1.4,1,0,0,0"};
  const std::string line = "track --b scene:ball --contacts --margin 0.2 --a " + joined(strips) + " --poses-b " +
                           folder.store("poses.csv", poses[0] + '\n' + poses[1] + '\n' + poses[2] + '\n');
  const std::vector<Row> rows = table_of(answer_to(line));
  const auto objects = json_rows_of(line);
  ASSERT_EQ(objects.size(), 3U);
  for (std::size_t f = 0; f < 3; ++f) {
    SCOPED_TRACE(f);
    const nlohmann::json still = json_of("contacts " + strips[f] + " scene:ball --margin 0.2 --pose-b " + poses[f]);
    const nlohmann::json& contact = objects[f]["contact"];
    EXPECT_EQ(contact["count"], still["count"]);
    EXPECT_EQ(contact["intersecting"], still["intersecting"]);
    EXPECT_EQ(contact["count"] > 0, f > 0);
    EXPECT_EQ(contact["pair"], f == 0 ? nlohmann::json(nullptr) : still["pairs"][0]);
    expect_same(rows[f], objects[f]);
    EXPECT_EQ(rows[f].at("contact_distance").empty(), f == 0);
  }
}

TEST(ProgramTrackContacts, ModelsThatDeformMeetThemselves) {
  const Folder folder;
  const Words strips = stored_strips(folder), counts = {"0", "3", "0"};
  const std::vector<Row> rows = table_of(answer_to("track --b scene:ball --self --a " + joined(strips)));
  ASSERT_EQ(rows.size(), 3U);
  for (std::size_t f = 0; f < 3; ++f) {
    EXPECT_EQ(rows[f].at("self_a_count"), counts[f]);
    EXPECT_EQ(rows[f].at("self_a_intersecting"), counts[f]);
    EXPECT_EQ(rows[f].count("self_b_count"), 0U);  // the ball does not deform
    EXPECT_EQ(rows[f].count("contact_count"), 0U);
    EXPECT_EQ(rows[f].at("self_a_triangle_b").empty(), f != 1);
  }
  const auto both = json_rows_of("track --self --contacts --margin 0.01 --a " + joined(strips) + " --b " +
                                 joined({strips[0], strips[2], strips[1]}));
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

}  // namespace
}  // namespace limber::program_tests
