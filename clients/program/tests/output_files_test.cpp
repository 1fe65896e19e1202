// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "formats/scenes.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

namespace fs = std::filesystem;

/// Two models, two frames, points, poses and pairs; and lines that an output's path completes.
class ProgramOutputFiles : public testing::Test {
 protected:
  ProgramOutputFiles()
      : ball_(folder_.store("ball.obj", scenes::ball(8, 4).view())),
        frame_(folder_.store("frame.obj", scenes::ball(8, 4).view())),
        gltf_(stored_gltf("model")),
        buffer_(folder_.path("model.csv")),
        points_(folder_.store("points.csv", "0,0,3\n0,0,4\n")),
        poses_(folder_.store("poses.csv", "0,0,3,1,0,0,0\n0,0,4,1,0,0,0\n")),
        pairs_(folder_.store("pairs.csv", "model_a,model_b\nscene:ball,scene:ball\n" + gltf_ + "," + frame_ + "\n")),
        of_pairs_("distance --pairs " + pairs_ + " --out "),
        of_distance_("distance " + ball_ + ' ' + gltf_ + " --report "),
        of_contacts_("contacts " + ball_ + ' ' + gltf_ + " --intersections --out "),
        of_self_("self " + gltf_ + " --out "),
        of_points_("points " + gltf_ + ' ' + points_ + " --out "),
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
      const std::string symbolic = folder_.path("symbolic.csv"), hard = folder_.path("hard.csv");
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

  /// A glTF file of one triangle, with its buffer in a file NAME.csv.
  std::string stored_gltf(const std::string& name) const {
    folder_.store(name + ".csv", std::string(36, '\0'));
    return folder_.store(
        name + ".gltf",
        R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
        R"({"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,)"
        R"("type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":")" +
            name + ".csv\"}]}");
  }

  Folder folder_;
  std::string ball_, frame_, gltf_, buffer_, points_, poses_, pairs_;
  std::string of_pairs_, of_distance_, of_contacts_, of_self_, of_points_, of_track_, of_track_report_;
};

TEST_F(ProgramOutputFiles, OfEveryVerbAreNoInputs) {
  expect_kept(of_pairs_, {pairs_, gltf_, buffer_, frame_});
  expect_kept(of_distance_, {ball_, gltf_, buffer_});
  expect_kept(of_contacts_, {ball_, gltf_, buffer_});
  expect_kept(of_self_, {gltf_, buffer_});
  expect_kept(of_points_, {gltf_, buffer_, points_});
  expect_kept(of_track_, {ball_, frame_, poses_});
  expect_kept(of_track_report_, {ball_, frame_, poses_});
  expect_kept("track --a scene:ball --b " + ball_ + ' ' + frame_ + " --poses-b " + poses_ + " --report ",
              {ball_, frame_, poses_});
}

TEST_F(ProgramOutputFiles, OfOneRunAreDifferent) {
  const auto both = [this](const std::string& out, const std::string& page) {
    return of_track_ + out + " --report " + page;
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
  for (const std::string& line :
       {of_distance_, of_contacts_, of_self_, of_track_report_, std::string("demo --frames 1 --no-check --report ")}) {
    SCOPED_TRACE(line);
    const Outcome outcome = run_into(out, line + out);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(out + " is where another output goes"), std::string::npos) << outcome.err;
    EXPECT_EQ(text_of(out), "");
  }
  for (const std::string& line : {of_distance_, of_track_report_, std::string("demo --report ")}) {
    expect_refused(line + "-", ": must name a file");
  }
  EXPECT_EQ(run_into("/dev/null", of_self_ + "/dev/null").exit_code, 0);
}

TEST_F(ProgramOutputFiles, AreNoInputsThatStreamsGoTo) {
  const Folder outside;
  const std::string err = outside.path("err"), link = folder_.path("link");
  fs::create_hard_link(buffer_, link);
  const auto before = files();
  for (const std::string& line : {of_pairs_ + "-", of_points_ + "-", of_points_ + "/dev/fd/1", "info " + gltf_,
                                  "collide scene:ball " + gltf_, "track --b scene:ball --a " + gltf_}) {
    for (const std::string& streams : {" 2>" + err + " >>" + link, " 2>>" + link, " >>" + link + " 2>&1"}) {
      EXPECT_EQ(run(line + streams + " #").exit_code, 2) << line << streams;
    }
    EXPECT_NE(text_of(err).find(buffer_ + " is one of the inputs"), std::string::npos) << line << text_of(err);
    EXPECT_TRUE(files() == before);
  }
}

