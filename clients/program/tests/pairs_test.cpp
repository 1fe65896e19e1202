// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Many pairs, as `limber distance` answers about them; tolerances, errors of meshes, accepted pairs, parts of one file.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "contact_meshes.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

/// How often a run opens and closes a file. Two openings in a row would be one event.
std::size_t events_on(const std::string& path, const std::string& line) {
  const int events = inotify_init1(IN_NONBLOCK);
  EXPECT_GE(inotify_add_watch(events, path.c_str(), IN_OPEN | IN_CLOSE), 0);
  EXPECT_EQ(run(line).exit_code, 0);
  alignas(inotify_event) char buffer[4096];
  const ssize_t bytes = read(events, buffer, sizeof buffer);
  close(events);
  return static_cast<std::size_t>(std::max<ssize_t>(bytes, 0)) / sizeof(inotify_event);
}

TEST(ProgramPairs, AnswersEachRowAsTheVerbAnswersThePair) {
  const Soups soups(3, 0.4);
  const std::string &a = soups.file_a, &b = soups.file_b;
  const std::string pose_a = "1,2,3,0.5,-0.5,0.5,0.1", pose_b = "-1,0.25,2,1,0,0,3";
  const std::string file =
      soups.folder.store("pairs.csv",
                         "model_a,pose_a_tx,pose_a_ty,pose_a_tz,pose_a_qw,pose_a_qx,pose_a_qy,pose_a_qz,"
                         "model_b,pose_b_tx,pose_b_ty,pose_b_tz,pose_b_qw,pose_b_qx,pose_b_qy,pose_b_qz\n" +
                             a + ',' + pose_a + ',' + b + ',' + pose_b + '\n' +  //
                             b + ",,,,,,,," + a + ",,,3,,,,\n" +                 //
                             "scene:ball,0,0,3,1,0,0,0,scene:ball,,,,,,,\n");
  const Words questions = {a + ' ' + b + " --pose-a " + pose_a + " --pose-b " + pose_b,
                           b + ' ' + a + " --pose-b 0,0,3,1,0,0,0", "scene:ball scene:ball --pose-a 0,0,3,1,0,0,0"};
  const std::vector<nlohmann::json> objects = json_rows_of("distance --pairs " + file);
  ASSERT_EQ(objects.size(), 3U);
  for (std::size_t r = 0; r < objects.size(); ++r) {
    SCOPED_TRACE(questions[r]);
    const nlohmann::json &object = objects[r], alone = json_of("distance " + questions[r]);
    for (const char* key :
         {"status", "lower", "upper", "witness", "too_close", "inside", "clash", "solids", "depth", "node_tests"}) {
      EXPECT_EQ(object[key], alone[key]) << key;
    }
    EXPECT_EQ(object["row"], r);
    EXPECT_EQ(questions[r].find(object["model_a"].get<std::string>() + ' ' + object["model_b"].get<std::string>()), 0U);
  }
}

TEST(ProgramPairs, ReadsWhatSpreadsheetsAndPythonWrite) {
  const Folder folder;
  const std::string comma = folder.store("a, \"b\";c.obj", scenes::ball(8, 4).view());
  std::string quoted = comma;
  quoted.replace(quoted.find("\"b\""), 3, "\"\"b\"\"");
  const std::string file =
      folder.store("pairs.csv", "\xEF\xBB\xBFid,\"model_b\",note,model_a\r\n# a comment\r\n7,\"" + quoted +
                                    "\",,\"scene:ball\"\r\n\r\n8, scene:square ,x,scene:ball");
  const std::vector<nlohmann::json> rows = json_lines_of(run("distance --json --pairs " + file));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["model_b"], comma);
  EXPECT_EQ(rows[1]["model_a"], "scene:ball");
  EXPECT_EQ(rows[1]["model_b"], "scene:square");
  // What is written can be read again.
  EXPECT_NE(run("distance --pairs " + file).out.find("\n0,scene:ball,\"" + quoted + "\",collision,"),
            std::string::npos);
}

TEST(ProgramPairs, LoadsEachFileOnce) {
  const Folder folder;
  const std::string ball = folder.store("ball.obj", scenes::ball(8, 4).view());
  const std::string same =
      folder.path("./../" + std::filesystem::path(folder.path("")).parent_path().filename().string() + "/ball.obj");
  const std::string one = folder.store("one.csv", "model_a,model_b\n" + ball + ",scene:ball\n");
  const std::string many = folder.store(
      "many.csv", "model_a,model_b\n" + ball + ",scene:ball\n" + ball + ',' + same + "\nscene:ball," + same + '\n');
  const std::size_t once = events_on(ball, "distance --pairs " + one);
  EXPECT_GE(once, 1U);
  EXPECT_EQ(events_on(ball, "distance --pairs " + many), once);
}

