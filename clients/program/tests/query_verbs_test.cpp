// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdlib>

#include "contact_meshes.h"
#include "run_program.h"
#include "reference/reference.h"
#include "scenes/scenes.h"

namespace limber::program_tests {
namespace {

const Words witness_keys = {"face_a", "face_b", "point_a", "point_b", "triangle_a", "triangle_b"};
const Words engines = {"fast", "classic", "reference"};
const std::string raised_ball = " scene:ball scene:square --pose-a ";

TEST(ProgramDistance, PrintsExactlyTheDocumentedKeys) {
  const nlohmann::json json = json_of("distance scene:ball scene:square");
  EXPECT_EQ(keys_of(json), (Words{"build_us", "clash", "depth", "inside", "lower", "node_tests", "primitive_tests",
                                  "query", "query_us", "solids", "status", "too_close", "upper", "witness"}));
  EXPECT_EQ(keys_of(json["witness"]), witness_keys);
  EXPECT_EQ(json["query"], "distance");
  EXPECT_GE(json["build_us"].get<double>(), 0);
  EXPECT_GT(json["query_us"].get<double>(), 0);
}

TEST(ProgramDistance, AnswersAreThoseOfTheLibraryForAllEngines) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Soups soups(seed, 0.4);
    const Transform apart = transform_from_quaternion({2.1, 0.3, -0.7}, 0.3, -0.4, 0.5, 0.6).value();
    const std::vector<std::pair<std::string, Transform>> poses = {{"0,0,0,1,0,0,0", {}},
                                                                  {"2.1,0.3,-0.7,0.3,-0.4,0.5,0.6", apart}};
    for (const auto& [text, pose] : poses) {
      const DistanceResult expected = reference::distance({soups.a}, {soups.b, pose});
      for (const std::string& engine : engines) {
        SCOPED_TRACE(engine + ' ' + std::to_string(seed));
        const nlohmann::json json = json_of("distance" + soups.files() + "--engine " + engine + " --pose-b " + text);
        EXPECT_EQ(json["status"], expected.upper == 0 ? "collision" : "exact");
        EXPECT_EQ(json["lower"], json["upper"]);
        EXPECT_NEAR(json["upper"].get<double>(), expected.upper, 1e-14);
        if (engine != "reference") continue;
        const nlohmann::json& witness = json["witness"];
        EXPECT_EQ(json["upper"].get<double>(), expected.upper);
        EXPECT_EQ(point_of(witness["point_a"]), expected.witness->point_a);
        EXPECT_EQ(point_of(witness["point_b"]), expected.witness->point_b);
        EXPECT_EQ(witness["triangle_a"], expected.witness->triangle_a);
        EXPECT_EQ(witness["triangle_b"], expected.witness->triangle_b);
      }
    }
  }
}

TEST(ProgramDistance, LimitIsHeldByAllEngines) {
  const Folder folder;
  const std::string square = folder.store("square.obj", scenes::grid(2, 2, -2, -2, 2, 2));
  for (const std::string& engine : engines) {
    const std::string line = "distance scene:ball " + square + " --pose-a 0,0,3,1,0,0,0 --engine " + engine;
    const std::string beyond = answer_to(line + " --max-distance 1.5");
    EXPECT_NE(beyond.find("status    beyond_limit\nlower     1.5\nclash     surfaces apart\ntests"), std::string::npos)
        << beyond;
    EXPECT_NE(answer_to(line + " --max-distance 2.5").find("status    exact"), std::string::npos) << engine;
    EXPECT_NE(answer_to(line + " --max-distance inf").find("status    exact"), std::string::npos) << engine;
    EXPECT_NE(answer_to(line + " --absolute-error 0.5").find("upper"), std::string::npos) << engine;
    const nlohmann::json json = json_of(line + " --max-distance 1.5");
    EXPECT_EQ(json["status"], "beyond_limit");
    EXPECT_EQ(json["lower"], 1.5);
    for (const char* key : {"upper", "witness"}) EXPECT_TRUE(json[key].is_null()) << key;
  }
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
  const std::string limited = answer_to("distance" + raised_ball + "0,0,9,1,0,0,0 --max-distance 0.032987");
  EXPECT_NE(limited.find("lower     0.032987\n"), std::string::npos);
}

