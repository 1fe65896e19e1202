// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "page_decoding.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

/// A waving sheet in frames 0 to `count` - 1.
std::vector<Mesh> waves(std::uint32_t count, std::uint32_t side) {
  std::vector<Mesh> meshes;
  for (std::uint32_t f = 0; f < count; ++f) meshes.push_back(scenes::wave_sheet(side, side, f));
  return meshes;
}

std::string stored(const Folder& folder, const std::vector<Mesh>& meshes) {
  Words files;
  for (const Mesh& mesh : meshes) files.push_back(folder.store("wave" + std::to_string(files.size()) + ".obj", mesh));
  return joined(files);
}

TEST(ProgramReplay, HoldsAllAnswers) {
  const Folder folder;
  const std::vector<Mesh> meshes = waves(10, 12);
  std::string poses;
  for (int f = 0; f < 10; ++f) poses += std::to_string(3 + 0.1 * f) + ",5,3.5,1,0," + std::to_string(0.01 * f) + ",0\n";
  const Report report("track --b scene:ball --relative-error 0.5 --contacts --margin 3 --json --a " +
                      stored(folder, meshes) + " --poses-b " + folder.store("poses.csv", poses));
  EXPECT_EQ(report.outcome.err, "");
  const nlohmann::json& data = report.data;
  const std::vector<nlohmann::json> lines = json_lines_of(report.outcome);
  ASSERT_EQ(lines.size(), 10U);
  EXPECT_EQ(data["stride"], 1);
  EXPECT_EQ(data["frame_count"], 10);
  bool has_interval = false, has_contacts = false;
  for (std::size_t r = 0; r < lines.size(); ++r) {
    for (const char* key : {"lower", "upper", "status", "update_us", "query_us", "moved_vertices"}) {
      EXPECT_EQ(data["rows"][key][r], lines[r][key]) << key << ' ' << r;
    }
    for (const char* key : {"query_us", "count", "intersecting"}) {
      EXPECT_EQ(data["contacts"][0][key][r], lines[r]["contact"][key]) << key << ' ' << r;
    }
    const nlohmann::json& witness = data["rows"]["witness"][r];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(witness[axis], lines[r]["witness"]["point_a"][axis]);
      EXPECT_EQ(witness[3 + axis], lines[r]["witness"]["point_b"][axis]);
    }
    EXPECT_EQ(witness[6], lines[r]["witness"]["triangle_a"]);
    EXPECT_EQ(witness[7], lines[r]["witness"]["triangle_b"]);
    has_interval = has_interval || lines[r]["lower"] != lines[r]["upper"];
    has_contacts = has_contacts || lines[r]["contact"]["count"] > 0;
  }
  EXPECT_TRUE(has_interval && has_contacts);
  EXPECT_EQ(data["models"][0]["frames"]["data"].size(), 10U);
  EXPECT_EQ(data["parts"]["name"], (nlohmann::json{"wave0.obj", "scene:ball"}));
}

TEST(ProgramReplay, HasTheClearanceThatIsRequired) {
  const Folder folder;
  const std::string poses = folder.store("poses.csv", "0,0,4,1,0,0,0\n0,0,2,1,0,0,0\n");
  const std::string line = "track --a scene:ball --b scene:square --poses-a " + poses;
  const Report with(line + " --min-clearance 2"), without(line);
  EXPECT_EQ(with.outcome.exit_code, 3);
  EXPECT_EQ(with.data["min_clearance"], 2);
  EXPECT_EQ(with.data["rows"]["too_close"], (nlohmann::json{false, true}));
  EXPECT_TRUE(without.data["min_clearance"].is_null());
  EXPECT_EQ(without.data["rows"]["too_close"], (nlohmann::json{nullptr, nullptr}));
}

TEST(ProgramReplay, ThinsOutFramesOfPagesThatWouldBeTooLargeAndSaysSo) {
  const Folder folder;
  const std::vector<Mesh> meshes = waves(13, 90);
  const Report report("track --b scene:ball --max-report-mb 1 --a " + stored(folder, meshes));
  const std::size_t stride = report.data["stride"];
  EXPECT_GE(stride, 2U);
  const std::string& error = report.outcome.err;
  ASSERT_EQ(lines_of(error).size(), 1U) << error;
  EXPECT_NE(error.find("1 of every " + std::to_string(stride) + " frames"), std::string::npos) << error;
  EXPECT_EQ(report.data["rows"]["upper"].size(), 13U);
  EXPECT_EQ(report.data["models"][0]["frames"]["data"].size(), (meshes.size() + stride - 1) / stride);
  EXPECT_LT(report.page.size(), 1'200'000U);
}

TEST(ProgramReplay, FramesThatArePlayedAgainAreStoredOnce) {
  const Folder folder;
  const std::vector<Mesh> meshes = waves(4, 8);
  const Report report("track --b scene:ball --loop 3 --a " + stored(folder, meshes));
  EXPECT_EQ(report.data["frame_count"], 4);
  EXPECT_EQ(report.data["rows"]["status"].size(), 12U);
  EXPECT_EQ(report.data["models"][0]["frames"]["data"].size(), 4U);
}

TEST(ProgramReplay, ModelsBeyondTheLimitHaveNoUpperBound) {
  const Folder folder;
  const Report report("track --b scene:ball --max-distance 2 --a " + stored(folder, waves(2, 8)) + " --poses-b " +
                      folder.store("far.csv", "0,0,90,1,0,0,0\n"));
  EXPECT_EQ(report.data["max_distance"], 2);
  for (std::size_t r = 0; r < 2; ++r) {
    EXPECT_EQ(report.data["rows"]["status"][r], "beyond_limit");
    EXPECT_TRUE(report.data["rows"]["upper"][r].is_null());
    EXPECT_TRUE(report.data["rows"]["witness"][r].is_null());
  }
}

TEST(ProgramReplay, IsRefusedWhereItHasNoRoom) {
  const Folder folder;
  const std::string line = "track --b scene:ball --a ", waving = line + stored(folder, waves(3, 8));
  const std::string report = " --report " + folder.path("r.html");
  expect_refused(waving + " --loop 40000" + report, "100000");
  expect_refused(waving + " --max-report-mb 5", "--report");
  const std::string near = folder.store("near.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string far = folder.store("far.obj", "v 0 0 1e40\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome outcome = run(line + near + ' ' + far + report);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("too far"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace limber::program_tests