TEST(ProgramPairs, MarksRowsThatAreTooClose) {
  const Folder folder;
  const std::string line = "distance --pairs " + folder.store("pairs.csv",
                                                              "model_a,model_b,pose_a_tz\nscene:ball,scene:square,9\n"
                                                              "scene:ball,scene:square,3\nscene:ball,scene:square,0\n");
  for (const auto& [options, marks, exit_code] : {std::tuple{"", "   ", 0},
                                                  {" --min-clearance 2.5", "false true true ", 3},
                                                  {" --min-clearance 2 --max-distance 2", "false false true ", 3},
                                                  {" --max-distance 1 --exit-code", "   ", 3}}) {
    const Outcome outcome = run(line + options);
    std::string found;
    for (const Row& row : table_of(outcome.out)) found += row.at("too_close") + ' ';
    EXPECT_EQ(found, marks) << options;
    EXPECT_EQ(outcome.exit_code, exit_code) << options;
  }
}

TEST(ProgramPairs, BeyondTheLimitCellsAreEmpty) {
  const Folder folder;
  const std::string file =
      folder.store("pairs.csv", "model_a,model_b,pose_a_tz\nscene:ball,scene:square,9\nscene:ball,scene:square,1.5\n");
  const std::vector<Row> rows = table_of(answer_to("distance --max-distance 0.5 --pairs " + file));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("status"), "beyond_limit");
  EXPECT_EQ(rows[0].at("lower"), "0.5");
  for (const char* column : {"upper", "point_a_x", "point_b_z", "triangle_a", "face_b"}) {
    EXPECT_EQ(rows[0].at(column), "") << column;
    EXPECT_NE(rows[1].at(column), "") << column;
  }
}

/// A prism over a polygon with corners on a circle of radius `r`, from z = 0 to 1, turned by `turn`. The circle's
/// cylinder is at most r (1 - cos(pi / n)) away.
Mesh prism(double r, int n, double turn = 0) {
  std::vector<Vec3> p = {{0, 0, 0}, {0, 0, 1}};
  std::vector<Corners> triangles;
  for (int i = 0; i < n; ++i) {
    const double angle = turn + 2 * std::numbers::pi * i / n;
    for (const double z : {0.0, 1.0}) p.push_back({r * std::cos(angle), r * std::sin(angle), z});
    const auto a = static_cast<VertexId>(2 + 2 * i), b = static_cast<VertexId>(2 + 2 * ((i + 1) % n));
    triangles.insert(triangles.end(), {{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}});
  }
  return Mesh::create(std::move(p), std::move(triangles)).value();
}

std::string box_text(double x0, double x1, double y1, int first = 0, bool is_open = false) {
  std::string text;
  for (int i = 0; i < 8; ++i) {
    text += fmt::format("v {} {} {}\n", i & 1 ? x1 : x0, i & 2 ? y1 : 0, i & 4 ? y1 : 0);
  }
  for (const auto& [a, b, c, d] : {std::array{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}}) {
    text += fmt::format("f {} {} {} {}\n", a + first, b + first, c + first, d + first);
  }
  return text + (is_open ? "" : fmt::format("f {} {} {} {}\n", 2 + first, 4 + first, 8 + first, 6 + first));
}

