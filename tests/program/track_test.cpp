// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <map>

#include "program/run_program.h"
#include "scenes/scenes.h"

namespace limber::program_tests {
namespace {

/// The rows of a run that must succeed.
std::vector<Row> rows_of(const Outcome& outcome) {
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return table_of(outcome.out);
}

std::vector<nlohmann::json> json_rows_of(const Outcome& outcome) {
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return json_lines_of(outcome);
}

/// A waving sheet of 128 triangles in frames 0 to `count` - 1; its edge along x = 0 stands still where `is_partial`.
Words stored_waves(const Folder& folder, std::uint32_t count, bool is_partial) {
  Words files;
  for (std::uint32_t f = 0; f < count; ++f) {
    const Mesh still = scenes::wave_sheet(8, 8, 0);
    Mesh sheet = scenes::wave_sheet(8, 8, f);
    for (VertexId v = 0; is_partial && v < sheet.positions().size(); ++v) {
      if (sheet.positions()[v].x < 2) sheet.set_position(v, still.positions()[v]).value();
    }
    files.push_back(folder.store("wave" + std::to_string(f) + ".obj", sheet));
  }
  return files;
}

constexpr const char* ball_above = "2,2,1.5,1,0,0,0\n";

TEST(ProgramTrack, PrintsOneRowPerFrameWithTheDocumentedColumns) {
  const Folder folder;
  const Words waves = stored_waves(folder, 3, false);
  const std::string poses = folder.store("pose.csv", ball_above);
  const Outcome outcome = run(track(waves, {"scene:ball"}, {"--poses-b", poses}));
  const auto classic_rows = rows_of(run(track(waves, {"scene:ball"}, {"--poses-b", poses, "--engine", "classic"})));
  EXPECT_EQ(outcome.err, "");  // no progress bar outside a terminal
  EXPECT_EQ(lines_of(outcome.out).front(),
            "frame,update_us,query_us,status,lower,upper,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,"
            "triangle_a,triangle_b,face_a,face_b,moved_vertices,refits,absorbed,node_tests,triangle_tests");
  const auto rows = rows_of(outcome);
  ASSERT_EQ(rows.size(), 3U);
  for (std::size_t f = 0; f < rows.size(); ++f) {
    EXPECT_EQ(rows[f].at("frame"), std::to_string(f));
    EXPECT_EQ(rows[f].at("status"), "exact");
  }
  EXPECT_EQ(rows[0].at("moved_vertices"), "0");
  EXPECT_EQ(rows[1].at("moved_vertices"), "81");
  EXPECT_EQ(rows[1].at("refits"), "4");  // 8-nodes: two above leaves, and their ancestors
  EXPECT_EQ(classic_rows[1].at("refits"), "255");
  EXPECT_NEAR(number(rows[1].at("upper")), number(classic_rows[1].at("upper")), 1e-14);
}

TEST(ProgramTrack, FramesGiveTheDistancesOfStillModels) {
  const Folder folder;
  const Words waves = stored_waves(folder, 4, false);
  const std::string poses = folder.store("pose.csv", ball_above);
  const auto rows = json_rows_of(run(track(waves, {"scene:ball"}, {"--poses-b", poses, "--json"})));
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t f = 0; f < rows.size(); ++f) {
    const nlohmann::json still =
        json_of(run({"distance", waves[f], "scene:ball", "--pose-b", "2,2,1.5,1,0,0,0", "--json"}));
    EXPECT_EQ(rows[f]["upper"], still["upper"]) << f;
    EXPECT_EQ(rows[f]["lower"], rows[f]["upper"]);
    EXPECT_EQ(rows[f]["witness"], still["witness"]);
    EXPECT_TRUE(rows[f]["witness"]["face_b"].is_number());
  }
}

TEST(ProgramTrack, MaintenanceModesDoDifferentWorkForTheSameDistances) {
  const Folder folder;
  const Words waves = stored_waves(folder, 4, true);
  const std::string poses = folder.store("pose.csv", ball_above);
  std::map<std::string, std::vector<nlohmann::json>> rows;
  for (const std::string mode : {"immediate", "batched", "by-depth"}) {
    rows[mode] = json_rows_of(
        run(track(waves, {"scene:ball"}, {"--poses-b", poses, "--json", "--engine", "classic", "--mode", mode})));
    ASSERT_EQ(rows[mode].size(), 4U);
  }
  const auto loose = json_rows_of(
      run(track(waves, {"scene:ball"},
                {"--poses-b", poses, "--json", "--engine", "classic", "--extra-radius", "0.3", "--stale-ratio", "3"})));
  std::uint64_t absorbed = 0;
  for (std::size_t f = 0; f < 4; ++f) {
    for (const std::string mode : {"immediate", "batched"}) {
      EXPECT_EQ(rows[mode][f]["upper"], rows["by-depth"][f]["upper"]);
      EXPECT_EQ(rows[mode][f]["moved_vertices"], rows["by-depth"][f]["moved_vertices"]);
    }
    EXPECT_EQ(loose[f]["upper"], rows["by-depth"][f]["upper"]);
    absorbed += loose[f]["absorbed"].get<std::uint64_t>();
    if (f == 0) continue;
    const auto refits = [&](const std::string& mode) { return rows[mode][f]["refits"].get<std::uint64_t>(); };
    EXPECT_GT(refits("immediate"), refits("batched"));
    EXPECT_GT(refits("batched"), refits("by-depth"));
    EXPECT_LT(rows["by-depth"][f]["moved_vertices"], 81);
  }
  EXPECT_GT(absorbed, 0U);
}

TEST(ProgramTrack, MotionMarginOfTheFastEngineAbsorbsAndChangesNoDistance) {
  const Folder folder;
  const Words waves = stored_waves(folder, 4, true);
  const std::string poses = folder.store("pose.csv", ball_above);
  const auto tight = json_rows_of(run(track(waves, {"scene:ball"}, {"--poses-b", poses, "--json"})));
  for (const std::string margin : {"0.5", "0.1"}) {
    const auto loose =
        json_rows_of(run(track(waves, {"scene:ball"}, {"--poses-b", poses, "--json", "--motion-margin", margin})));
    std::uint64_t absorbed = 0;
    for (std::size_t f = 0; f < 4; ++f) {
      EXPECT_NEAR(loose[f]["upper"].get<double>(), tight[f]["upper"].get<double>(), 1e-14);
      absorbed += loose[f]["absorbed"].get<std::uint64_t>();
    }
    EXPECT_GT(absorbed, 0U) << margin;
  }
}

TEST(ProgramTrack, PosesMoveRigidModels) {
  const Folder folder;
  const std::string poses = folder.store("poses.csv",
                                         "tx,ty,tz,qw,qx,qy,qz\r\n# closer and closer\r\n0,0,4,1,0,0,0\r\n\r\n"
                                         "0,0,3,1,0,0,0\r\n 0, 0, 1.5, 1, 0, 0, 0\r\n0,0,0.5,1,0,0,0");
  const auto rows = rows_of(run({"track", "--a", "scene:ball", "--b", "scene:square", "--poses-a", poses}));
  ASSERT_EQ(rows.size(), 4U);
  const double distances[] = {3, 2, 0.5, 0};
  for (std::size_t f = 0; f < 4; ++f) {
    EXPECT_EQ(number(rows[f].at("upper")), distances[f]);
    EXPECT_EQ(rows[f].at("moved_vertices"), "0");
  }
  EXPECT_EQ(rows[1].at("point_a_z"), "2");
  EXPECT_EQ(rows[3].at("status"), "collision");
}

TEST(ProgramTrack, HeadersNameTheColumnsOfPosesInAnyOrder) {
  const Folder folder;
  const auto distance_with = [&](const std::string& csv) {
    const auto rows = rows_of(
        run({"track", "--a", "scene:ball", "--b", "scene:square", "--poses-a", folder.store("poses.csv", csv)}));
    return rows.size() == 1 ? number(rows[0].at("upper")) : -1;
  };
  // Half a turn about x and then 3 along z, as some programs order the numbers; and with a column of ours in between.
  EXPECT_NEAR(distance_with("tx,ty,tz,qx,qy,qz,qw\n0,0,3,1,0,0,0\n"), 2, 1e-14);
  EXPECT_EQ(distance_with("frame,tz,ty,tx,qw,qx,qy,qz\n17,3,0,0,1,0,0,0\n"), 2);
  EXPECT_EQ(distance_with("\xEF\xBB\xBF\"tx\",ty,tz,qw,qx,qy,qz\n\"0\",0,3,1,0,0,0\n"), 2);
}

TEST(ProgramTrack, MaxDistanceLeavesCellsEmptyAndFieldsNull) {
  const Folder folder;
  const std::string poses = folder.store("poses.csv", "0,0,4,1,0,0,0\n0,0,1.032987,1,0,0,0\n");
  const Words words = {"track",     "--a", "scene:ball",     "--b", "scene:square",
                       "--poses-a", poses, "--max-distance", "1.5"};
  const auto rows = rows_of(run(words));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("status"), "beyond_limit");
  EXPECT_EQ(rows[0].at("lower"), "1.5");
  for (const char* column : {"upper", "point_a_x", "point_b_z", "triangle_a", "triangle_b", "face_a", "face_b"}) {
    EXPECT_EQ(rows[0].at(column), "") << column;
    EXPECT_NE(rows[1].at(column), "") << column;
  }
  EXPECT_EQ(rows[1].at("status"), "exact");
  Words with_json = words;
  with_json.push_back("--json");
  const auto json = json_rows_of(run(with_json));
  EXPECT_TRUE(json[0]["upper"].is_null());
  EXPECT_TRUE(json[0]["witness"].is_null());
  EXPECT_EQ(json[1]["upper"].get<double>(), number(rows[1].at("upper")));
}

