// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <utility>

#include "formats/scenes.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

const std::string of_balls = "scene:ball scene:ball ", tracked_balls = "track --a scene:ball --b scene:ball ";
const std::string not_negative = "must be a finite number >= 0";

TEST(ProgramBadInput, VerbsAndOptions) {
  expect_all_refused(
      "",
      {{"", "a verb is missing; there are info, distance, collide, within, contacts, self, points, track, demo, help"},
       {"measure", "'measure' is no verb; there are info, distance, collide, within"},
       {"--jason", "'--jason' is no option"},
       {"--json distance " + of_balls, "distance: '--json' stands before the verb"},
       {"'measure\nfoo'", "'measure foo' is no verb"},
       {"info", "info: M is required"},
       {"collide " + of_balls + "--relative-error 1", "'--relative-error' is no option\n"},
       {"track --a scene:ball", "track: --b is required"},
       {"within " + of_balls, "within: --max-distance is required"}});
  expect_all_refused("distance scene:ball ",
                     {{"", "distance: B is required"}, {"--pairs x.csv", "--pairs: leaves no room for A"}});
  expect_all_refused("distance " + of_balls,
                     {{"c d", "distance: there is no place for 'c' and 'd'"},
                      {"--fast", "distance: '--fast' is no option\n"},
                      {"--exit-code", "--exit-code: needs --max-distance or --min-clearance"},
                      {"--min-clearance 2 --max-distance 1", "--max-distance: must be at least --min-clearance"},
                      {"--out x.csv", "--out: belongs to --pairs"},
                      {"--distance-error 1", "--distance-error: belongs to --path-a and --path-b"},
                      {"--relative-error", "--relative-error"},
                      {"--relative-error 1 --relative-error 2", "--relative-error"}});
  expect_refused("distance --pairs x.csv --pose-b 0,0,0,1,0,0,0", "--pairs: leaves no room for --pose-b");
}

TEST(ProgramBadInput, QuestionsAboutPairsOfTriangles) {
  expect_all_refused("contacts " + of_balls,
                     {{"", "contacts: --margin, --intersections or --closest is required"},
                      {"--margin 1 --closest 2", "contacts: --margin: leaves no room for --closest"},
                      {"--margin 1 --intersections", "--margin: leaves no room for --intersections"},
                      {"--closest 0", "--closest: must be a whole number from 1"},
                      {"--closest 1000001", "--closest: must be a whole number from 1 to 1000000, not"},
                      {"--margin 1 --max-count -1", "--max-count: must be a whole number from 0"},
                      {"--margin 1 --out - --json", "--out: leaves no room on standard output"},
                      {"--margin 1 --engine fast", "'--engine' is no option"}});
  expect_refused("contacts scene:ball --margin 1", "contacts: B is required");
  expect_refused("self --margin 1", "self: M is required");
  expect_all_refused("self scene:ball ", {{"--margin 1 --intersections", "self: --margin: leaves no room for"},
                                          {"--margin 1 --closest 1", "self: --margin: leaves no room for"},
                                          {"--closest 0", "--closest: must be a whole number from 1"},
                                          {"--pose-a 0,0,0,1,0,0,0", "self: '--pose-a' is no option"}});
  expect_all_refused(tracked_balls, {{"--margin 1", "track: --margin: belongs to --contacts and --self"},
                                     {"--contacts --margin -1", "--margin: " + not_negative},
                                     {"--self", "track: --self: neither model deforms"}});
}

TEST(ProgramBadInput, QuestionsAboutPaths) {
  const Folder folder;
  const std::string two = folder.store("two.csv", "0,0,3,1,0,0,0\n0,0,9,1,0,0,0\n");
  const std::string one = folder.store("one.csv", "0,0,3,1,0,0,0\n");
  const std::string three = folder.store("three.csv", text_of(two) + "0,0,3,1,0,0,0\n");
  for (const std::string verb : {"collide ", "distance ", "within --max-distance 1 "}) {
    expect_all_refused(verb + of_balls,
                       {{"--path-a " + one, "one.csv has one pose, and a path two or more"},
                        {"--path-a " + two + " --path-b " + three, "--path-a has 2 poses, but --path-b has 3"},
                        {"--path-b " + folder.path("missing.csv"), "missing.csv"},
                        {"--path-a " + two + " --pose-a 0,0,0,1,0,0,0", "--path-a"}});
  }
  for (const std::string option :
       {"--relative-error 1", "--absolute-error 1", "--max-distance 1", "--min-clearance 1", "--report x.html"}) {
    expect_refused("distance " + of_balls + "--path-b " + two + ' ' + option,
                   "--path-b: leaves no room for " + option.substr(0, option.find(' ')));
  }
  expect_refused("distance --pairs x.csv --path-a " + two, "--pairs: leaves no room for --path-a");
  expect_refused("contacts " + of_balls + "--margin 1 --path-a " + two, "'--path-a' is no option");
}

