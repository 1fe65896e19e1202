// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// One pair of models: `limber distance`, `collide` and `within`, where models stand and on their paths.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "contact_meshes.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

const std::string raised_ball = " scene:ball scene:square --pose-a ";

TEST(ProgramDistance, AnswersAreThoseOfTheLibrary) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Soups soups(seed, 0.4);
    const Model a(soups.a), b(soups.b);
    const std::vector<std::pair<std::string, Transform>> poses = {
        {"0,0,0,1,0,0,0", {}},
        {"2.1,0.3,-0.7,0.3,-0.4,0.5,0.6", transform_from_quaternion({2.1, 0.3, -0.7}, 0.3, -0.4, 0.5, 0.6).value()}};
    for (const auto& [text, pose] : poses) {
      const DistanceResult expected = distance({a}, {b, pose});
      const nlohmann::json json = json_of("distance" + soups.files() + " --pose-b " + text);
      EXPECT_EQ(json["status"], expected.upper == 0 ? "collision" : "exact");
      EXPECT_EQ(json["lower"], expected.lower);
      EXPECT_EQ(json["upper"], expected.upper);
      const nlohmann::json& witness = json["witness"];
      EXPECT_EQ(point_of(witness["point_a"]), expected.witness->point_a);
      EXPECT_EQ(point_of(witness["point_b"]), expected.witness->point_b);
      EXPECT_EQ(witness["triangle_a"], expected.witness->triangle_a);
      EXPECT_EQ(witness["triangle_b"], expected.witness->triangle_b);
      EXPECT_EQ(json_of("collide" + soups.files() + " --pose-b " + text)["is_yes"], expected.upper == 0);
    }
  }
}

TEST(ProgramDistance, LimitsAreHeld) {
  const std::string line = "distance" + raised_ball + "0,0,3,1,0,0,0";
  EXPECT_NE(answer_to(line + " --max-distance 1.5")
                .find("status    beyond_limit\nlower     1.5\nclash     surfaces apart\ntests"),
            std::string::npos);
  for (const std::string limit : {"2.5", "inf"}) {
    EXPECT_EQ(json_of(line + " --max-distance " + limit)["status"], "exact") << limit;
  }
  const nlohmann::json json = json_of(line + " --max-distance 1.5");
  for (const char* key : {"upper", "witness"}) EXPECT_TRUE(json[key].is_null()) << key;
}

/// The fewest significant digits that read back as the same number.
std::string shortest(double number) {
  char text[64];
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, number);
    if (std::strtod(text, nullptr) == number) break;
  }
  return text;
}

TEST(ProgramDistance, WritesTheFewestDigitsThatReadBackAsTheSameNumber) {
  const Soups soups(9, 0.4);
  const std::string question = "distance" + soups.files() + "--pose-b 2.5,0.1,0.2,1,2,3,4";
  const std::string answer = answer_to(question + " --json"), text = answer_to(question);
  const nlohmann::json json = nlohmann::json::parse(answer);
  const std::string upper = shortest(json["upper"].get<double>());
  EXPECT_NE(answer.find("\"upper\": " + upper + ","), std::string::npos) << answer;
  EXPECT_NE(text.find("upper     " + upper + '\n'), std::string::npos) << text;
  for (const double coordinate : json["witness"]["point_b"].get<std::vector<double>>()) {
    EXPECT_NE(answer.find(shortest(coordinate)), std::string::npos) << coordinate << " in " << answer;
  }
}

TEST(ProgramDistance, QuaternionsMayHaveAnyLength) {
  const auto upper = [](const std::string& pose) {
    return json_of("distance scene:square scene:ball --pose-a " + pose)["upper"].get<double>();
  };
  // A quarter turn about x makes the square upright, 3 units from the center of the ball.
  EXPECT_NEAR(upper("0,3,0,1,1,0,0"), 2, 0.02);
  EXPECT_EQ(upper("0,3,0,1,1,0,0"), upper("0,3,0,1e-200,1e-200,0,0"));
  EXPECT_EQ(upper("0,3,0,1,1,0,0"), upper("' 0, +3, 0,\t-8e100,-8e100,0,0'"));
}

TEST(ProgramDistance, ErrorsWidenTheIntervalAndKeepItTrue) {
  const std::string line = "distance" + raised_ball + "0.1,0.2,4,1,0,0,0";
  const auto exact = json_of(line)["upper"].get<double>();
  for (const std::string error : {"0.01", "0.1", "1", "10", "1e300"}) {
    const nlohmann::json json = json_of(line + " --relative-error " + error);
    EXPECT_LE(json["lower"].get<double>(), exact);
    EXPECT_GE(json["upper"].get<double>(), exact);
    EXPECT_LE(json["upper"].get<double>(), exact * (1 + number(error)) * (1 + 1e-12));
    EXPECT_EQ(json["status"], json["lower"] == json["upper"] ? "exact" : "within_error");
  }
}

