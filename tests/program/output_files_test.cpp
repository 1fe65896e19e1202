// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "program/run_program.h"
#include "scenes/scenes.h"

namespace limber::program_tests {
namespace {

namespace fs = std::filesystem;

/// Two models, two frames, points, poses and pairs.
class ProgramOutputFiles : public testing::Test {
 protected:
  ProgramOutputFiles()
      : ball_(folder_.store("ball.obj", scenes::ball(8, 4).view())),
        frame_(folder_.store("frame.obj", scenes::ball(8, 4).view())),
        points_(folder_.store("points.csv", "0,0,3\n0,0,4\n")),
        poses_(folder_.store("poses.csv", "0,0,3,1,0,0,0\n0,0,4,1,0,0,0\n")),
        pairs_(folder_.store("pairs.csv", "model_a,model_b\nscene:ball,scene:ball\n" + ball_ + "," + frame_ + "\n")) {}

  /// The names of the folder's files with their texts.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> texts;
    for (const auto& entry : fs::directory_iterator(folder_.path(""))) {
      texts[entry.path().string()] = text_of(entry.path().string());
    }
    return texts;
  }

  /// Every name of `input` must be refused as the value of the last option, and no file may change.
  void expect_kept(Words words, const std::string& input) const {
    const std::string option = words.back();
    const std::string name = fs::path(input).filename().string();
    const std::string symbolic = folder_.path("symbolic_link"), hard = folder_.path("hard_link");
    fs::create_symlink(input, symbolic);
    fs::create_hard_link(input, hard);
    const auto before = files();
    words.emplace_back();
    for (const std::string& path : {input, folder_.path("./" + name), symbolic, hard}) {
      SCOPED_TRACE(path);
      words.back() = path;
      expect_refused(words, option + ": " + path + " is one of the inputs");
      EXPECT_TRUE(files() == before);
    }
    fs::remove(symbolic);
    fs::remove(hard);
  }

  Folder folder_;
  std::string ball_, frame_, points_, poses_, pairs_;
};

TEST_F(ProgramOutputFiles, OfEveryVerbAreNoInputs) {
  for (const std::string& input : {pairs_, ball_, frame_}) expect_kept({"distance", "--pairs", pairs_, "--out"}, input);
  for (const std::string& input : {ball_, frame_}) {
    expect_kept({"distance", ball_, frame_, "--report"}, input);
    expect_kept({"contacts", ball_, frame_, "--intersections", "--csv"}, input);
  }
  expect_kept({"self", ball_, "--csv"}, ball_);
  for (const std::string& input : {ball_, points_}) expect_kept({"points", ball_, points_, "--out"}, input);
  for (const std::string& input : {ball_, frame_, poses_}) {
    expect_kept(track({ball_, frame_}, {"scene:ball"}, {"--poses-a", poses_, "--report"}), input);
    expect_kept(track({"scene:ball"}, {ball_, frame_}, {"--poses-b", poses_, "--report"}), input);
  }
}

TEST_F(ProgramOutputFiles, OfOneRunAreDifferent) {
  const auto both = [](const std::string& out, const std::string& page) {
    return Words{"haptics",          "--tissue", "1000",    "--tool", "1000", "--seconds", "0.01",
                 "--jitter-seconds", "0",        "--quiet", "--out",  out,    "--page",    page};
  };
  const std::string before = folder_.store("before.csv", "from before"), fresh = folder_.path("new.csv");
  const std::string link = folder_.path("dangling_link");
  fs::create_symlink("new.csv", link);
  for (const std::string& out : {before, fresh}) {
    SCOPED_TRACE(out);
    const std::string same = folder_.path("./" + fs::path(out).filename().string());
    expect_refused(both(out, same), "--out: " + out + " is where another output goes");
  }
  expect_refused(both(fresh, link), "--out: " + fresh + " is where another output goes");
  expect_refused(both(link, fresh), "--out: " + link + " is where another output goes");
  EXPECT_EQ(text_of(before), "from before");
  EXPECT_FALSE(fs::exists(fresh));
  EXPECT_EQ(run(both("/dev/null", "/dev/null")).exit_code, 0);
}

TEST_F(ProgramOutputFiles, AreNotStandardOutput) {
  const std::string out = folder_.store("out", "");
  const std::vector<Words> commands = {
      {"distance", ball_, frame_, "--report", out},
      {"contacts", ball_, frame_, "--intersections", "--csv", out},
      {"self", ball_, "--csv", out},
      track({ball_, frame_}, {"scene:ball"}, {"--report", out}),
      {"demo", "--frames", "1", "--no-check", "--out", out},
      {"haptics", "--seconds", "0.01", "--jitter-seconds", "0", "--page", out},
  };
  for (const Words& words : commands) {
    SCOPED_TRACE(words.front());
    const Outcome outcome = run_into(out, words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(out + " is where another output goes"), std::string::npos) << outcome.err;
    EXPECT_EQ(text_of(out), "");
  }
  EXPECT_EQ(run_into("/dev/null", {"self", ball_, "--csv", "/dev/null"}).exit_code, 0);
}

}  // namespace
}  // namespace limber::program_tests
