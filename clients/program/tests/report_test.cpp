// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pages: of one pair, of many pairs and parts, and of the frames of a sequence.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "contact_meshes.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

/// The rows of a page hold what the program has written as JSON.
void expect_rows(const nlohmann::json& rows, const std::vector<nlohmann::json>& lines, const Words& keys) {
  for (std::size_t r = 0; r < lines.size(); ++r) {
    for (const std::string& key : keys) EXPECT_EQ(rows[key][r], lines[r][key]) << key << ' ' << r;
    const nlohmann::json &found = rows["witness"][r], &witness = lines[r]["witness"];
    ASSERT_EQ(found.is_null(), witness.is_null()) << r;
    if (found.is_null()) continue;
    EXPECT_EQ(point_of(found), point_of(witness["point_a"])) << r;
    EXPECT_EQ((Vec3{found[3], found[4], found[5]}), point_of(witness["point_b"])) << r;
    for (const auto& [i, key] : {std::pair{6, "triangle_a"}, {7, "triangle_b"}, {8, "face_a"}, {9, "face_b"}}) {
      EXPECT_EQ(found[static_cast<std::size_t>(i)], witness[key]) << r;
    }
  }
}

const Words of_pairs = {"status", "lower", "upper", "clash", "solids", "depth", "too_close", "inside", "query_us"};

TEST(ProgramReport, HasTheAnswerOfTheSameRun) {
  const Soups soups(4, 0.2);
  for (const std::string options :
       {"", " --relative-error 0.3", " --min-clearance 2.5", " --min-clearance 0.001", " --max-distance 0.01"}) {
    const Report report("distance" + soups.files() + "--pose-b 3,0,0,1,2,3,4 --json" + options);
    const nlohmann::json json = nlohmann::json::parse(report.outcome.out), &pair = report.data["pair"];
    expect_rows(report.data["rows"], {json}, of_pairs);
    EXPECT_EQ(pair["node_tests"], json["node_tests"]);
    EXPECT_EQ(report.outcome.exit_code, json["too_close"] == true ? 3 : 0);
    EXPECT_EQ(pair["intersections"], 0);
  }
}

TEST(ProgramReport, MeshesOf200000TrianglesTakeLessThan8Megabytes) {
  const Folder folder;
  const Mesh sheet = wave_sheet(250, 200, 1);  // 100 000 triangles
  const std::string file = folder.store("sheet.obj", sheet);
  const Report report("distance " + file + ' ' + file + " --pose-b 0,0,40,0.9,0.1,0.2,0.3");
  EXPECT_EQ(report.outcome.exit_code, 0) << report.outcome.err;
  EXPECT_EQ(report.data["models"][0]["triangles"], 100000);
  EXPECT_GT(report.page.size(), 1'000'000U);
  EXPECT_LT(report.page.size(), 8'000'000U);
}

TEST(ProgramReport, NeedsNothingButItselfAndHasTheLicensesOfWhatIsInside) {
  const Report report("distance scene:square scene:ball --pose-b 0,0,3,1,0,0,0");
  const std::string &page = report.page, format = report.data["format"].dump();
  EXPECT_EQ(page.find("<!DOCTYPE html>"), 0U);
  EXPECT_NE(page.find("<meta name=\"limber-data\" content=\"" + format + "\">"), std::string::npos) << format;
  for (const char* part : {" src=\"", "@import", "href=\"http", "fetch(\"http", "importScripts"}) {
    EXPECT_EQ(page.find(part), std::string::npos) << part;
  }
  // Code is known by a mark that only one library has.
  const std::string notices = page.substr(page.find("id=\"notices\""));
  for (const auto& [mark, owner] : {std::pair("__THREE__", "three.js authors"), std::pair("u-legend", "Leon Sorokin"),
                                    std::pair("limber", "The limber authors")}) {
    EXPECT_NE(page.find(mark), std::string::npos) << mark;
    EXPECT_NE(notices.find(owner), std::string::npos) << owner;
  }
  EXPECT_EQ(count_of("to permit persons to", notices), 2U);
}

