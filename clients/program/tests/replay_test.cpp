// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "page_decoding.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

/// A waving sheet in frames 0 to `count` - 1. What is left of its middle stands still after frame 2.
std::vector<Mesh> waves(std::uint32_t count, std::uint32_t side) {
  std::vector<Mesh> meshes;
  for (std::uint32_t f = 0; f < count; ++f) {
    Mesh sheet = scenes::wave_sheet(side, side, f);
    const Mesh early = scenes::wave_sheet(side, side, std::min(f, 2U));
    for (VertexId v = 0; v < sheet.positions().size() / 2; ++v) {
      sheet.set_position(v, early.positions()[v]).value();
    }
    meshes.push_back(std::move(sheet));
  }
  return meshes;
}

std::string stored(const Folder& folder, const std::vector<Mesh>& meshes) {
  Words files;
  for (const Mesh& mesh : meshes) files.push_back(folder.store("wave" + std::to_string(files.size()) + ".obj", mesh));
  return joined(files);
}

/// Every frame that the page keeps, next to the meshes; `stride` of those are between two.
void expect_frames(const nlohmann::json& model, const std::vector<Mesh>& meshes, std::size_t stride) {
  const std::vector<VertexId> order = page_order(meshes.front());
  const auto frames = frames_of(model["frames"], order.size());
  ASSERT_EQ(frames.size(), (meshes.size() + stride - 1) / stride);
  Vec3 low = meshes.front().positions().front(), high = low;
  for (const Vec3& p : meshes.front().positions()) {
    low = min(low, p);
    high = max(high, p);
  }
  double largest_error = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (std::size_t v = 0; v < order.size(); ++v) {
      const Vec3 error = frames[f][v] - meshes[f * stride].positions()[order[v]];
      largest_error = std::max(largest_error, max_abs(error));
    }
  }
  EXPECT_GT(largest_error, 0);
  EXPECT_LE(largest_error, model["frames"]["step"].get<double>() * 0.50001);
  EXPECT_LT(model["frames"]["step"].get<double>(), 1e-4 * length(high - low));
}

TEST(ProgramReplay, HoldsAllFramesWithinHalfAStepAndAllAnswers) {
  const Folder folder;
  const std::vector<Mesh> meshes = waves(70, 12);  // more than two runs of frames that build on each other
  std::string poses;
  for (int f = 0; f < 70; ++f) poses += std::to_string(3 + 0.1 * f) + ",5,3.5,1,0," + std::to_string(0.01 * f) + ",0\n";
  const Report report("track --b scene:ball --relative-error 0.5 --contacts --margin 3 --json --a " +
                      stored(folder, meshes) + " --poses-b " + folder.store("poses.csv", poses));
  EXPECT_EQ(report.outcome.err, "");
  const nlohmann::json& data = report.data;
  const std::vector<nlohmann::json> lines = json_lines_of(report.outcome);
  ASSERT_EQ(lines.size(), 70U);
  EXPECT_EQ(data["stride"], 1);
  EXPECT_EQ(data["frame_count"], 70);
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
  expect_frames(data["models"][0], meshes, 1);

  const nlohmann::json& ball = data["models"][1];
  const Mesh expected = scenes::thesis_ball();
  const std::vector<VertexId> order = page_order(expected);
  const std::vector<Vec3> points = points_of(ball["positions"]);
  ASSERT_EQ(points.size(), order.size());
  for (std::size_t v = 0; v < points.size(); ++v) {
    EXPECT_LT(max_abs(points[v] - expected.positions()[order[v]]), 1e-7);
  }
  const std::vector<Transform> found = poses_of(ball["poses"]);
  ASSERT_EQ(found.size(), 70U);
  for (std::size_t f = 0; f < found.size(); ++f) {
    EXPECT_EQ(found[f].translation, (Vec3{std::stod(std::to_string(3 + 0.1 * static_cast<double>(f))), 5, 3.5}));
    EXPECT_TRUE(is_rigid(found[f]));
  }
  EXPECT_EQ(poses_of(data["models"][0]["poses"]).size(), 1U);
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
  expect_frames(report.data["models"][0], meshes, stride);
  EXPECT_LT(report.page.size(), 1'200'000U);
}

TEST(ProgramReplay, FramesThatArePlayedAgainAreStoredOnce) {
  const Folder folder;
  const std::vector<Mesh> meshes = waves(4, 8);
  const Report report("track --b scene:ball --loop 3 --a " + stored(folder, meshes));
  EXPECT_EQ(report.data["frame_count"], 4);
  EXPECT_EQ(report.data["rows"]["status"].size(), 12U);
  expect_frames(report.data["models"][0], meshes, 1);
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
