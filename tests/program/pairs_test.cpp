// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "program/run_program.h"
#include "scenes/scenes.h"

namespace limber::program_tests {
namespace {

Words pairs(const std::string& file, const Words& more) {
  Words words = {"distance", "--pairs", file};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Counts how often a file is opened and closed while it lives. Two openings in a row would be one event.
class OpenCounter {
 public:
  explicit OpenCounter(const std::string& path) : events_(inotify_init1(IN_NONBLOCK)) {
    if (events_ < 0 || inotify_add_watch(events_, path.c_str(), IN_OPEN | IN_CLOSE) < 0) {
      throw std::runtime_error("cannot watch a file");
    }
  }
  ~OpenCounter() { close(events_); }
  OpenCounter(const OpenCounter&) = delete;
  OpenCounter& operator=(const OpenCounter&) = delete;

  /// Since the last call.
  std::size_t count() {
    alignas(inotify_event) char buffer[4096];
    std::size_t bytes = 0;
    for (ssize_t taken = 0; (taken = read(events_, buffer, sizeof buffer)) > 0;)
      bytes += static_cast<std::size_t>(taken);
    return bytes / sizeof(inotify_event);  // events about a file itself have no name behind them
  }

 private:
  int events_;
};

TEST(ProgramPairs, AnswersEachRowAsTheVerbAnswersThePair) {
  const Folder folder;
  scenes::Rng rng(3);
  const std::string a = folder.store("a.obj", scenes::random_soup(rng, 60, 0.4));
  const std::string b = folder.store("b.obj", scenes::random_soup(rng, 50, 0.4));
  const std::string ball = folder.store("ball.obj", scenes::ball(8, 4).view());
  const std::string pose_a = "1,2,3,0.5,-0.5,0.5,0.1", pose_b = "-1,0.25,2,1,0,0,3";
  const std::string file =
      folder.store("pairs.csv",
                   "model_a,pose_a_tx,pose_a_ty,pose_a_tz,pose_a_qw,pose_a_qx,pose_a_qy,pose_a_qz,"
                   "model_b,pose_b_tx,pose_b_ty,pose_b_tz,pose_b_qw,pose_b_qx,pose_b_qy,pose_b_qz\n" +
                       a + ',' + pose_a + ',' + b + ',' + pose_b + '\n' +  //
                       b + ",,,,,,,," + a + ",,,3,,,,\n" +                 //
                       ball + ",0,0,3,1,0,0,0,scene:ball,,,,,,,\n");
  for (const std::string engine : {"fast", "classic", "reference"}) {
    const Outcome outcome = run(pairs(file, {"--engine", engine}));
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(lines_of(outcome.out).front(),
              "row,model_a,model_b,status,lower,upper,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,"
              "triangle_a,triangle_b,face_a,face_b,too_close,inside,query_us,node_tests,triangle_tests");
    const std::vector<Row> rows = table_of(outcome.out);
    const std::vector<nlohmann::json> objects = json_lines_of(run(pairs(file, {"--engine", engine, "--json"})));
    ASSERT_EQ(rows.size(), 3U);
    ASSERT_EQ(objects.size(), 3U);
    const Words questions[] = {{"distance", a, b, "--pose-a", pose_a, "--pose-b", pose_b},
                               {"distance", b, a, "--pose-b", "0,0,3,1,0,0,0"},
                               {"distance", ball, "scene:ball", "--pose-a", "0,0,3,1,0,0,0"}};
    for (std::size_t r = 0; r < rows.size(); ++r) {
      SCOPED_TRACE(engine + " " + std::to_string(r));
      Words question = questions[r];
      question.insert(question.end(), {"--engine", engine, "--json"});
      const nlohmann::json alone = json_of(run(question));
      EXPECT_EQ(rows[r].at("row"), std::to_string(r));
      EXPECT_EQ(rows[r].at("model_a"), question[1]);
      EXPECT_EQ(rows[r].at("model_b"), question[2]);
      EXPECT_EQ(rows[r].at("status"), alone["status"].get<std::string>());
      EXPECT_EQ(number(rows[r].at("upper")), alone["upper"].get<double>());
      EXPECT_EQ(number(rows[r].at("point_b_y")), alone["witness"]["point_b"][1].get<double>());
      EXPECT_EQ(number(rows[r].at("face_b")), alone["witness"]["face_b"].get<double>());
      EXPECT_EQ(rows[r].at("node_tests"), alone["node_tests"].dump());
      EXPECT_GT(number(rows[r].at("query_us")), 0);
      for (const char* key : {"status", "lower", "upper", "witness", "too_close", "inside"}) {
        EXPECT_EQ(objects[r][key], alone[key]) << key;
      }
    }
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
  const std::vector<nlohmann::json> rows = json_lines_of(run(pairs(file, {"--json"})));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["model_b"], comma);
  EXPECT_EQ(rows[1]["model_a"], "scene:ball");
  EXPECT_EQ(rows[1]["model_b"], "scene:square");
  // What is written can be read again.
  EXPECT_NE(run(pairs(file, {})).out.find("\n0,scene:ball,\"" + quoted + "\",collision,"), std::string::npos);
}

TEST(ProgramPairs, LoadsEachFileOnce) {
  const Folder folder;
  const std::string ball = folder.store("ball.obj", scenes::ball(8, 4).view());
  const std::string same =
      folder.path("./../" + std::filesystem::path(folder.path("")).parent_path().filename().string() + "/ball.obj");
  const std::string one = folder.store("one.csv", "model_a,model_b\n" + ball + ",scene:ball\n");
  const std::string many = folder.store(
      "many.csv", "model_a,model_b\n" + ball + ",scene:ball\n" + ball + ',' + same + "\nscene:ball," + same + '\n');
  OpenCounter opened(ball);
  EXPECT_EQ(run(pairs(one, {})).exit_code, 0);
  const std::size_t once = opened.count();
  EXPECT_GE(once, 1U);
  EXPECT_EQ(run(pairs(many, {})).exit_code, 0);
  EXPECT_EQ(opened.count(), once);
}

TEST(ProgramPairs, MarksRowsThatAreTooClose) {
  const Folder folder;
  const std::string file =
      folder.store("pairs.csv",
                   "model_a,model_b,pose_a_tz\n"
                   "scene:ball,scene:square,9\nscene:ball,scene:square,3\nscene:ball,scene:square,0\n");
  const auto marks = [&](const Words& options) {
    std::string text;
    for (const Row& row : table_of(run(pairs(file, options)).out)) text += row.at("too_close") + ' ';
    return text;
  };
  EXPECT_EQ(marks({}), "   ");
  EXPECT_EQ(marks({"--min-clearance", "2.5"}), "false true true ");
  EXPECT_EQ(marks({"--min-clearance", "2"}), "false false true ");
  EXPECT_EQ(marks({"--min-clearance", "2", "--max-distance", "2"}), "false false true ");
  const auto exit_code = [&](const std::string& path, const Words& options) {
    return run(pairs(path, options)).exit_code;
  };
  EXPECT_EQ(exit_code(file, {}), 0);
  EXPECT_EQ(exit_code(file, {"--min-clearance", "2.5"}), 3);
  EXPECT_EQ(exit_code(file, {"--max-distance", "1", "--exit-code", "--json"}), 3);
  const std::string clear = folder.store("clear.csv", "model_a,model_b,pose_a_tz\nscene:ball,scene:square,9\n");
  EXPECT_EQ(exit_code(clear, {"--min-clearance", "2.5"}), 0);
  EXPECT_EQ(exit_code(clear, {"--max-distance", "1", "--exit-code"}), 0);
}

TEST(ProgramPairs, BeyondTheLimitCellsAreEmpty) {
  const Folder folder;
  const std::string file =
      folder.store("pairs.csv", "model_a,model_b,pose_a_tz\nscene:ball,scene:square,9\nscene:ball,scene:square,1.5\n");
  const std::vector<Row> rows = table_of(run(pairs(file, {"--max-distance", "0.5"})).out);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("status"), "beyond_limit");
  EXPECT_EQ(rows[0].at("lower"), "0.5");
  for (const char* column : {"upper", "point_a_x", "point_b_z", "triangle_a", "face_b"}) {
    EXPECT_EQ(rows[0].at(column), "") << column;
    EXPECT_NE(rows[1].at(column), "") << column;
  }
}

TEST(ProgramPairs, WritesAFileOrStandardOutput) {
  const Folder folder;
  const std::string file = folder.store("pairs.csv", "model_a,model_b\nscene:ball,scene:square\n");
  const std::string out = folder.store("answers.csv", "from before");
  const Outcome to_file = run(pairs(file, {"--out", out}));
  EXPECT_EQ(to_file.exit_code, 0);
  EXPECT_EQ(to_file.out, "");
  const std::vector<Row> rows = table_of(text_of(out));
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].at("status"), "collision");
  EXPECT_EQ(lines_of(run(pairs(file, {"--out", "-"})).out).size(), 2U);
  const Outcome refused = run(pairs(file, {"--out", folder.path("no/such/folder.csv")}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err.find("limber: distance: --out: cannot write "), 0U) << refused.err;
  const Outcome itself = run(pairs(file, {"--out", folder.path("./pairs.csv")}));
  EXPECT_EQ(itself.exit_code, 2);
  EXPECT_NE(itself.err.find("is one of the inputs"), std::string::npos) << itself.err;
  EXPECT_EQ(lines_of(text_of(file)).size(), 2U);
  if (!std::filesystem::exists("/dev/full")) return;
  const Outcome full = run(pairs(file, {"--out", "/dev/full"}));
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_EQ(lines_of(full.err).size(), 1U) << full.err;
}

TEST(ProgramPairs, ErrorsNameFileLineAndColumnAndWriteNothing) {
  const Folder folder;
  const std::string out = folder.store("answers.csv", "from before");
  const auto expect_refused = [&](const std::string& csv, const std::string& part) {
    SCOPED_TRACE(csv);
    const Outcome outcome = run(pairs(folder.store("pairs.csv", csv), {"--out", out}));
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
    EXPECT_NE(outcome.err.find("pairs.csv: " + part), std::string::npos) << outcome.err;
    EXPECT_EQ(text_of(out), "from before");
  };
  const std::string header = "model_a,model_b,pose_b_tx,pose_b_qw,pose_b_qx,pose_b_qy,pose_b_qz\n";
  const std::string good = "scene:ball,scene:ball,1,1,0,0,0\n";
  expect_refused("", "is empty");
  expect_refused(header, "has no pair");
  expect_refused("scene:ball,scene:ball\n", "line 1: there is no column model_a; the first row names the columns");
  expect_refused("a.obj;b.obj\nc.obj;d.obj\n", "line 1: fields are separated by commas, not by semicolons");
  expect_refused("model_a;model_b\n", "line 1: fields are separated by commas");
  expect_refused("model_a,modelb\n", "line 1: no column is called 'modelb'; did you mean model_b?");
  expect_refused("model_a,model_b,pose_b_t\n", "line 1: no column is called 'pose_b_t'; did you mean pose_b_tx?");
  expect_refused("model_a,model_b,model_a\n", "line 1: column model_a comes twice");
  expect_refused("model_a\n", "line 1: there is no column model_b");
  expect_refused(header + good + "scene:ball,scene:ball\n", "line 3: has 2 fields, but the header has 7");
  expect_refused(header + good + ",scene:ball,1,1,0,0,0\n", "line 3: column model_a: is empty");
  expect_refused(header + good + "scene:ball,scene:cube,1,1,0,0,0\n", "line 3: column model_b: scene:cube: no scene");
  expect_refused(header + good + "scene:ball,no.obj,1,1,0,0,0\n", "line 3: column model_b: no.obj: ");
  expect_refused(header + "scene:ball,scene:ball,x,1,0,0,0\n", "line 2: column pose_b_tx: 'x' is not a number");
  expect_refused(header + "scene:ball,scene:ball,1,1,,0,0\n",
                 "line 2: column pose_b_qx: is empty, but a quaternion has");
  expect_refused(header + "scene:ball,scene:ball,1,0,0,0,0\n", "line 2: column pose_b_tx to pose_b_qz: the quaternion");
  expect_refused(header + "scene:ball,scene:ball,nan,,,,\n", "line 2: column pose_b_tx to pose_b_qz: the translation");
  expect_refused("model_a,model_b,pose_a_qx\nscene:ball,scene:ball,1\n", "line 2: column pose_a_qw: is empty");
  const Outcome missing = run(pairs(folder.path("no.csv"), {}));
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_NE(missing.err.find("no.csv: "), std::string::npos) << missing.err;
}

}  // namespace
}  // namespace limber::program_tests