TEST(ProgramTrack, BothModelsMayDeform) {
  const auto rows = json_rows_of(
      run({"track", "--a", "scene:wave:0", "scene:wave:1", "--b", "scene:wave:5", "scene:wave:6", "--json"}));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1]["moved_vertices"], 2 * 10201);
}

TEST(ProgramTrack, LoopsRepeatTheSequence) {
  const Folder folder;
  const Words waves = stored_waves(folder, 3, false);
  const std::string poses = folder.store("pose.csv", ball_above);
  const auto rows = json_rows_of(run(track(waves, {"scene:ball"}, {"--poses-b", poses, "--json", "--loop", "3"})));
  ASSERT_EQ(rows.size(), 9U);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    EXPECT_EQ(rows[r]["frame"], r);
    EXPECT_EQ(rows[r]["upper"], rows[r % 3]["upper"]);
  }
  EXPECT_EQ(rows[3]["moved_vertices"], 81);
}

TEST(ProgramTrack, ChangedConnectivityStopsAfterTheRowsBefore) {
  const Folder folder;
  Words waves = stored_waves(folder, 3, false);
  waves[2] = folder.store("other.obj", scenes::wave_sheet(8, 9, 0));
  const Outcome outcome = run(track(waves, {"scene:ball"}, {}));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(lines_of(outcome.out).size(), 3U) << outcome.out;  // the header and frames 0 and 1
  ASSERT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
  for (const char* part : {"limber: track: ", "frame 2", "144", "128", "90", "81"}) {
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << " in " << outcome.err;
  }
}

TEST(ProgramTrack, ErrorsOfLaterFramesKeepEarlierRows) {
  const Folder folder;
  Words waves = stored_waves(folder, 2, false);
  waves.push_back(folder.path("missing.obj"));
  const Outcome outcome = run(track(waves, {"scene:ball"}, {"--json"}));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(lines_of(outcome.out).size(), 2U);
  EXPECT_EQ(lines_of(outcome.err).size(), 1U);
}

TEST(ProgramTrack, OneModelMayDeformWhileTheOtherMoves) {
  const Folder folder;
  const Words waves = stored_waves(folder, 2, false);
  const std::string poses = folder.store("poses.csv", "2,2,3,1,0,0,0\n2,2,2,1,0,0,0\n");
  const auto rows = json_rows_of(run(track(waves, {"scene:ball"}, {"--poses-b", poses, "--json"})));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_GT(rows[0]["upper"].get<double>(), rows[1]["upper"].get<double>());
}

}  // namespace
}  // namespace limber::program_tests