TEST(ProgramTolerances, DecideWhatAPairIs) {
  const Folder folder;
  const std::string wall = folder.store("wall.obj", box_text(0, 4, 4)),
                    pin = folder.store("pin.obj", box_text(0, 1, 1));
  const std::string open = folder.store("open.obj", box_text(0, 1, 1, 0, true));
  std::string csv = "model_a,model_b,pose_b_tx,pose_b_ty,pose_b_tz\n";
  for (const double x : {3.5, 3.875, 4.0, 4.25, 6.0}) csv += fmt::format("{},{},{},1,1\n", wall, pin, x);
  for (const double x : {3.5, 2.75, 4.125}) csv += fmt::format("{},{},{},1,1\n", wall, open, x);  // 2.75 is inside
  const std::string line = "distance --pairs " + folder.store("pairs.csv", csv);
  struct Case {
    const char *options, *clashes, *too_close;
    int exit_code;
  };
  const char* const none = "- - - - - - - -";
  for (const auto& [options, clashes, too_close, exit_code] : std::vector<Case>{
           {"", "hard hard touch clear clear meet hard apart", none, 0},
           {" --tolerance 0.0625", "hard hard touch clear clear meet hard apart", none, 0},
           {" --tolerance 0.125", "hard touch touch clear clear meet hard apart", none, 0},
           {" --mesh-error 0.0625", "hard ? ? clear clear ? hard ?", none, 0},
           {" --mesh-error 0.0625 --tolerance 0.25", "hard touch touch clear clear ? hard ?", none, 0},
           {" --mesh-error 0.125 --tolerance 0.25", "? ? touch touch clear ? ? ?", none, 0},
           {" --mesh-error 0.0625 --tolerance 0.25 --min-clearance 0.375", "hard touch touch ? clear ? hard ?",
            "true true true - false true true true", 3},
           {" --mesh-error 0.0625 --tolerance 0.25 --min-clearance 0.0625", "hard ? ? clear clear ? hard ?",
            "true - - false false - true -", 3},
       }) {
    const Outcome outcome = run(line + options);
    std::string found, close;
    for (const Row& row : table_of(outcome.out)) {
      static const std::map<std::string, std::string> words = {{"hard_clash", "hard"},    {"touching", "touch"},
                                                               {"cannot_tell", "?"},      {"clear", "clear"},
                                                               {"surfaces_meet", "meet"}, {"surfaces_apart", "apart"}};
      found += words.at(row.at("clash")) + ' ';
      close += (row.at("too_close").empty() ? "-" : row.at("too_close")) + ' ';
    }
    EXPECT_EQ(found, clashes + std::string(" ")) << options;
    EXPECT_EQ(close, too_close + std::string(" ")) << options;
    EXPECT_EQ(outcome.exit_code, exit_code) << options;
  }
  // One pair, 0.25 apart, whose parts are between 0.125 and 0.375 apart.
  const std::string pair = "distance " + wall + ' ' + pin + " --pose-b 4.25,1,1,1,0,0,0 --mesh-error 0.0625";
  const nlohmann::json json = json_of(pair);
  EXPECT_EQ(json["lower"], 0.125);
  EXPECT_EQ(json["upper"], 0.375);
  EXPECT_EQ(json["status"], "within_error");
  for (const auto& [options, exit_code] :
       std::vector<std::pair<std::string, int>>{{" --min-clearance 0.375", 4},
                                                {" --min-clearance 0.375 --relative-error 2", 4},
                                                {" --min-clearance 0.376", 3},
                                                {" --min-clearance 0.125", 0},
                                                {" --max-distance 0.3 --exit-code", 4},
                                                {" --max-distance 0.375 --exit-code", 3},
                                                {" --max-distance 0.1 --exit-code", 0}}) {
    EXPECT_EQ(run(pair + options).exit_code, exit_code) << options;
  }
  expect_refused(pair + " --accept x.csv", "--accept: belongs to --pairs and --parts");
  expect_refused(pair + " --tolerance -1", "--tolerance");
}

TEST(ProgramTolerances, HoldTheTruthOfCurvedParts) {
  const Folder folder;
  std::size_t told = 0;
  for (const int n : {7, 12, 40}) {
    const double error = 1 - std::cos(std::numbers::pi / n);
    for (const double gap : {-0.3, -0.02, 0.0, 0.02, 0.3}) {
      for (const double turn : {0.0, 0.1, 0.37}) {
        const nlohmann::json json = json_lines_of(run("distance --json " + folder.store("a.obj", prism(1, n)) + ' ' +
                                                      folder.store("b.obj", prism(1, n, turn)) +
                                                      fmt::format(" --pose-b {},0.0,0.125,1,0,0,0", 2 + gap) +
                                                      fmt::format(" --mesh-error {} --min-clearance 0.1", error)))
                                        .at(0);
        SCOPED_TRACE(json.dump());
        EXPECT_LE(json["lower"].get<double>(), std::max(0.0, gap) + 1e-12);
        EXPECT_GE(json["upper"].get<double>(), std::max(0.0, gap) - 1e-12);
        EXPECT_LE(json["depth"].is_null() ? 0 : json["depth"].get<double>(), std::max(0.0, -gap) + 1e-12);
        if (json["clash"] == "cannot_tell") continue;
        EXPECT_EQ(json["clash"], gap < 0 ? "hard_clash" : gap == 0 ? "touching" : gap < 0.1 ? "clearance" : "clear");
        ++told;
      }
    }
  }
  EXPECT_GE(told, 20U);
}