TEST(ProgramDistance, FacesAreThoseOfTheFile) {
  const Folder folder;
  // A strip of three quads along x; the second triangle of the last quad is nearest to a point-like triangle beyond it.
  const std::string both = folder.store("strip.obj",
                                        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 3 1 0\n"
                                        "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n") +
                           ' ' + folder.store("far.obj", "v 2.5 2 0\nf 1 1 1\n");
  const nlohmann::json pair = json_of("contacts --margin 1 " + both)["pairs"].at(0);
  for (const nlohmann::json& found : {json_of("distance " + both)["witness"], pair}) {
    EXPECT_EQ(found["triangle_a"], 5);
    EXPECT_EQ(found["face_a"], 2);
    EXPECT_EQ(found["face_b"], 0);
  }
  EXPECT_EQ(pair["feature_a"], "edge 1");
  EXPECT_EQ(pair["feature_b"].get<std::string>().find("vertex "), 0U);
  EXPECT_EQ(point_of(pair["normal"]), (Vec3{0, 1, 0}));
}

TEST(ProgramDistance, PartsOfAFileAreNamedInAnswersToOnePair) {
  const Folder folder;
  const std::string many = folder.store(
      "many.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\no left\nf 1 2 3\no right\nf 4 5 6\n");
  const std::string both = many + ' ' + folder.store("one.obj", "v 5 0 0\nv 6 0 0\nv 5 1 0\no only\nf 1 2 3\n");
  for (const std::string question : {"distance ", "collide ", "within --max-distance 2 ", "contacts --margin 2 ",
                                     "contacts --closest 1 ", "contacts --intersections "}) {
    const nlohmann::json json = json_of(question + both);
    const nlohmann::json found = json.contains("witness") ? json["witness"] : json["pairs"][0];
    EXPECT_EQ(found["part_a"], "right") << question;
    EXPECT_TRUE(found["part_b"].is_null()) << question;
    const std::string text = answer_to(question + both);
    EXPECT_EQ(count_of("face 1, part right\n", text) + count_of("; right, -\n", text), 1U) << text;
  }
  EXPECT_EQ(json_of("self " + many)["distance"]["witness"]["part_b"], "right");
  EXPECT_EQ(table_of(answer_to("contacts --margin 2 --out - " + both)).at(0).at("part_a"), "right");
  const std::string pairs = folder.store("pairs.csv", "model_a,model_b\n" + many + ",scene:ball\n");
  EXPECT_FALSE(json_rows_of("distance --pairs " + pairs).at(0)["witness"].contains("part_a"));  // as in the columns
}

TEST(ProgramCollide, SaysYesOrNoAndWhere) {
  const nlohmann::json yes = json_of("collide" + raised_ball + "0,0,5,1,0,0,0 --pose-b 0,0,4.5,1,0,0,0");
  EXPECT_EQ(yes["is_yes"], true);
  EXPECT_NEAR(point_of(yes["witness"]["point_a"]).z, 4.5, 1e-12);
  EXPECT_EQ(yes["witness"]["point_a"], yes["witness"]["point_b"]);
  EXPECT_TRUE(json_of("collide" + raised_ball + "0,0,1.001,1,0,0,0")["witness"].is_null());
  EXPECT_EQ(answer_to("collide" + raised_ball + "0,0,1.001,1,0,0,0").find("collision no"), 0U);
  EXPECT_EQ(json_of("collide" + raised_ball + "0,0,1,1,0,0,0")["is_yes"], true);  // they touch
}

TEST(ProgramWithin, IsClosed) {
  const auto ask = [&](const std::string& limit) {
    return json_of("within" + raised_ball + "0,0,3,1,0,0,0 --max-distance " + limit);
  };
  EXPECT_EQ(ask("1.9999")["is_yes"], false);
  EXPECT_TRUE(ask("1.9999")["witness"].is_null());
  EXPECT_EQ(ask("2")["is_yes"], true);
  const nlohmann::json json = ask("2.5");
  EXPECT_EQ(json["max_distance"], 2.5);
  EXPECT_LE(length(point_of(json["witness"]["point_a"]) - point_of(json["witness"]["point_b"])), 2.5);
  const std::string text = answer_to("within" + raised_ball + "0,0,0,1,0,0,0 --max-distance 0.5");
  EXPECT_EQ(text.find("within    yes\nmax distance 0.5\npoint a   "), 0U) << text;
}

