// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Paths of rigid models, of `limber collide`, `within` and `distance`: times known on paper.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "contact_meshes.h"
#include "formats/scenes.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

const std::string ball_and_square = " scene:ball scene:square --path-a ";

TEST(ProgramPaths, TellWhenModelsMeetFirst) {
  const Folder folder;
  // The ball, of radius 1, is at heights 5, 3, -1 and 9.
  const std::string path = ball_and_square + folder.store("path.csv",
                                                          "tx,ty,tz,qw,qx,qy,qz\n0,0,5,1,0,0,0\n0,0,3,1,0,0,0\n"
                                                          "0,0,-1,1,0,0,0\n0,0,9,1,0,0,0\n");
  const nlohmann::json meet = json_of("collide" + path);
  EXPECT_EQ(meet["is_yes"], true);
  EXPECT_LE(meet["path_time"].get<double>(), 1.5);
  EXPECT_NEAR(meet["path_time"].get<double>(), 1.5, 1e-6);
  EXPECT_NEAR(length(point_of(meet["witness"]["point_b"])), 0, 1e-5);
  EXPECT_EQ(answer_to("collide" + path).find("collision yes\npoint a   0 0 "), 0U);
  EXPECT_NE(answer_to("collide" + path).find("\npath time 1.49999"), std::string::npos);
  const nlohmann::json near = json_of("within --max-distance 2.5" + path);
  EXPECT_NEAR(near["path_time"].get<double>(), 0.75, 1e-6);
  EXPECT_EQ(json_of("within --max-distance 4" + path)["path_time"], 0);
  EXPECT_EQ(run("collide --exit-code" + path).exit_code, 3);
  const nlohmann::json distance = json_of("distance" + path);
  EXPECT_EQ(distance["status"], "collision");
  EXPECT_TRUE(distance["clash"].is_null() && distance["solids"].is_null());
}

TEST(ProgramPaths, TellHowNearModelsCome) {
  const Folder folder;
  const std::string path =
      ball_and_square + folder.store("path.csv", "0,0,5,1,0,0,0\n0,0,2.5,1,0,0,0\n0,0,4,1,0,0,0\n");
  const nlohmann::json distance = json_of("distance --distance-error 1e-6" + path);
  EXPECT_EQ(distance["path_time"], 1);
  EXPECT_EQ(distance["upper"], 1.5);
  EXPECT_LE(distance["lower"].get<double>(), 1.5);
  EXPECT_NEAR(distance["lower"].get<double>(), 1.5, 1e-6);
  EXPECT_NE(answer_to("distance" + path).find("\npath time 1\n"), std::string::npos);
  const nlohmann::json exact = json_of("distance --distance-error 0" + path);
  EXPECT_EQ(exact["upper"], 1.5);
  EXPECT_NEAR(exact["lower"].get<double>(), 1.5, 1e-11);
  const nlohmann::json rough = json_of("distance --distance-error 0.5" + path);
  EXPECT_LE(rough["lower"].get<double>(), 1.5);
  EXPECT_GE(rough["upper"].get<double>(), 1.5);
  EXPECT_LT(rough["node_tests"], distance["node_tests"]);
  const nlohmann::json apart = json_of("collide" + path);
  EXPECT_EQ(apart["is_yes"], false);
  EXPECT_TRUE(apart["path_time"].is_null());
  EXPECT_EQ(answer_to("collide" + path).find("path time"), std::string::npos);
  EXPECT_EQ(run("within --max-distance 1.4 --exit-code" + path).exit_code, 0);
  EXPECT_EQ(run("within --max-distance 1.6 --exit-code" + path).exit_code, 3);
}

TEST(ProgramPaths, ModelsTurnBetweenPoses) {
  const Folder folder;
  // An upright blade from 1 to 2 along x turns about z by a quarter, through an upright pin at 60 degrees.
  const std::string blade = folder.store("blade.obj", "v 1 0 -1\nv 2 0 -1\nv 1 0 1\nv 2 0 1\nf 1 2 3\nf 2 4 3\n");
  const std::string pin = folder.store("pin.obj", "v 1.5 0 -2\nv 1.5 0 2\nf 1 2 2\n");
  const std::string quarter = folder.store("path.csv", "0,0,0,1,0,0,0\n0,0,0,1,0,0,1\n");
  const std::string models = "collide " + blade + ' ' + pin, turned = " --pose-b 0,0,0,0.8660254037844387,0,0,0.5";
  for (const std::string end : {"0,0,0,1,0,0,0", "0,0,0,1,0,0,1"}) {
    EXPECT_EQ(json_of(models + turned + " --pose-a " + end)["is_yes"], false);
  }
  EXPECT_NEAR(json_of(models + turned + " --path-a " + quarter)["path_time"].get<double>(), 2.0 / 3, 1e-5);
  // The pin turns back instead, which the blade sees as the same motion. Then both models turn: towards each other,
  // and along with each other.
  const std::string back = folder.store("back.csv", "0,0,0,0.8660254037844387,0,0,0.5\n0,0,0,1,0,0,0\n");
  EXPECT_EQ(json_of(models + " --path-b " + back)["path_time"].get<double>() > 0.999, true);
  EXPECT_NEAR(json_of(models + " --path-a " + quarter + " --path-b " + back)["path_time"].get<double>(), 0.4, 1e-5);
  EXPECT_EQ(json_of(models + " --path-a " + quarter + " --path-b " +
                    folder.store("along.csv", "0,0,0,1,0,0,0.5\n0,0,0,0.5,0,0,1\n"))["is_yes"],
            false);
}

TEST(ProgramPaths, NestingIsThatOfTheStart) {
  const Folder folder;
  const std::string room = folder.store("room.obj", cube({}, 4)), path = folder.store("path.csv",
                                                                                      "0,0,0,1,0,0,0\n"
                                                                                      "1,0,0,1,0,0,0\n");
  for (const std::string verb : {"collide", "within --max-distance 1", "distance"}) {
    const Outcome outcome = run(verb + " scene:ball " + room + " --json --path-a " + path);
    EXPECT_EQ(json_lines_of(outcome).at(0)["inside"], "a_inside_b") << verb;
    EXPECT_NE(outcome.err.find("A lies inside B"), std::string::npos) << verb;
  }
}

}  // namespace
}  // namespace limber::program_tests
