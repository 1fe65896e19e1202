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

const std::string short_loop = "haptics --tissue 1000 --tool 1000 --seconds 0.01 --jitter-seconds 0 --quiet ";

/// Two models, two frames, points, poses and pairs; and lines that an output's path completes.
class ProgramOutputFiles : public testing::Test {
 protected:
  ProgramOutputFiles()
      : ball_(folder_.store("ball.obj", scenes::ball(8, 4).view())),
        frame_(folder_.store("frame.obj", scenes::ball(8, 4).view())),
        points_(folder_.store("points.csv", "0,0,3\n0,0,4\n")),
        poses_(folder_.store("poses.csv", "0,0,3,1,0,0,0\n0,0,4,1,0,0,0\n")),
        pairs_(folder_.store("pairs.csv", "model_a,model_b\nscene:ball,scene:ball\n" + ball_ + "," + frame_ + "\n")),
        of_pairs_("distance --pairs " + pairs_ + " --out "),
        of_distance_("distance " + ball_ + ' ' + frame_ + " --report "),
        of_contacts_("contacts " + ball_ + ' ' + frame_ + " --intersections --out "),
        of_self_("self " + ball_ + " --out "),
        of_points_("points " + ball_ + ' ' + points_ + " --out "),
        of_track_("track --a " + ball_ + ' ' + frame_ + " --b scene:ball --poses-a " + poses_ + " --out "),
        of_track_report_("track --a " + ball_ + ' ' + frame_ + " --b scene:ball --poses-a " + poses_ + " --report ") {}

  /// The names of the folder's files with their texts.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> texts;
    for (const auto& entry : fs::directory_iterator(folder_.path(""))) {
      texts[entry.path().string()] = text_of(entry.path().string());
    }
    return texts;
  }

  /// Every name of an input must be refused as the path of the output, and no file may change.
  void expect_kept(const std::string& line, const Words& inputs) const {
    for (const std::string& input : inputs) {
      const std::string name = fs::path(input).filename().string();
      const std::string symbolic = folder_.path("symbolic_link"), hard = folder_.path("hard_link");
      fs::create_symlink(input, symbolic);
      fs::create_hard_link(input, hard);
      const auto before = files();
      for (const std::string& path : {input, folder_.path("./" + name), symbolic, hard}) {
        expect_refused(line + path, ": " + path + " is one of the inputs");
        EXPECT_TRUE(files() == before);
      }
      fs::remove(symbolic);
      fs::remove(hard);
    }
  }

  Folder folder_;
  std::string ball_, frame_, points_, poses_, pairs_;
  std::string of_pairs_, of_distance_, of_contacts_, of_self_, of_points_, of_track_, of_track_report_;
};

TEST_F(ProgramOutputFiles, OfEveryVerbAreNoInputs) {
  expect_kept(of_pairs_, {pairs_, ball_, frame_});
  expect_kept(of_distance_, {ball_, frame_});
  expect_kept(of_contacts_, {ball_, frame_});
  expect_kept(of_self_, {ball_});
  expect_kept(of_points_, {ball_, points_});
  expect_kept(of_track_, {ball_, frame_, poses_});
  expect_kept(of_track_report_, {ball_, frame_, poses_});
  expect_kept("track --a scene:ball --b " + ball_ + ' ' + frame_ + " --poses-b " + poses_ + " --report ",
              {ball_, frame_, poses_});
}

TEST_F(ProgramOutputFiles, OfOneRunAreDifferent) {
  const auto both = [](const std::string& out, const std::string& page) {
    return short_loop + "--out " + out + " --report " + page;
  };
  const std::string before = folder_.store("before.csv", "from before"), fresh = folder_.path("new.csv");
  const std::string link = folder_.path("dangling_link");
  fs::create_symlink("new.csv", link);
  for (const std::string& out : {before, fresh}) {
    const std::string same = folder_.path("./" + fs::path(out).filename().string());
    expect_refused(both(out, same), "--report: " + same + " is where another output goes");
  }
  expect_refused(both(fresh, link), "--report: " + link + " is where another output goes");
  expect_refused(both(link, fresh), "--report: " + fresh + " is where another output goes");
  EXPECT_EQ(text_of(before), "from before");
  EXPECT_FALSE(fs::exists(fresh));
  EXPECT_EQ(run(both("/dev/null", "/dev/null")).exit_code, 0);
}

TEST_F(ProgramOutputFiles, AreNotStandardOutput) {
  const std::string out = folder_.store("out", "");
  for (const std::string& line : {of_distance_, of_contacts_, of_self_, of_track_report_,
                                  std::string("demo --frames 1 --no-check --report "), short_loop + "--report "}) {
    SCOPED_TRACE(line);
    const Outcome outcome = run_into(out, line + out);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(out + " is where another output goes"), std::string::npos) << outcome.err;
    EXPECT_EQ(text_of(out), "");
  }
  for (const std::string& line :
       {of_distance_, of_track_report_, std::string("demo --report "), short_loop + "--report "}) {
    expect_refused(line + "-", ": must name a file");
  }
  EXPECT_EQ(run_into("/dev/null", of_self_ + "/dev/null").exit_code, 0);
}

TEST_F(ProgramOutputFiles, ThatCannotBeWrittenAreToldAtOnce) {
  for (const std::string& line :
       {of_pairs_, of_distance_, of_contacts_, of_self_, of_points_, of_track_, of_track_report_,
        std::string("demo --report "), short_loop + "--out ", short_loop + "--report "}) {
    expect_refused(line + folder_.path("no/such/folder"), ": cannot write ");
    expect_refused(line + folder_.path(""), ": cannot write ");
  }
}

TEST_F(ProgramOutputFiles, OnAFullDiskAreOneLineAndNoAnswer) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  for (const std::string& line : {of_pairs_, of_distance_, of_contacts_, of_self_, of_points_, of_track_}) {
    SCOPED_TRACE(line);
    const Outcome outcome = run(line + "/dev/full");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
  }
  const Outcome outcome = run_into("/dev/full", "distance scene:ball scene:ball --json");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
}

}  // namespace
}  // namespace limber::program_tests