TEST(ProgramClearance, IsDecidedExactlyWhateverTheErrors) {
  const std::string question = "distance scene:ball scene:square --pose-a 0.1,0.2,3,1,0,0,0 ";
  EXPECT_TRUE(json_of(question)["too_close"].is_null());
  const auto ask = [&](const std::string& clearance, const std::string& options) {
    const Outcome outcome = run(question + "--json --min-clearance " + clearance + options);
    nlohmann::json answer = json_lines_of(outcome).at(0);
    EXPECT_EQ(outcome.exit_code, answer["too_close"] == true ? 3 : 0);
    return answer;
  };
  const std::string upper = ask("1", "")["upper"].dump();
  const std::string above = std::to_string(number(upper) + 1e-3), below = std::to_string(number(upper) - 1e-3);
  for (const std::string errors :
       {"", " --relative-error 1", " --absolute-error 5", " --relative-error 1 --max-distance 7"}) {
    EXPECT_EQ(ask(above, errors)["too_close"], true);
    EXPECT_EQ(ask(below, errors)["too_close"], false);
    EXPECT_EQ(ask(upper, errors)["too_close"], false);
  }
  // Far from the clearance the errors save work: the answer stays an interval.
  EXPECT_EQ(ask("0.1", " --relative-error 1")["status"], "within_error");
  EXPECT_EQ(ask(below, " --relative-error 1")["status"], "exact");
  EXPECT_NE(run(question + "--min-clearance 2.5").out.find("\nclearance below 2.5\n"), std::string::npos);
  EXPECT_NE(run(question + "--min-clearance 1.5").out.find("\nclearance at least 1.5\n"), std::string::npos);
}

TEST(ProgramExitCode, TellsTheAnswerOnlyWhereItIsAskedFor) {
  const Folder folder;
  const std::string through = folder.store("through.obj", folded_strip(0.2, -0.2)) + ' ';
  const std::string above = folder.store("above.obj", folded_strip(0.25, 0.25)) + ' ';
  const std::string meeting = "scene:ball scene:square ", apart = meeting + "--pose-a 0,0,3,1,0,0,0 ";  // by 2
  for (const auto& [line, exit_code] :
       std::vector<std::pair<std::string, int>>{{"collide " + meeting, 0},
                                                {"collide " + meeting + "--exit-code", 3},
                                                {"collide " + meeting + "--exit-code --json", 3},
                                                {"collide " + apart + "--exit-code", 0},
                                                {"within " + apart + "--max-distance 2", 0},
                                                {"within " + apart + "--max-distance 2 --exit-code", 3},
                                                {"within " + apart + "--max-distance 1.9 --exit-code", 0},
                                                {"distance " + apart + "--max-distance 2 --exit-code", 3},
                                                {"distance " + apart + "--max-distance 1.9 --exit-code", 0},
                                                {"distance " + apart + "--min-clearance 2.1", 3},
                                                {"distance " + apart + "--min-clearance 2", 0},  // as far as asked for
                                                {"distance " + apart + "--min-clearance 2 --max-distance 2", 0},
                                                {"contacts " + meeting + "--intersections", 0},
                                                {"contacts " + meeting + "--intersections --exit-code", 3},
                                                {"contacts " + meeting + "--margin 0 --exit-code --max-count 0", 3},
                                                {"contacts " + apart + "--intersections --exit-code", 0},
                                                {"contacts " + apart + "--margin 1.9 --exit-code", 0},
                                                {"contacts " + apart + "--margin 2.1 --exit-code", 3},
                                                {"contacts " + apart + "--closest 1 --exit-code", 3},
                                                {"self " + through, 0},
                                                {"self " + through + "--exit-code", 3},
                                                {"self " + through + "--intersections --exit-code --json", 3},
                                                {"self " + above + "--exit-code", 0},
                                                {"self " + above + "--margin 0.1 --exit-code", 0},
                                                {"self " + above + "--margin 0.3 --exit-code", 3},
                                                {"self " + above + "--closest 1 --exit-code", 3}}) {
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.exit_code, exit_code) << line;
    EXPECT_EQ(outcome.err, "") << line;
    EXPECT_NE(outcome.out, "") << line;
  }
  for (const std::string verb : {"collide scene:ball", "self"}) {
    EXPECT_EQ(run(verb + " missing.obj --exit-code").exit_code, 2);
  }
}

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