TEST(ProgramBadInput, SlipsOfThePenAreNamed) {
  expect_all_refused("", {{"distnace " + of_balls, "'distnace' is no verb; did you mean distance?"},
                          {"colide", "did you mean collide?"},
                          {"ifno", "did you mean info?"},
                          {"dist", "did you mean distance?"},
                          {"help trak", "help: 'trak' is no verb; did you mean track?"},
                          {"--versoin", "'--versoin' is no option, did you mean --version?"},
                          // Even where the slip leaves something else missing.
                          {"track --a scene:ball --bb scene:ball", "track: '--bb' is no option"}});
  expect_all_refused(
      "distance " + of_balls,
      {{"--relativ-eror 0.1", "'--relativ-eror' is no option, did you mean --relative-error?"},
       {"--relative-eror=0.1", "'--relative-eror' is no option, did you mean --relative-error?"},
       {"--max-dist 1", "did you mean --max-distance?"},
       {"-json", "'-json' is no option, did you mean --json?"},
       {"--fast --relativ 1 -x",
        "'--fast' is no option; '--relativ' is no option, did you mean --relative-error?; '-x' is no option\n"}});
}

TEST(ProgramBadInput, Numbers) {
  for (const std::string value : {"-1", "-1e-300", "nan", "inf", "-inf", "1e999", "ten", "0.1x", "0x10", "1,5", "''"}) {
    expect_refused("distance " + of_balls + "--relative-error " + value, "--relative-error: " + not_negative);
  }
  for (const std::string value : {"-1", "nan", "inf", "''"}) {
    expect_all_refused("", {{"contacts " + of_balls + "--margin " + value, "--margin: " + not_negative},
                            {"self scene:ball --margin " + value, "--margin: " + not_negative},
                            {"within " + of_balls + "--max-distance " + value, "--max-distance: " + not_negative},
                            {tracked_balls + "--motion-margin " + value, "--motion-margin: " + not_negative}});
  }
  for (const std::string value : {"0", "-1", "nan", "inf"}) {
    expect_refused("distance " + of_balls + "--min-clearance " + value, "--min-clearance: must be a finite number > 0");
  }
  expect_all_refused("distance " + of_balls, {{"--absolute-error -1", "--absolute-error: " + not_negative},
                                              {"--max-distance -1", "--max-distance: must be a number >= 0"},
                                              {"--max-distance nan", "--max-distance: must be a number >= 0"}});
  expect_all_refused(tracked_balls, {{"--motion-margin auto", "--motion-margin: " + not_negative},
                                     {"--engine fast", "'--engine' is no option"},
                                     {"--max-report-mb 1.5", "--max-report-mb: must be a whole number from 1"}});
  expect_all_refused("demo ", {{"--frames 0", "--frames: must be a whole number from 1"},
                               {"--frames 99999999999999999999", "--frames: must be a whole number from 1"},
                               {"--seed -1", "--seed: must be a whole number from 0"}});
}

TEST(ProgramBadInput, Poses) {
  expect_all_refused("collide " + of_balls + "--pose-b ",
                     {{"0,0,0,0,0,0,0", "--pose-b: the quaternion"},
                      {"0,0,0,nan,0,0,0", "--pose-b: the quaternion"},
                      {"0,0,0,1,0,0,1e400", "--pose-b: the quaternion"},
                      {"nan,0,0,1,0,0,0", "--pose-b: the translation"},
                      {"1e200,0,0,1,0,0,0", "--pose-b: the translation"},
                      {"1,2,3", "--pose-b: a pose is 7 numbers tx,ty,tz,qw,qx,qy,qz, not 3"},
                      {"0,0,0,1,0,0,0,0", "not 8"},
                      {"0,0,0,1,0,0,", "'' is not a number"},
                      {"0,0,zero,1,0,0,0", "'zero' is not a number"},
                      {"''", "--pose-b: "}});
}

