// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <tuple>

#include "contact_meshes.h"
#include "formats/scenes.h"
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

}  // namespace
}  // namespace limber::program_tests