TEST_F(ProgramOutputFiles, ThatCannotBeWrittenAreToldAtOnce) {
  for (const std::string& line : {of_pairs_, of_distance_, of_contacts_, of_self_, of_points_, of_track_,
                                  of_track_report_, std::string("demo --report ")}) {
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

TEST_F(ProgramOutputFiles, AreNoBuffersOfLaterFrames) {
  const std::string line = "track --a " + gltf_ + ' ' + stored_gltf("later") + " --b scene:ball --poses-b " + poses_;
  expect_kept(line + " --json --report ", {buffer_});
  const auto before = files();
  const Outcome outcome = run(line + " --out " + folder_.path("later.csv"));
  EXPECT_NE(outcome.err.find("later.csv is one of the inputs"), std::string::npos) << outcome.err;
  EXPECT_TRUE(files() == before);
}

TEST_F(ProgramOutputFiles, KeepLinksModesPipesAndDescriptors) {
  const std::string file = folder_.store("file", "from before"), link = folder_.path("link"),
                    made = folder_.path("new");
  const std::string answer = answer_to(of_points_ + "-");
  fs::create_symlink("file", link);
  fs::permissions(file, fs::perms{0604});
  const mode_t mask = umask(027);
  for (const std::string& path : {link, made}) answer_to(of_points_ + path);
  umask(mask);
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(fs::status(file).permissions(), fs::perms{0604});
  EXPECT_EQ(fs::status(made).permissions(), fs::perms{0640});
  for (const std::string& path : {file, made}) EXPECT_EQ(text_of(path), answer);
  const std::string pipe = folder_.path("pipe"), log = folder_.store("log", "from before\n");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int end = open(pipe.c_str(), O_RDWR);
  for (const std::string& path : {pipe, "/dev/fd/3 3>>" + log, "/dev/stdout >>" + log + " #"}) run(of_points_ + path);
  std::string text(answer.size(), ' ');
  EXPECT_EQ(read(end, text.data(), text.size()), static_cast<ssize_t>(answer.size()));
  EXPECT_EQ(text, answer);
  EXPECT_EQ(text_of(log), "from before\n" + answer + answer);
  EXPECT_EQ(close(end), 0);
}

TEST_F(ProgramOutputFiles, StayWhereNothingTakesTheirPlace) {
  const std::string out = folder_.store("out.csv", "from before"), page = folder_.store("page", "from before");
  const auto before = files();
  EXPECT_EQ(run("track --a " + ball_ + ' ' + points_ + " --b scene:ball --report " + page + " --out " + out).exit_code,
            2);
  expect_refused(of_points_ + "/proc/self/comm", "no file can be made beside it");
  rlimit room{};
  getrlimit(RLIMIT_FSIZE, &room);
  const rlimit little{150, room.rlim_max};
  setrlimit(RLIMIT_FSIZE, &little);
  const Outcome points = run(of_points_ + out), report = run(of_track_report_ + page);
  setrlimit(RLIMIT_FSIZE, &room);
  EXPECT_EQ(points.err, "limber: points: cannot write " + out + ": File too large\n");
  EXPECT_EQ(points.exit_code + report.exit_code, 2);
  EXPECT_TRUE(files() == before);
}

TEST_F(ProgramOutputFiles, AreWholeWheneverRunsAreKilled) {
  std::string points;
  for (int i = 0; i < 100'000; ++i) points += std::to_string(i) + ",1,2\n";
  points = folder_.store("many.csv", points);
  std::string poses;
  for (int i = 0; i < 100; ++i) poses += text_of(poses_);
  poses = folder_.store("many_poses.csv", poses);
  const Folder outputs;
  const std::string out = outputs.path("out.csv"), page = outputs.path("page"), err = folder_.path("err");
  const std::string both = " --out " + out + " --report " + page;
  std::mt19937 random(1);
  int cut_short = 0;  // runs of points, which go on for a while
  for (const std::string& line :
       {"points " + ball_ + ' ' + points + " --out " + out, "distance --pairs " + pairs_ + both,
        "contacts scene:ball " + ball_ + " --margin 1 --out " + out,
        "track --a scene:ball --b " + ball_ + " --poses-a " + poses + both}) {
    ASSERT_EQ(run(line).exit_code, 0) << line;
    const std::size_t line_count = lines_of(text_of(out)).size();
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGKILL}) {
      SCOPED_TRACE(line + ", signal " + std::to_string(signal));
      for (const std::string& path : {out, page}) std::ofstream(path) << "from before";
      const std::string command = std::string("exec ") + LIMBER_PROGRAM + ' ' + line + " >/dev/null 2>" + err;
      const pid_t pid = fork();
      if (pid == 0) execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      std::string beside;
      bool is_running = true;
      do {
        usleep(static_cast<useconds_t>(random() % 100'000));
        for (const auto& entry : fs::directory_iterator(outputs.path(""))) {
          if (entry.path() != out && entry.path() != page) beside = entry.path();
        }
        is_running = waitpid(pid, nullptr, WNOHANG) == 0;
      } while (is_running && line.starts_with("points") && lines_of(text_of(beside)).size() < 2);
      if (is_running) {
        kill(pid, signal);
        waitpid(pid, nullptr, 0);
      }
      const std::string table = text_of(out), html = text_of(page);
      EXPECT_TRUE(table == "from before" || lines_of(table).size() == line_count) << table.size();
      EXPECT_TRUE(html == "from before" || html.ends_with("</html>\n")) << html.size();
      if (line.starts_with("points") && fs::exists(beside)) ++cut_short;
      for (const auto& entry : fs::directory_iterator(outputs.path(""))) {
        const std::string path = entry.path();
        if (path == out || path == page) continue;
        EXPECT_EQ(path.find(".partial-"), path.size() - 17);
        fs::remove(path);
        if (signal == SIGKILL) continue;
        // A warning of the rows until then may come first.
        EXPECT_TRUE(text_of(err).ends_with("limber: rows until now are in " + path + "; " + out + " is as before\n"))
            << text_of(err);
      }
    }
  }
  EXPECT_GT(cut_short, 0);
}

}  // namespace
}  // namespace limber::program_tests