TEST(ProgramBadInput, Models) {
  const Folder folder;
  expect_all_refused("info ", {{folder.path("missing.obj"), "missing.obj"},
                               {folder.path(""), "info: "},
                               {"scene:cube", "scene:cube: no scene is called 'cube'; there are square, ball"},
                               {"scene:", "no scene is called ''"},
                               {"'line\nbreak.obj'", "line break.obj"},
                               {"''", "info: "}});
  const Refusals files = {{"mesh.txt", ""},
                          {"empty.obj", ""},
                          {"points.obj", "v 0 0 0\nv 1 0 0\n"},
                          {"nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
                          {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"},
                          {"huge.obj", "v 0 0 1e70\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
                          {"noise.stl", "\x01\x02\x03"}};
  for (const auto& [name, text] : files) expect_refused("info " + folder.store(name, text), name);
}

/// What is said of a file, by the text in it.
void expect_files_refused(const std::string& start, const std::string& name, const Refusals& refusals) {
  const Folder folder;
  for (const auto& [text, part] : refusals) {
    SCOPED_TRACE(text.substr(0, 200));
    expect_refused(start + folder.store(name, text), name + ": " + part);
  }
}

TEST(ProgramBadInput, FilesOfPoses) {
  const std::string header = "tx,ty,tz,qw,qx,qy,qz";
  expect_files_refused(tracked_balls + "--poses-a ", "poses.csv",
                       {{"", "has no pose"},
                        {"# nothing\n\n", "has no pose"},
                        {"0,0,3,1,0,0,0\n0,0,3,1,0,0\n", "line 2: a pose is 7 numbers"},
                        {"# a\n" + header + "\n0,0,3,1,0,0,x\n", "line 3: qz: 'x' is not a number"},
                        {"0,0,3,0,0,0,0\n", "line 1: the quaternion"},
                        {"0,0,3,1,0,0,0\n" + header + "\n", "line 2: tx: 'tx' is not a number"},
                        {"0;0;3;1;0;0;0\n0;0;4;1;0;0;0\n", "line 1: fields are separated by commas, not by semicolons"},
                        {"tx;ty;tz;qw;qx;qy;qz\n", "line 1: fields are separated by commas"},
                        {"0,5;0;3;1;0;0;0\n", "line 1: fields are separated by commas"},
                        {"# a\nmodel;tx\n", "line 2: fields are separated by commas"},
                        {"x,y,z,w,i,j,k\n0,0,3,1,0,0,0\n", "line 1: no column is called 'x'; did you mean tx?"},
                        {"a,b,c\n0,0,3,1,0,0,0\n", "line 1: there is no column tx; poses are " + header},
                        {header + ",tx\n", "line 1: column tx comes twice"},
                        {header + "\n0,0,3,1,0,0\n", "line 2: has 6 fields, but the header has 7"},
                        {"0,0,3,1,0,0,\"0\n", "line 1: a quote is not closed"},
                        {"0,0,3,1,0,0,\"0\"1\n", "line 1: no comma follows a field in quotes"},
                        {"\n0,0,3,1,0,0,0" + std::string(20000, ' ') + "\n", "line 2: is longer than"},
                        {"0,0,3,1,0,0,\x1b[31m\n", "line 1: qz: '?[31m' is not a number"}});
}

TEST(ProgramBadInput, FilesOfPairs) {
  const std::string header = "model_a,model_b,pose_b_tx,pose_b_qw,pose_b_qx,pose_b_qy,pose_b_qz\n";
  const std::string two = header + "scene:ball,scene:ball,1,1,0,0,0\n";  // lines
  const Folder folder;
  const std::string out = folder.store("answers.csv", "from before");
  expect_files_refused(
      "distance --out " + out + " --pairs ", "pairs.csv",
      {{"", "is empty"},
       {header, "has no pair"},
       {"scene:ball,scene:ball\n", "line 1: there is no column model_a; the first row names the columns"},
       {"model_a,modelb\n", "line 1: no column is called 'modelb'; did you mean model_b?"},
       {"model_a,model_b,pose_b_t\n", "line 1: no column is called 'pose_b_t'; did you mean pose_b_tx?"},
       {"model_a\n", "line 1: there is no column model_b"},
       {two + ",scene:ball,1,1,0,0,0\n", "line 3: column model_a: is empty"},
       {two + "scene:ball,scene:cube,1,1,0,0,0\n", "line 3: column model_b: scene:cube: no scene"},
       {two + "scene:ball,no.obj,1,1,0,0,0\n", "line 3: column model_b: no.obj: "},
       {header + "scene:ball,scene:ball,x,1,0,0,0\n", "line 2: column pose_b_tx: 'x' is not a number"},
       {header + "scene:ball,scene:ball,1,1,,0,0\n", "line 2: column pose_b_qx: is empty, but a quaternion has"},
       {header + "scene:ball,scene:ball,1,0,0,0,0\n", "line 2: column pose_b_tx to pose_b_qz: the quaternion"},
       {header + "scene:ball,scene:ball,nan,,,,\n", "line 2: column pose_b_tx to pose_b_qz: the translation"},
       {"model_a,model_b,pose_a_qx\nscene:ball,scene:ball,1\n", "line 2: column pose_a_qw: is empty"}});
  expect_refused("distance --pairs " + folder.path("no.csv"), "no.csv: ");
  EXPECT_EQ(text_of(out), "from before");
}

TEST(ProgramBadInput, FilesOfPoints) {
  expect_files_refused("points scene:ball ", "points.csv",
                       {{"", "has no point"},
                        {"x,y\n1,2\n", "line 1: there is no column z"},
                        {"0,0,0\n1,2\n", "line 2: a point is 3 numbers x,y,z, not 2"},
                        {"x,y,z\n0,0,0\n1,2,a\n", "line 3: column z: 'a' is not a number"},
                        {"0,nan,0\n", "line 1: column y: 'nan' is not a number of at most 2^200"},
                        {"1e61,0,0\n", "line 1: column x"}});
  const Folder folder;
  const std::string point = folder.store("points.csv", "0,0,3\n");
  expect_refused("points scene:ball " + folder.path("none.csv"), "none.csv");
  expect_refused("points scene:ball " + point + " --max-distance -1", "--max-distance: must be a number >= 0");
  expect_refused("points scene:square " + point + " --signed",
                 "--signed: scene:square: the surface is not closed: the edge of triangle 0 between vertices 0 and 1 "
                 "belongs to no other triangle");
}

TEST(ProgramBadInput, FilesOfParts) {
  expect_files_refused(
      "distance --parts ", "parts.csv",
      {{"name\nx\n", "line 1: there is no column model"},
       {"model\nscene:ball\n", "has one part alone"},
       {"model\n", "has no part"},
       {"model\nscene:ball\nnowhere.obj\n", "line 3: column model: nowhere.obj"},
       {"model,pose_qw\nscene:ball,1\nscene:ball,\n", "line 2: column pose_qx: is empty"},
       {"model,pose_tx\nscene:ball,far\nscene:ball,\n", "line 2: column pose_tx: 'far' is not a number"},
       {"model,pose_tyy\nscene:ball,1\n", "line 1: no column is called 'pose_tyy'; did you mean pose_ty?"},
       {"model,ty\nscene:ball,1\n", "line 1: no column is called 'ty'; did you mean pose_ty?"}});
  expect_all_refused("distance --parts x.csv ", {{"--pairs x.csv", "--pairs: leaves no room for --parts"},
                                                 {"scene:ball", "--parts: leaves no room for A"}});
}

TEST(ProgramBadInput, Tracks) {
  const Folder folder;
  const std::string frame = folder.store("frame.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n") + ' ';
  const std::string pose = "0,0,3,1,0,0,0\n", three = folder.store("three.csv", pose + pose + pose);
  expect_all_refused("track --a " + frame + frame + "--b ",
                     {{frame + frame + frame, "--a has 2 frames, but --b has 3"},
                      {"scene:ball --poses-b " + three, "--a has 2 frames, but --poses-b has 3"},
                      {frame + "scene:ball", "scene:ball: a built-in mesh is no frame of a sequence"}});
}

TEST(ProgramBadInput, PosesThatAreNoRegularFiles) {
  const Folder folder;
  const std::string line = tracked_balls + "--poses-a ";
  ASSERT_EQ(mkfifo(folder.path("pipe.csv").c_str(), 0600), 0);
  expect_refused(line + folder.path("pipe.csv"), "pipe.csv: is not a regular file");
  expect_refused(line + "/dev/zero", "/dev/zero: is not a regular file");
  expect_refused(line + folder.path("no.csv"), "no.csv");
  expect_refused(line + folder.path(""), "is a folder");
  const std::string large = folder.store("large.csv", "0,0,3,1,0,0,0\n");
  std::filesystem::resize_file(large, (std::uintmax_t{1} << 28U) + 1);  // takes no room on disk
  expect_refused(line + large, "large.csv: has 268435457 bytes, more than the limit");
}

}  // namespace
}  // namespace limber::program_tests
