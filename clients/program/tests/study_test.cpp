// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "contact_meshes.h"
#include "limber/points.h"
#include "page_decoding.h"
#include "reports/sha256.h"
#include "run_program.h"

/// Pages of many pairs: `limber distance --pairs --report` and `limber distance --parts --report`.
namespace limber::program_tests {
namespace {

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
    const nlohmann::json& rows = report.data["rows"];
    EXPECT_EQ(report.data["kind"], "pairs");
    EXPECT_EQ(report.data["models"].size(), 3U);  // each once
    ASSERT_EQ(lines.size(), 6U);
    for (std::size_t r = 0; r < lines.size(); ++r) {
      for (const char* key :
           {"status", "lower", "upper", "clash", "solids", "depth", "too_close", "inside", "query_us"}) {
        EXPECT_EQ(rows[key][r], lines[r][key]) << key << ' ' << r;
      }
      const nlohmann::json &found = rows["witness"][r], &witness = lines[r]["witness"];
      ASSERT_EQ(found.is_null(), witness.is_null());
      if (found.is_null()) continue;
      EXPECT_EQ(point_of(found), point_of(witness["point_a"]));
      EXPECT_EQ((Vec3{found[3], found[4], found[5]}), point_of(witness["point_b"]));
      EXPECT_EQ(found[6], witness["triangle_a"]);
      EXPECT_EQ(found[7], witness["triangle_b"]);
      EXPECT_EQ(found[8], witness["face_a"]);
      EXPECT_EQ(found[9], witness["face_b"]);
    }
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
    EXPECT_EQ(study["rows"]["clash"][r], lines[r]["clash"]);
  }
  EXPECT_EQ(lines[0]["name_a"], "block");
  EXPECT_EQ(lines[0]["name_b"], "pin, left");
  EXPECT_EQ(lines[1]["name_b"], "small.obj");
  EXPECT_EQ(lines[0]["clash"], "touching");
  EXPECT_EQ(lines[1]["upper"], 3);
  EXPECT_EQ(study["kind"], "parts");
  EXPECT_EQ(study["parts"]["name"], (nlohmann::json{"block", "pin, left", "small.obj", "scene:square"}));
  EXPECT_EQ(
      lines_of(run("distance --parts " + file).out).front(),
      "row,part_a,part_b,name_a,name_b,status,lower,upper,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,"
      "point_b_z,triangle_a,triangle_b,face_a,face_b,too_close,inside,clash,solids,depth,accepted,query_us,node_tests,"
      "primitive_tests");
}