TEST(ProgramTolerances, AcceptedPairsAreToldAndDoNotCount) {
  const Folder folder;
  const std::string pin = folder.store("pin.obj", box_text(0, 1, 1));
  const std::string parts = folder.store("parts.csv", "name,model,pose_tx\nplate_1," + pin + ",0\nbolt_a," + pin +
                                                          ",1\nbolt_b," + pin + ",1.5\nnut," + pin + ",9\n");
  const auto accepted_by = [&](const std::string& lines, int exit_code, const std::string& warning) {
    const Report report("distance --min-clearance 0.6 --parts " + parts + " --accept " +
                        folder.store("accept.csv", "name_b,name_a,allowed\n" + lines));
    EXPECT_EQ(report.outcome.exit_code, exit_code) << lines;
    EXPECT_EQ(report.outcome.err.find(warning) != std::string::npos, true) << report.outcome.err;
    EXPECT_EQ(report.outcome.err.empty(), warning.empty());
    std::string found, in_page;
    for (const Row& row : table_of(report.outcome.out)) {
      found += (row.at("accepted").empty() ? "-" : row.at("accepted")) + ' ';
    }
    for (const auto& line : report.data["rows"]["accepted"]) {
      in_page += (line.is_null() ? "-" : line.dump()) + ' ';
    }
    EXPECT_EQ(in_page, found);
    return found + report.data["accepted"].dump() + ' ' + report.data["too_close"].dump();
  };
  // plate_1 touches bolt_a, is 0.5 from bolt_b; the bolts overlap.
  EXPECT_EQ(accepted_by("bolt_*,plate_?,\n", 3, ""), "2 - - - - - 1 2");
  EXPECT_EQ(accepted_by("plate_?,bolt_*,all\n*,*_b,all\n", 0, ""), "2 2 - 3 - - 3 0");
  EXPECT_EQ(accepted_by("*,*,touching\nb*_a,b*_b,touching\n", 3, "line 3: accepts no pair"), "2 - - - - - 1 2");
  EXPECT_EQ(accepted_by("plate,bolt_a,all\n", 3, "line 2: accepts no pair"), "- - - - - - 0 3");
  expect_refused(
      "distance --parts " + parts + " --accept " + folder.store("bad.csv", "name_a,name_b,allowed\na,b,al\n"),
      "line 2: column allowed: must be touching or all, not 'al'");
  for (const std::string column : {"permitted", "alowed", ""}) {
    expect_refused(
        "distance --parts " + parts + " --accept " + folder.store("bad.csv", "name_a,name_b," + column + "\n*,*,all\n"),
        "bad.csv: line 1: no column is called '" + column +
            "'; the first row names the columns: name_a,name_b,allowed");
  }
}

TEST(ProgramParts, OfOneFileAreThoseOfManyFiles) {
  const Folder folder;
  const std::string texts[] = {box_text(0, 1, 1), box_text(1, 2, 1), box_text(1.5, 3, 1)};
  const std::string whole =  // the line has no triangle, so it is no part, but its face counts
      folder.store("all.obj", "o wall\n" + texts[0] + "o line\nf 1 2\no pin 1\n" + box_text(1, 2, 1, 8) + "o pin 2\n" +
                                  box_text(1.5, 3, 1, 16));
  std::string csv = "name,model\n";
  const char* const names[] = {"wall", "pin 1", "pin 2"};
  for (int i = 0; i < 3; ++i) {
    csv += std::string(names[i]) + ',' + folder.store(std::string(1, 'a' + char(i)) + ".obj", texts[i]) + '\n';
  }
  const auto of_file = json_rows_of("distance --parts " + whole);
  const auto of_files = json_rows_of("distance --parts " + folder.store("parts.csv", csv));
  ASSERT_EQ(of_file.size(), 3U);
  for (std::size_t i = 0; i < of_file.size(); ++i) {
    for (const char* key : {"name_a", "name_b", "clash", "solids", "depth", "lower", "upper"}) {
      EXPECT_EQ(of_file[i][key], of_files[i][key]) << key;
    }
  }
  EXPECT_EQ(of_file[0]["clash"], "touching");
  EXPECT_EQ(of_file[2]["clash"], "hard_clash");
  EXPECT_EQ((of_file[2]["witness"]["face_b"].get<int>() - 1) / 6, 2);  // faces are those of the file
  expect_refused("distance --parts " + texts[0].substr(0, 1) + ".obj", "v.obj");
}

}  // namespace
}  // namespace limber::program_tests