TEST(ProgramReport, NamesOfFilesAreOnlyText) {
  const Folder folder;
  folder.store("<!--<script>'$.obj", scenes::ball(8, 5));
  const std::string in_shell = '\'' + folder.path("<!--<script>'\\''$.obj") + '\'';
  const Report report("distance " + in_shell + " scene:ball --pose-b 0,0,3,1,0,0,0 --unit mm --title '<Fixture> 3'");
  EXPECT_EQ(report.data["models"][0]["name"], "<!--<script>'$.obj");
  EXPECT_EQ(report.page.find("<!--<script>"), std::string::npos);
  const std::string typed = report.data["command"];
  EXPECT_EQ(typed.find("limber distance " + in_shell + " scene:ball --pose-b 0,0,3,1,0,0,0 --unit"), 0U) << typed;
  EXPECT_EQ(report.data["title"], "<Fixture> 3");
  EXPECT_EQ(report.data["unit"], "mm");
  EXPECT_EQ(report.data["made_at"].get<std::string>().size(), std::string("2026-11-26 17:05 UTC").size());
}

TEST(ProgramReport, IsRefusedWhereItHasNoPlace) {
  const Folder folder;
  const std::string page = " --report " + folder.path("r.html"), frame = folder.store("0.obj", wave_sheet(2, 2, 0));
  const std::string track = "track --b scene:ball --a ", waving = track + frame + ' ' + frame;
  std::string poses;
  for (int i = 0; i <= 100'000; ++i) poses += "0,0,3,1,0,0,0\n";
  expect_all_refused(
      "", {{"distance scene:ball scene:ball --unit mm", "--report"},
           {"distance scene:ball scene:ball --title x", "--report"},
           {"track --a scene:ball --b scene:ball --poses-a " + folder.store("poses.csv", poses) + page, "100000"},
           {waving + " --max-report-mb 5", "--report"}});
  const std::string near = folder.store("near.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string far = folder.store("far.obj", "v 0 0 1e40\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome outcome = run(track + near + ' ' + far + page);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("too far"), std::string::npos) << outcome.err;
}

/// A closed cube with a corner at the origin.
Mesh cube_at_origin(double size) { return cube(Vec3{1, 1, 1} * (size / 2), size / 2); }

/// Cubes of size 4 and 1: the small one overlaps the large one, is inside, flush, near and far; and a square, which is
/// open, meets it.
struct Pairs {
  Folder folder;
  std::string large = folder.store("large.obj", cube_at_origin(4)),
              small = folder.store("small.obj", cube_at_origin(1));
  std::string file = folder.store("pairs.csv", "model_a,model_b,pose_b_tx,pose_b_ty,pose_b_tz\n" +  //
                                                   large + ',' + small + ",9,1,1\n" +               //
                                                   large + ',' + small + ",3.5,1,1\n" +             //
                                                   large + ',' + small + ",1,1,1.25\n" +            //
                                                   large + ',' + small + ",4,1,1\n" +               //
                                                   large + ',' + small + ",4.25,1,1\n" +            //
                                                   large + ",scene:square,1,1,1\n");
};

TEST(ProgramStudy, HasTheAnswersOfTheSameRun) {
  const Pairs pairs;
  for (const std::string options : {"", " --min-clearance 0.5", " --max-distance 1", " --relative-error 0.3"}) {
    SCOPED_TRACE(options);
    const Report report("distance --json --pairs " + pairs.file + options);
    const std::vector<nlohmann::json> lines = json_lines_of(report.outcome);
    EXPECT_EQ(report.data["kind"], "pairs");
    EXPECT_EQ(report.data["models"].size(), 3U);  // each once
    ASSERT_EQ(lines.size(), 6U);
    expect_rows(report.data["rows"], lines, of_pairs);
    EXPECT_EQ(report.outcome.exit_code, options == " --min-clearance 0.5" ? 3 : 0);
  }
}

TEST(ProgramStudy, TellsWhatStandsWhereAndHowDeepHardClashesAre) {
  const Pairs pairs;
  const nlohmann::json data = Report("distance --pairs " + pairs.file).data;
  const nlohmann::json &rows = data["rows"], &parts = data["parts"];
  EXPECT_EQ(parts["name"].size(), 12U);
  EXPECT_EQ(parts["name"][rows["b"][5].get<std::size_t>()], "scene:square");
  EXPECT_EQ(parts["file"][rows["a"][5].get<std::size_t>()], pairs.large);
  EXPECT_EQ(parts["model"], (nlohmann::json{0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 2}));
  EXPECT_EQ(data["models"][1]["name"], "small.obj");
  EXPECT_EQ(data["models"][1]["triangles"], 12);
  EXPECT_EQ(data["models"][1]["closed"], true);
  EXPECT_EQ(rows["clash"], (nlohmann::json{"clear", "hard_clash", "hard_clash", "touching", "clear", "surfaces_meet"}));
  EXPECT_EQ(rows["depth"][1], 0.5);
  EXPECT_NEAR(rows["depth"][2].get<double>(), 2, 1e-9);  // the small cube leaves by its nearest side, whole
  for (const std::size_t r : {0U, 3U, 4U, 5U}) EXPECT_TRUE(rows["depth"][r].is_null());
  for (const std::size_t r : {0U, 2U, 4U}) EXPECT_TRUE(rows["intersecting"][r].is_null());
  EXPECT_NE(rows["intersecting"][1][0], "");
}

TEST(ProgramStudy, OfPartsAsksAboutAllPairs) {
  const Folder folder;
  const std::string large = folder.store("large.obj", cube_at_origin(4)),
                    small = folder.store("small.obj", cube_at_origin(1));
  const std::string file = folder.store("parts.csv", "pose_tx,name,model\n0,block," + large + "\n4,\"pin, left\"," +
                                                         small + "\n7,," + small + "\n1,,scene:square\n");
  const Report report("distance --json --parts " + file + " --min-clearance 0.5");
  EXPECT_EQ(report.outcome.exit_code, 3);
  const std::vector<nlohmann::json> lines = json_lines_of(report.outcome);
  ASSERT_EQ(lines.size(), 6U);
  const std::size_t expected[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  const nlohmann::json& study = report.data;
  for (std::size_t r = 0; r < 6; ++r) {
    EXPECT_EQ(lines[r]["part_a"], expected[r][0]);
    EXPECT_EQ(lines[r]["part_b"], expected[r][1]);
    EXPECT_EQ(study["rows"]["a"][r], expected[r][0]);
    EXPECT_EQ(study["rows"]["b"][r], expected[r][1]);
  }
  EXPECT_EQ(lines[0]["name_a"], "block");
  EXPECT_EQ(lines[0]["name_b"], "pin, left");
  EXPECT_EQ(lines[1]["name_b"], "small.obj");
  EXPECT_EQ(lines[0]["clash"], "touching");
  EXPECT_EQ(lines[1]["upper"], 3);
  EXPECT_EQ(study["kind"], "parts");
  EXPECT_EQ(study["parts"]["name"], (nlohmann::json{"block", "pin, left", "small.obj", "scene:square"}));
}

TEST(ProgramStudy, HasTheWorstOfTooManyPairs) {
  const Folder folder;
  const std::string pin = folder.store("pin.obj", cube_at_origin(1));
  std::string many = "model,pose_tx\n";  // in a row, each but the first 0.5 from the next; the first is in the second
  for (int i = 0; i < 202; ++i) many += pin + ',' + std::to_string(i == 0 ? 1.75 : 1.5 * i) + '\n';
  const std::string line = "distance --parts " + folder.store("many.csv", many);
  const Report report(line + " --json --min-clearance 0.6");
  const nlohmann::json& study = report.data;
  const std::vector<nlohmann::json> lines = json_lines_of(report.outcome);
  ASSERT_EQ(lines.size(), 20'301U);
  const std::vector<std::size_t> numbers = study["rows"]["row"], order = study["worst_first"];
  ASSERT_EQ(numbers.size(), 20'000U);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
  EXPECT_EQ(study["counts"], (nlohmann::json{{"hard_clash", 1}, {"clearance", 201}, {"clear", 20'099}}));
  EXPECT_EQ(study["too_close"], 202);
  EXPECT_EQ(numbers[order[0]], 0U);
  std::vector<bool> is_listed(lines.size());
  double farthest = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const nlohmann::json& upper = lines[numbers[order[i]]]["upper"];
    EXPECT_EQ(study["rows"]["upper"][order[i]], upper);
    if (i > 0) {
      EXPECT_GE(upper.get<double>(), farthest) << i;
      farthest = upper;
    }
    is_listed[numbers[i]] = true;
  }
  for (std::size_t r = 0; r < lines.size(); ++r) EXPECT_TRUE(is_listed[r] || lines[r]["upper"] >= farthest) << r;
  // With a largest distance, near pairs alone are written.
  const std::vector<nlohmann::json> near = json_rows_of(line + " --max-distance 0.6");
  ASSERT_EQ(near.size(), 202U);
  for (const nlohmann::json& row : near) {
    const auto same = std::find_if(lines.begin(), lines.end(), [&](const nlohmann::json& other) {
      return other["part_a"] == row["part_a"] && other["part_b"] == row["part_b"];
    });
    EXPECT_EQ(row["upper"], (*same)["upper"]);
  }
}

/// The files of a waving sheet in frames 0 to `count` - 1.
std::string waves(const Folder& folder, int count, std::uint32_t side) {
  Words files;
  for (int f = 0; f < count; ++f) {
    files.push_back(folder.store("wave" + std::to_string(f) + ".obj", wave_sheet(side, side, f)));
  }
  return joined(files);
}

TEST(ProgramReplay, HoldsAllAnswers) {
  const Folder folder;
  std::string poses;
  for (int f = 0; f < 10; ++f) poses += std::to_string(3 + 0.1 * f) + ",5,3.5,1,0," + std::to_string(0.01 * f) + ",0\n";
  const std::string line = "track --b scene:ball --relative-error 0.5 --contacts --margin 3 --json --a " +
                           waves(folder, 10, 12) + " --poses-b " + folder.store("poses.csv", poses);
  for (const std::string options : {"", " --min-clearance 2.5", " --max-distance 2.5"}) {
    const Report report(line + options);
    EXPECT_EQ(report.outcome.err, "");
    const nlohmann::json& data = report.data;
    const std::vector<nlohmann::json> lines = json_lines_of(report.outcome);
    ASSERT_EQ(lines.size(), 10U);
    EXPECT_EQ(data["stride"], 1);
    EXPECT_EQ(data["frame_count"], 10);
    Words keys = {"lower", "upper", "status", "update_us", "query_us", "moved_vertices"};
    if (options.starts_with(" --min")) keys.emplace_back("too_close");
    expect_rows(data["rows"], lines, keys);
    bool has_contacts = false, has_interval = false;
    for (std::size_t r = 0; r < lines.size(); ++r) {
      for (const char* key : {"query_us", "count", "intersecting"}) {
        EXPECT_EQ(data["contacts"][0][key][r], lines[r]["contact"][key]) << key << ' ' << r;
      }
      has_interval = has_interval || lines[r]["lower"] != lines[r]["upper"];
      has_contacts = has_contacts || lines[r]["contact"]["count"] > 0;
    }
    EXPECT_TRUE(has_contacts && (has_interval || !options.empty()));
    EXPECT_EQ(data["min_clearance"], options.starts_with(" --min") ? nlohmann::json(2.5) : nlohmann::json());
    EXPECT_EQ(data["max_distance"], options.starts_with(" --max") ? nlohmann::json(2.5) : nlohmann::json());
    EXPECT_EQ(data["models"][0]["frames"]["data"].size(), 10U);
    EXPECT_EQ(data["parts"]["name"], (nlohmann::json{"wave0.obj", "scene:ball"}));
  }
}

TEST(ProgramReplay, ThinsOutFramesOfPagesThatWouldBeTooLargeAndSaysSo) {
  const Folder folder;
  const Report report("track --b scene:ball --max-report-mb 1 --a " + waves(folder, 13, 90));
  const std::size_t stride = report.data["stride"];
  EXPECT_GE(stride, 2U);
  const std::string& error = report.outcome.err;
  ASSERT_EQ(lines_of(error).size(), 1U) << error;
  EXPECT_NE(error.find("1 of every " + std::to_string(stride) + " frames"), std::string::npos) << error;
  EXPECT_EQ(report.data["rows"]["upper"].size(), 13U);
  EXPECT_EQ(report.data["models"][0]["frames"]["data"].size(), (13 + stride - 1) / stride);
  EXPECT_LT(report.page.size(), 1'200'000U);
}

}  // namespace
}  // namespace limber::program_tests