TEST(ProgramStudy, NamesWhatIsWrongInAFileOfParts) {
  const Folder folder;
  const auto refused = [&](const std::string& csv, const std::string& part) {
    expect_refused("distance --parts " + folder.store("parts.csv", csv), part);
  };
  refused("name\nx\n", "there is no column model");
  refused("model\nscene:ball\n", "one part alone");
  refused("model\nscene:ball\nnowhere.obj\n", "line 3: column model: nowhere.obj");
  refused("model,pose_qw\nscene:ball,1\nscene:ball,\n", "line 2: column pose_qx: is empty");
  refused("model,pose_tx\nscene:ball,far\nscene:ball,\n", "column pose_tx: 'far' is not a number");
  refused("model,pose_tyy\nscene:ball,1\nscene:ball,2\n", "did you mean pose_ty?");
  refused("model,ty\nscene:ball,1\nscene:ball,2\n", "did you mean pose_ty?");
  const std::string file = folder.store("parts.csv", "model\nscene:ball\nscene:ball\n");
  expect_refused("distance --parts " + file + " --pairs " + file, "--parts");
  expect_refused("distance --parts " + file + " scene:ball", "--parts");
  expect_refused("distance --parts " + file + " --report " + file, "is one of the inputs");
  const std::string out = folder.path("same.html");
  expect_refused("distance --parts " + file + " --out " + out + " --report " + out, "is where another output goes");
  EXPECT_FALSE(std::filesystem::exists(out));
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

TEST(ProgramStudy, OfTwoHundredPosesIsASmallPage) {
  const Folder folder;
  const std::string a = folder.store("a.obj", scenes::wave_sheet(100, 100, 1)),
                    b = folder.store("b.obj", scenes::ball(100, 100));
  std::string csv = "model_a,model_b,pose_b_tx,pose_b_tz\n";
  for (int i = 0; i < 200; ++i) csv += a + ',' + b + ',' + std::to_string(0.5 * i) + ",3\n";
  const Report report("distance --pairs " + folder.store("pairs.csv", csv) + " --min-clearance 1");
  EXPECT_EQ(report.data["rows"]["a"].size(), 200U);
  EXPECT_LT(report.page.size(), 3'000'000U);
}

TEST(ProgramStudy, PagesNameTitleUnitTimeAndFiles) {
  const Pairs pairs;
  const Report report("distance " + pairs.large + ' ' + pairs.small +
                      " --pose-b 9,0,0,1,0,0,0 --unit mm --title '<Fixture> 3'");
  EXPECT_EQ(report.data["title"], "<Fixture> 3");
  EXPECT_EQ(report.data["unit"], "mm");
  EXPECT_EQ(report.data["made_at"].get<std::string>().size(), std::string("2026-11-26 17:05 UTC").size());
  const nlohmann::json& inputs = report.data["inputs"];
  ASSERT_EQ(inputs.size(), 2U);
  for (const auto& [i, path] : {std::pair(0, pairs.large), std::pair(1, pairs.small)}) {
    const std::string text = text_of(path);
    EXPECT_EQ(inputs[i]["name"], path);
    EXPECT_EQ(inputs[i]["bytes"], text.size());
    EXPECT_EQ(inputs[i]["sha256"], program::sha256_of(text));
  }
  const nlohmann::json of_pairs = Report("distance --pairs " + pairs.file).data["inputs"];
  EXPECT_EQ(of_pairs.size(), 3U);  // two models, and the file of pairs; a scene is no file
  expect_refused("distance scene:ball scene:ball --unit mm", "--report");
  expect_refused("distance scene:ball scene:ball --title x", "--report");
}

TEST(ProgramSha256, IsThatOfTheStandard) {
  // The examples that come with FIPS 180-4, and a million times "a".
  EXPECT_EQ(program::sha256_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(program::sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(program::sha256_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(program::sha256_of(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(ProgramVertexDistances, AreThoseOfPoints) {
  const Folder folder;
  const Mesh ball = scenes::ball(12, 7), sheet = scenes::wave_sheet(6, 5, 2);
  const std::string a = folder.store("ball.obj", ball), b = folder.store("sheet.obj", sheet);
  const std::string csv = folder.path("a.csv"), ply = folder.path("b.ply"), pose = "1,2,3,1,0,1,0";
  const Outcome outcome =
      run("distance " + a + ' ' + b + " --pose-a " + pose + " --vertices-a " + csv + " --vertices-b " + ply);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<Row> rows = table_of(text_of(csv));
  ASSERT_EQ(rows.size(), ball.positions().size());
  const Transform placed = transform_from_quaternion({1, 2, 3}, 1, 0, 1, 0).value();
  const Model model_a(ball), model_b(sheet);
  for (std::size_t v = 0; v < rows.size(); ++v) {
    const Vec3 point = placed(ball.positions()[v]);
    EXPECT_EQ(rows[v].at("vertex"), std::to_string(v));
    EXPECT_EQ((Vec3{number(rows[v].at("x")), number(rows[v].at("y")), number(rows[v].at("z"))}), point);
    EXPECT_EQ(number(rows[v].at("distance")), closest_point({model_b, {}}, point).closest->distance);
  }
  // The mesh of the other file is read back by the program, and its numbers stand behind the header.
  EXPECT_EQ(json_of("info " + ply)["triangles"], sheet.triangles().size());
  const Words lines = lines_of(text_of(ply));
  const auto body = std::find(lines.begin(), lines.end(), "end_header");
  ASSERT_NE(body, lines.end());
  for (std::size_t v = 0; v < sheet.positions().size(); ++v) {
    const std::string& line = body[1 + static_cast<std::ptrdiff_t>(v)];
    EXPECT_EQ(number(line.substr(line.rfind(' ') + 1)),
              closest_point({model_a, placed}, sheet.positions()[v]).closest->distance);
  }
  const std::string start = "distance " + a + ' ' + b;
  expect_refused(start + " --vertices-a out.txt", "ends in neither .csv nor .ply");
  expect_refused(start + " --vertices-a " + csv + " --vertices-b " + csv, "is where another output goes");
  expect_refused("distance --pairs x.csv --vertices-a " + csv, "--vertices-a");
  const std::string ply_input = folder.path("in.ply");
  std::filesystem::copy(ply, ply_input);
  expect_refused("distance " + a + ' ' + ply_input + " --vertices-b " + ply_input, "is one of the inputs");
}

}  // namespace
}  // namespace limber::program_tests
