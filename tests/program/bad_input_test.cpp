// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>

#include "program/run_program.h"
#include "scenes/scenes.h"

namespace limber::program_tests {
namespace {

TEST(ProgramBadInput, VerbsAndOptions) {
  expect_refused({},
                 "a verb is missing; there are info, distance, collide, within, contacts, self, points, track, demo, "
                 "haptics, help, version");
  expect_refused({"measure"}, "'measure' is no verb; there are info, distance, collide, within");
  expect_refused({"--jason"}, "'--jason' is no option");
  expect_refused({"--json", "distance", "scene:ball", "scene:ball"}, "distance: '--json' stands before the verb");
  expect_refused({"measure\nfoo"}, "'measure foo' is no verb");
  expect_refused({"info"}, "info: M is required");
  expect_refused({"distance", "scene:ball"}, "distance: B is required");
  expect_refused({"distance", "scene:ball", "scene:ball", "c", "d"}, "distance: there is no place for 'c' and 'd'");
  expect_refused({"distance", "scene:ball", "scene:ball", "--fast"}, "distance: '--fast' is no option\n");
  expect_refused({"collide", "scene:ball", "scene:ball", "--relative-error", "1"}, "'--relative-error' is no option\n");
  expect_refused({"track", "--a", "scene:ball"}, "track: --b is required");
  expect_refused({"within", "scene:ball", "scene:ball"}, "within: --max-distance is required");
  expect_refused({"distance", "scene:ball", "scene:ball", "--exit-code"},
                 "--exit-code: needs --max-distance or --min-clearance");
  expect_refused({"distance", "scene:ball", "scene:ball", "--min-clearance", "2", "--max-distance", "1"},
                 "--max-distance: must be at least --min-clearance");
  expect_refused({"distance", "scene:ball", "scene:ball", "--out", "x.csv"}, "--out: belongs to --pairs");
  expect_refused({"distance", "scene:ball", "--pairs", "x.csv"}, "--pairs: leaves no room for A");
  expect_refused({"distance", "--pairs", "x.csv", "--pose-b", "0,0,0,1,0,0,0"}, "--pairs: leaves no room for --pose-b");
}

TEST(ProgramBadInput, QuestionsAboutPairsOfTriangles) {
  const auto contacts = [](const Words& more) {
    Words words = {"contacts", "scene:ball", "scene:ball"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  expect_refused(contacts({}), "contacts: --margin, --intersections or --closest is required");
  expect_refused(contacts({"--margin", "1", "--closest", "2"}), "contacts: --margin: leaves no room for --closest");
  expect_refused(contacts({"--margin", "1", "--intersections"}), "--margin: leaves no room for --intersections");
  expect_refused(contacts({"--closest", "0"}), "--closest: must be a whole number from 1");
  expect_refused(contacts({"--closest", "1000001"}), "--closest: must be a whole number from 1 to 1000000, not");
  expect_refused(contacts({"--margin", "1", "--limit", "-1"}), "--limit: must be a whole number from 0");
  expect_refused(contacts({"--margin", "1", "--csv", "-", "--json"}), "--csv: leaves no room on standard output");
  expect_refused(contacts({"--margin", "1", "--engine", "fast"}), "'--engine' is no option");
  expect_refused({"contacts", "scene:ball", "--margin", "1"}, "contacts: B is required");
  expect_refused({"self", "--margin", "1"}, "self: M is required");
  expect_refused({"self", "scene:ball", "--margin", "1", "--intersections"}, "self: --margin: leaves no room for");
  expect_refused({"self", "scene:ball", "--margin", "1", "--closest", "1"}, "self: --margin: leaves no room for");
  expect_refused({"self", "scene:ball", "--closest", "0"}, "--closest: must be a whole number from 1");
  expect_refused({"self", "scene:ball", "--pose-a", "0,0,0,1,0,0,0"}, "self: '--pose-a' is no option");
  for (const std::string value : {"-1", "-1e-300", "nan", "inf", "ten", ""}) {
    expect_refused(contacts({"--margin", value}), "--margin: must be a finite number >= 0");
    expect_refused({"self", "scene:ball", "--margin", value}, "--margin: must be a finite number >= 0");
  }
  const auto track = [](const Words& more) {
    Words words = {"track", "--a", "scene:ball", "--b", "scene:ball"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  expect_refused(track({"--margin", "1"}), "track: --margin: belongs to --contacts and --self");
  expect_refused(track({"--contacts", "--margin", "-1"}), "--margin: must be a finite number >= 0");
  expect_refused(track({"--contacts", "--engine", "classic"}), "track: --contacts: belongs to --engine fast");
  expect_refused(track({"--self", "--engine", "classic"}), "track: --self: belongs to --engine fast");
  expect_refused(track({"--self"}), "track: --self: neither model deforms");
}

TEST(ProgramBadInput, SlipsOfThePenAreNamed) {
  expect_refused({"distnace", "scene:ball", "scene:ball"}, "'distnace' is no verb; did you mean distance?");
  expect_refused({"colide"}, "did you mean collide?");
  expect_refused({"ifno"}, "did you mean info?");
  expect_refused({"dist"}, "did you mean distance?");
  expect_refused({"help", "trak"}, "help: 'trak' is no verb; did you mean track?");
  expect_refused({"--versoin"}, "'--versoin' is no option, did you mean --version?");
  const auto with = [](const Words& more) {
    Words words = {"distance", "scene:ball", "scene:ball"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  expect_refused(with({"--relativ-eror", "0.1"}), "'--relativ-eror' is no option, did you mean --relative-error?");
  expect_refused(with({"--relative-eror=0.1"}), "'--relative-eror' is no option, did you mean --relative-error?");
  expect_refused(with({"--max-dist", "1"}), "did you mean --max-distance?");
  expect_refused(with({"-json"}), "'-json' is no option, did you mean --json?");
  expect_refused(with({"--fast", "--engin", "fast", "-x"}),
                 "'--fast' is no option; '--engin' is no option, did you mean --engine?; '-x' is no option\n");
  // Even where the slip leaves something else missing.
  expect_refused({"track", "--a", "scene:ball", "--bb", "scene:ball"}, "track: '--bb' is no option");
}

TEST(ProgramBadInput, Numbers) {
  const auto with = [](const std::string& option, const std::string& value) {
    return Words{"distance", "scene:ball", "scene:ball", option, value};
  };
  for (const std::string value : {"-1", "-1e-300", "nan", "inf", "-inf", "1e999", "ten", "0.1x", "0x10", "1,5", ""}) {
    expect_refused(with("--relative-error", value), "--relative-error: must be a finite number >= 0");
  }
  expect_refused({"distance", "scene:ball", "scene:ball", "--relative-error"}, "--relative-error");
  expect_refused({"distance", "scene:ball", "scene:ball", "--relative-error", "1", "--relative-error", "2"},
                 "--relative-error");
  expect_refused(with("--engine", "quick"), "--engine: must be one of fast|classic|reference, not 'quick'");
  expect_refused(with("--absolute-error", "-1"), "--absolute-error: must be a finite number >= 0");
  expect_refused(with("--max-distance", "-1"), "--max-distance: must be a number >= 0");
  expect_refused(with("--max-distance", "nan"), "--max-distance: must be a number >= 0");
  for (const std::string value : {"0", "-1", "nan", "inf"}) {
    expect_refused(with("--min-clearance", value), "--min-clearance: must be a finite number > 0");
  }
  for (const std::string value : {"-1", "nan", "inf"}) {
    expect_refused({"within", "scene:ball", "scene:ball", "--max-distance", value},
                   "--max-distance: must be a finite number >= 0");
  }
  const auto track_with = [](const std::string& option, const std::string& value) {
    return Words{"track", "--a", "scene:ball", "--b", "scene:ball", option, value};
  };
  expect_refused(track_with("--mode", "depth"), "--mode: must be one of immediate|batched|by-depth");
  const auto classic_with = [](const std::string& option, const std::string& value) {
    return Words{"track", "--a", "scene:ball", "--b", "scene:ball", "--engine", "classic", option, value};
  };
  for (const std::string value : {"-0.1", "nan", "inf", "auto", ""}) {
    expect_refused(track_with("--motion-margin", value), "--motion-margin: must be a finite number >= 0");
  }
  expect_refused(classic_with("--extra-radius", "1e9"), "--extra-radius: must be a number from 0");
  expect_refused(classic_with("--extra-radius", "auto"), "--extra-radius: must be a number from 0");
  expect_refused(track_with("--mode", "batched"), "--mode: belongs to --engine classic");
  expect_refused(track_with("--stale-ratio", "2"), "--stale-ratio: belongs to --engine classic");
  expect_refused({"track", "--a", "scene:ball", "--b", "scene:ball", "--engine", "reference"},
                 "--engine: must be one of fast|classic");
  expect_refused(track_with("--stale-ratio", "0.9"), "--stale-ratio: must be a number from 1");
  expect_refused(track_with("--stale-ratio", "nan"), "--stale-ratio: must be a number from 1");
  expect_refused(track_with("--loop", "0"), "--loop: must be a whole number from 1");
  expect_refused(track_with("--loop", "1.5"), "--loop: must be a whole number from 1");
  expect_refused({"demo", "--frames", "0"}, "--frames: must be a whole number from 1");
  expect_refused({"demo", "--frames", "99999999999999999999"}, "--frames: must be a whole number from 1");
  expect_refused({"demo", "--seed", "-1"}, "--seed: must be a whole number from 0");
}

TEST(ProgramBadInput, Poses) {
  const auto with = [](const std::string& pose) {
    return Words{"collide", "scene:ball", "scene:ball", "--pose-b", pose};
  };
  expect_refused(with("0,0,0,0,0,0,0"), "--pose-b: the quaternion");
  expect_refused(with("0,0,0,nan,0,0,0"), "--pose-b: the quaternion");
  expect_refused(with("0,0,0,1,0,0,1e400"), "--pose-b: the quaternion");
  expect_refused(with("nan,0,0,1,0,0,0"), "--pose-b: the translation");
  expect_refused(with("1e200,0,0,1,0,0,0"), "--pose-b: the translation");
  expect_refused(with("1,2,3"), "--pose-b: a pose is 7 numbers tx,ty,tz,qw,qx,qy,qz, not 3");
  expect_refused(with("0,0,0,1,0,0,0,0"), "not 8");
  expect_refused(with("0,0,0,1,0,0,"), "'' is not a number");
  expect_refused(with("0,0,zero,1,0,0,0"), "'zero' is not a number");
  expect_refused(with(""), "--pose-b: ");
}

TEST(ProgramBadInput, Models) {
  const Folder folder;
  expect_refused({"info", folder.path("missing.obj")}, "missing.obj");
  expect_refused({"info", folder.path("")}, "info: ");
  expect_refused({"info", folder.store("mesh.txt", "")}, "mesh.txt");
  expect_refused({"info", folder.store("empty.obj", "")}, "empty.obj");
  expect_refused({"info", folder.store("points.obj", "v 0 0 0\nv 1 0 0\n")}, "points.obj");
  expect_refused({"info", folder.store("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")}, "nan.obj");
  expect_refused({"info", folder.store("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")}, "index.obj");
  expect_refused({"info", folder.store("huge.obj", "v 0 0 1e70\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")}, "huge.obj");
  expect_refused({"info", folder.store("noise.stl", "\x01\x02\x03")}, "noise.stl");
  expect_refused({"info", "scene:cube"}, "scene:cube: no scene is called 'cube'; there are square, ball");
  expect_refused({"info", "scene:"}, "no scene is called ''");
  expect_refused({"distance", "scene:ball", "scene:wave:x"}, "wave:x");
  expect_refused({"info", "line\nbreak.obj"}, "line break.obj");
  expect_refused({"info", ""}, "info: ");
}

TEST(ProgramBadInput, Tracks) {
  const Folder folder;
  const auto with_poses = [&](const std::string& csv) {
    return Words{"track", "--a", "scene:ball", "--b", "scene:square", "--poses-a", folder.store("poses.csv", csv)};
  };
  expect_refused(with_poses(""), "poses.csv: has no pose");
  expect_refused(with_poses("# nothing\n\n"), "poses.csv: has no pose");
  expect_refused(with_poses("0,0,3,1,0,0,0\n0,0,3,1,0,0\n"), "poses.csv: line 2: a pose is 7 numbers");
  expect_refused(with_poses("# a\ntx,ty,tz,qw,qx,qy,qz\n0,0,3,1,0,0,x\n"),
                 "poses.csv: line 3: qz: 'x' is not a number");
  expect_refused(with_poses("0,0,3,0,0,0,0\n"), "poses.csv: line 1: the quaternion");
  expect_refused(with_poses("0,0,3,1,0,0,0\ntx,ty,tz,qw,qx,qy,qz\n"), "poses.csv: line 2: tx: 'tx' is not a number");
  expect_refused(with_poses("0;0;3;1;0;0;0\n0;0;4;1;0;0;0\n"), "poses.csv: line 1: fields are separated by commas");
  expect_refused(with_poses("tx;ty;tz;qw;qx;qy;qz\n"), "poses.csv: line 1: fields are separated by commas");
  expect_refused(with_poses("0,5;0;3;1;0;0;0\n"), "poses.csv: line 1: fields are separated by commas");
  expect_refused(with_poses("# a\nmodel;tx\n"), "poses.csv: line 2: fields are separated by commas");
  expect_refused(with_poses("x,y,z,w,i,j,k\n0,0,3,1,0,0,0\n"), "line 1: no column is called 'x'; did you mean tx?");
  expect_refused(with_poses("a,b,c\n0,0,3,1,0,0,0\n"), "line 1: there is no column tx; poses are tx,ty,tz,qw,qx,qy,qz");
  expect_refused(with_poses("tx,ty,tz,qw,qx,qy,qz,tx\n"), "line 1: column tx comes twice");
  expect_refused(with_poses("tx,ty,tz,qw,qx,qy,qz\n0,0,3,1,0,0\n"), "line 2: has 6 fields, but the header has 7");
  expect_refused(with_poses("0,0,3,1,0,0,\"0\n"), "line 1: a quote is not closed");
  expect_refused(with_poses("0,0,3,1,0,0,\"0\"1\n"), "line 1: no comma follows a field in quotes");
  expect_refused(with_poses("0 0 3 1 0 0 0\n0 0 4 1 0 0 0\n"), "poses.csv: line 1: a pose is 7 numbers");
  expect_refused(with_poses("\n0,0,3,1,0,0,0" + std::string(20000, ' ') + "\n"), "poses.csv: line 2: is longer than");
  expect_refused(with_poses("0,0,3,1,0,0,\x1b[31m\n"), "line 1: qz: '?[31m' is not a number");
  expect_refused({"track", "--a", "scene:ball", "--b", "scene:ball", "--poses-b", folder.path("no.csv")}, "no.csv");
  expect_refused({"track", "--a", "scene:ball", "--b", "scene:ball", "--poses-b", folder.path("")}, "is a folder");
  expect_refused(
      {"track", "--a", "scene:wave:0", "scene:wave:1", "--b", "scene:wave:0", "scene:wave:1", "scene:wave:2"},
      "--a has 2 frames, but --b has 3");
  expect_refused({"track", "--a", "scene:wave:0", "scene:wave:1", "--b", "scene:ball", "--poses-b",
                  folder.store("three.csv", "0,0,3,1,0,0,0\n0,0,3,1,0,0,0\n0,0,3,1,0,0,0\n")},
                 "--a has 2 frames, but --poses-b has 3");
  expect_refused({"track", "--a", "scene:wave:0", folder.path("x.obj"), "--b", "scene:ball"}, "not both");
}

TEST(ProgramBadInput, PosesThatAreNoRegularFiles) {
  const Folder folder;
  const auto with_poses = [](const std::string& path) {
    return Words{"track", "--a", "scene:ball", "--b", "scene:ball", "--poses-a", path};
  };
  ASSERT_EQ(mkfifo(folder.path("pipe.csv").c_str(), 0600), 0);
  expect_refused(with_poses(folder.path("pipe.csv")), "pipe.csv: is not a regular file");
  expect_refused(with_poses("/dev/zero"), "/dev/zero: is not a regular file");
  const std::string large = folder.store("large.csv", "0,0,3,1,0,0,0\n");
  std::filesystem::resize_file(large, (std::uintmax_t{1} << 28U) + 1);  // takes no room on disk
  expect_refused(with_poses(large), "large.csv: has 268435457 bytes, more than the limit");
}

TEST(ProgramBadInput, RowsThatCannotBeWritten) {
  const Folder folder;
  const std::string ball = folder.store("ball.obj", scenes::ball(8, 4).view()), before = text_of(ball);
  for (const Words& question : {Words{"contacts", ball, "scene:ball"}, Words{"self", ball}}) {
    const auto with_csv = [&](const std::string& path) {
      Words words = question;
      words.insert(words.end(), {"--margin", "1", "--csv", path});
      return words;
    };
    expect_refused(with_csv(folder.path("no/such/folder.csv")), "--csv: cannot write");
    expect_refused(with_csv(folder.path("")), "--csv: cannot write");
    expect_refused(with_csv(folder.path("./ball.obj")),
                   "--csv: " + folder.path("./ball.obj") + " is one of the inputs");
    EXPECT_EQ(text_of(ball), before);
    if (!std::filesystem::exists("/dev/full")) continue;
    const Outcome full = run(with_csv("/dev/full"));
    EXPECT_EQ(full.exit_code, 1);
    EXPECT_EQ(full.out, "");
    EXPECT_EQ(lines_of(full.err).size(), 1U) << full.err;
  }
}

TEST(ProgramBadInput, PagesThatCannotBeWritten) {
  const Folder folder;
  expect_refused({"demo", "--out", folder.path("no/such/folder.html")}, "demo: --out: cannot write");
  expect_refused({"demo", "--out", folder.path("")}, "demo: --out: cannot write");
}

}  // namespace
}  // namespace limber::program_tests