TEST(ProgramDistance, WitnessesAreInTheWorldFrame) {
  const nlohmann::json json = json_of("distance" + raised_ball + "100,0,12.5,1,0,0,0 --pose-b 100,0,10,1,0,0,0");
  EXPECT_EQ(json["status"], "exact");
  EXPECT_DOUBLE_EQ(json["upper"].get<double>(), 1.5);
  EXPECT_EQ(point_of(json["witness"]["point_a"]), (Vec3{100, 0, 11.5}));
  EXPECT_EQ(point_of(json["witness"]["point_b"]), (Vec3{100, 0, 10}));
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
  const nlohmann::json distance = json_of("distance " + both), contacts = json_of("contacts --margin 1 " + both);
  EXPECT_EQ(distance["upper"], 1);
  ASSERT_EQ(contacts["count"], 1);
  for (const nlohmann::json& found : {distance["witness"], contacts["pairs"][0]}) {
    EXPECT_EQ(found["triangle_a"], 5);
    EXPECT_EQ(found["face_a"], 2);
    EXPECT_EQ(found["face_b"], 0);
  }
  const nlohmann::json& pair = contacts["pairs"][0];
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
  EXPECT_EQ(keys_of(json_rows_of("distance --pairs " + pairs).at(0)["witness"]), witness_keys);  // as in the columns
}

TEST(ProgramCollide, SaysYesWithAPointOnBoth) {
  const nlohmann::json json = json_of("collide" + raised_ball + "0,0,5,1,0,0,0 --pose-b 0,0,4.5,1,0,0,0");
  EXPECT_EQ(keys_of(json),
            (Words{"build_us", "inside", "is_yes", "node_tests", "primitive_tests", "query", "query_us", "witness"}));
  EXPECT_EQ(json["query"], "collide");
  EXPECT_EQ(json["is_yes"], true);
  EXPECT_EQ(keys_of(json["witness"]), witness_keys);
  EXPECT_NEAR(point_of(json["witness"]["point_a"]).z, 4.5, 1e-12);
  EXPECT_EQ(json["witness"]["point_a"], json["witness"]["point_b"]);
}

TEST(ProgramCollide, SaysNoWithoutAWitnessAndYesWhereModelsTouch) {
  const std::string line = "collide" + raised_ball;
  const nlohmann::json json = json_of(line + "0,0,1.001,1,0,0,0");
  EXPECT_EQ(json["is_yes"], false);
  EXPECT_TRUE(json["witness"].is_null());
  EXPECT_EQ(answer_to(line + "0,0,1.001,1,0,0,0").find("collision no"), 0U);
  EXPECT_EQ(json_of(line + "0,0,1,1,0,0,0")["is_yes"], true);
}

TEST(ProgramCollide, AllEnginesAgreeWithTheDistance) {
  for (int seed = 1; seed <= 3; ++seed) {
    const std::string both =
        " scene:lattice:" + std::to_string(seed) + " scene:lattice:" + std::to_string(seed + 100) + " --pose-b ";
    for (const std::string pose : {"0,0,0,1,0,0,0", "3,0,0,1,0,0,0", "4,4,0,1,0,0,0"}) {
      const bool is_collision = json_of("distance" + both + pose)["status"] == "collision";
      for (const std::string& engine : engines) {
        EXPECT_EQ(json_of("collide" + both + pose + " --engine " + engine)["is_yes"], is_collision) << engine;
      }
    }
  }
}

TEST(ProgramWithin, IsClosedAndTheSameForAllEngines) {
  const Folder folder;
  const std::string both = "within " + folder.store("ball.obj", scenes::ball(8, 6).view()) + ' ' +
                           folder.store("square.obj", scenes::grid(2, 2, -4, -4, 4, 4).view());
  for (const std::string& engine : engines) {
    const auto ask = [&](const std::string& limit) {
      return json_of(both + " --pose-a 0,0,3,1,0,0,0 --engine " + engine + " --max-distance " + limit);
    };
    EXPECT_EQ(ask("1.9999")["is_yes"], false) << engine;
    EXPECT_TRUE(ask("1.9999")["witness"].is_null()) << engine;
    EXPECT_EQ(ask("2")["is_yes"], true) << engine;
    const nlohmann::json json = ask("2.5");
    EXPECT_EQ(keys_of(json), (Words{"build_us", "inside", "is_yes", "max_distance", "node_tests", "primitive_tests",
                                    "query", "query_us", "witness"}));
    EXPECT_EQ(json["query"], "within");
    EXPECT_EQ(json["max_distance"], 2.5);
    EXPECT_EQ(keys_of(json["witness"]), witness_keys);
    EXPECT_LE(length(point_of(json["witness"]["point_a"]) - point_of(json["witness"]["point_b"])), 2.5) << engine;
  }
  const std::string text = answer_to(both + " --max-distance 0.5");
  EXPECT_EQ(text.find("within    yes\nmax distance 0.5\npoint a   "), 0U) << text;
}

}  // namespace
}  // namespace limber::program_tests
