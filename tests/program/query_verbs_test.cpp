// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>

#include "program/run_program.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/real_meshes.h"

namespace limber::program_tests {
namespace {

using Keys = std::vector<std::string>;

Keys keys_of(const nlohmann::json& json) {
  Keys keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;  // in alphabetical order
}

const Keys witness_keys = {"face_a", "face_b", "point_a", "point_b", "triangle_a", "triangle_b"};

/// Two soups that stay clear of each other when the second is moved by the pose.
struct SoupFiles {
  Folder folder;
  Mesh a, b;
  std::string path_a, path_b;

  explicit SoupFiles(std::uint64_t seed) : SoupFiles(scenes::Rng(seed)) {}

 private:
  explicit SoupFiles(scenes::Rng rng)
      : a(scenes::random_soup(rng, 60, 0.4)),
        b(scenes::random_soup(rng, 50, 0.4)),
        path_a(folder.store("a.obj", a)),
        path_b(folder.store("b.obj", b)) {}
};

TEST(ProgramDistance, PrintsExactlyTheDocumentedKeys) {
  const nlohmann::json json = json_of(run({"distance", "scene:ball", "scene:square", "--json"}));
  EXPECT_EQ(keys_of(json), (Keys{"build_us", "inside", "lower", "node_tests", "query", "query_us", "status",
                                 "too_close", "triangle_tests", "upper", "witness"}));
  EXPECT_EQ(keys_of(json["witness"]), witness_keys);
  EXPECT_EQ(json["query"], "distance");
  EXPECT_GE(json["build_us"].get<double>(), 0);
  EXPECT_GT(json["query_us"].get<double>(), 0);
}

TEST(ProgramDistance, AnswersAreThoseOfTheLibraryToTheLastBit) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    const SoupFiles soups(seed);
    const Transform pose = transform_from_quaternion({2.1, 0.3, -0.7}, 0.3, -0.4, 0.5, 0.6).value();
    const DistanceResult expected = reference::distance({soups.a}, {soups.b, pose});
    const nlohmann::json json = json_of(run({"distance", soups.path_a, soups.path_b, "--json", "--engine", "reference",
                                             "--pose-b", "2.1,0.3,-0.7,0.3,-0.4,0.5,0.6"}));
    EXPECT_EQ(json["upper"].get<double>(), expected.upper);
    EXPECT_EQ(json["lower"].get<double>(), expected.lower);
    const nlohmann::json& witness = json["witness"];
    EXPECT_EQ(point_of(witness["point_a"]), expected.witness->point_a);
    EXPECT_EQ(point_of(witness["point_b"]), expected.witness->point_b);
    EXPECT_EQ(witness["triangle_a"], expected.witness->triangle_a);
    EXPECT_EQ(witness["triangle_b"], expected.witness->triangle_b);
  }
}

TEST(ProgramDistance, AllEnginesGiveTheSameDistance) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    const SoupFiles soups(seed);
    for (const std::string pose : {"0,0,0,1,0,0,0", "2,0,0,1,1,0,0", "-3,4,1,0,0,2,1"}) {
      const auto ask = [&](const std::string& engine) {
        return json_of(run({"distance", soups.path_a, soups.path_b, "--json", "--pose-a", pose, "--engine", engine}));
      };
      const nlohmann::json reference = ask("reference");
      for (const char* engine : {"fast", "classic"}) {
        const nlohmann::json found = ask(engine);
        EXPECT_EQ(found["lower"], found["upper"]) << engine;
        EXPECT_NEAR(found["upper"].get<double>(), reference["upper"].get<double>(), 1e-14) << engine;
        EXPECT_EQ(found["status"], reference["status"]) << engine;
      }
    }
  }
}

TEST(ProgramDistance, LimitIsHeldByAllEngines) {
  const Folder folder;
  const std::string square = folder.store("square.obj", scenes::grid(2, 2, -2, -2, 2, 2));
  for (const std::string engine : {"fast", "classic", "reference"}) {
    const auto ask = [&](const std::string& option, const std::string& value) {
      return run({"distance", "scene:ball", square, "--pose-a", "0,0,3,1,0,0,0", "--engine", engine, option, value});
    };
    const Outcome beyond = ask("--max-distance", "1.5");
    EXPECT_NE(beyond.out.find("status    beyond_limit\nlower     1.5\ntests"), std::string::npos) << beyond.out;
    EXPECT_NE(ask("--max-distance", "2.5").out.find("status    exact"), std::string::npos) << engine;
    EXPECT_NE(ask("--max-distance", "inf").out.find("status    exact"), std::string::npos) << engine;
    EXPECT_EQ(ask("--absolute-error", "0.5").exit_code, 0) << engine;
  }
  const nlohmann::json json = json_of(
      run({"distance", "scene:ball", "scene:square", "--pose-a", "0,0,3,1,0,0,0", "--max-distance", "1.5", "--json"}));
  EXPECT_EQ(json["status"], "beyond_limit");
  EXPECT_EQ(json["lower"], 1.5);
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
  const SoupFiles soups(9);
  const Outcome outcome = run({"distance", soups.path_a, soups.path_b, "--json", "--pose-b", "2.5,0.1,0.2,1,2,3,4"});
  const nlohmann::json json = json_of(outcome);
  EXPECT_NE(outcome.out.find("\"upper\": " + shortest(json["upper"].get<double>()) + ","), std::string::npos)
      << outcome.out;
  for (const double coordinate : json["witness"]["point_b"].get<std::vector<double>>()) {
    EXPECT_NE(outcome.out.find(shortest(coordinate)), std::string::npos) << coordinate << " in " << outcome.out;
  }
  const std::vector<std::string> question = {"distance",      "scene:ball",     "scene:square", "--pose-a",
                                             "0,0,9,1,0,0,0", "--max-distance", "0.032987"};
  EXPECT_NE(run(question).out.find("lower     0.032987\n"), std::string::npos);
}

TEST(ProgramDistance, TextAndJsonSayTheSameNumber) {
  const std::vector<std::string> question = {"distance", "scene:soup:1", "scene:soup:2", "--pose-b", "3,0,0,1,2,3,4"};
  std::vector<std::string> with_json = question;
  with_json.push_back("--json");
  const Outcome text = run(question);
  ASSERT_EQ(text.exit_code, 0) << text.err;
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text.out, found, std::regex("upper +(\\S+)"))) << text.out;
  EXPECT_EQ(std::strtod(found[1].str().c_str(), nullptr), json_of(run(with_json))["upper"].get<double>());
}

TEST(ProgramDistance, WitnessesAreInTheWorldFrame) {
  const nlohmann::json json = json_of(run({"distance", "scene:ball", "scene:square", "--json", "--pose-a",
                                           "100,0,12.5,1,0,0,0", "--pose-b", "100,0,10,1,0,0,0"}));
  EXPECT_EQ(json["status"], "exact");
  EXPECT_DOUBLE_EQ(json["upper"].get<double>(), 1.5);
  EXPECT_EQ(point_of(json["witness"]["point_a"]), (Vec3{100, 0, 11.5}));
  EXPECT_EQ(point_of(json["witness"]["point_b"]), (Vec3{100, 0, 10}));
}

TEST(ProgramDistance, QuaternionsMayHaveAnyLength) {
  const auto upper = [](const std::string& pose) {
    return json_of(run({"distance", "scene:square", "scene:ball", "--json", "--pose-a", pose}))["upper"].get<double>();
  };
  // A quarter turn about x makes the square upright, 3 units from the center of the ball.
  EXPECT_NEAR(upper("0,3,0,1,1,0,0"), 2, 0.02);
  EXPECT_EQ(upper("0,3,0,1,1,0,0"), upper("0,3,0,1e-200,1e-200,0,0"));
  EXPECT_EQ(upper("0,3,0,1,1,0,0"), upper(" 0, +3, 0,\t-8e100,-8e100,0,0"));
}

TEST(ProgramDistance, ErrorsWidenTheIntervalAndKeepItTrue) {
  const std::vector<std::string> question = {"distance", "scene:ball",        "scene:square",
                                             "--pose-a", "0.1,0.2,4,1,0,0,0", "--json"};
  const auto exact = json_of(run(question))["upper"].get<double>();
  for (const std::string error : {"0.01", "0.1", "1", "10", "1e300"}) {
    std::vector<std::string> rough = question;
    rough.insert(rough.end(), {"--relative-error", error});
    const nlohmann::json json = json_of(run(rough));
    EXPECT_LE(json["lower"].get<double>(), exact);
    EXPECT_GE(json["upper"].get<double>(), exact);
    EXPECT_LE(json["upper"].get<double>(), exact * (1 + std::strtod(error.c_str(), nullptr)) * (1 + 1e-12));
    EXPECT_EQ(json["status"], json["lower"] == json["upper"] ? "exact" : "within_error");
  }
}

TEST(ProgramDistance, FacesAreThoseOfTheFile) {
  const Folder folder;
  // A strip of three quads along x; the second triangle of the last quad is nearest to a point-like triangle beyond it.
  const std::string strip = folder.store("strip.obj",
                                         "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 3 1 0\n"
                                         "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n");
  const std::string far = folder.store("far.obj", "v 2.5 2 0\nf 1 1 1\n");
  const nlohmann::json json = json_of(run({"distance", strip, far, "--json"}));
  EXPECT_EQ(json["upper"], 1);
  EXPECT_EQ(json["witness"]["triangle_a"], 5);
  EXPECT_EQ(json["witness"]["face_a"], 2);
  EXPECT_EQ(json["witness"]["face_b"], 0);
}

TEST(ProgramDistance, ReadsRealMeshes) {
  const std::string spot = testing::real_mesh("spot.obj").string();
  if (!std::filesystem::exists(spot)) GTEST_SKIP() << "no data";
  const nlohmann::json json = json_of(run({"distance", spot, spot, "--pose-b", "3,0,0,1,0,0,0", "--json"}));
  EXPECT_EQ(json["status"], "exact");
  EXPECT_GT(json["upper"].get<double>(), 2);
  EXPECT_LT(json["upper"].get<double>(), 3);
}

TEST(ProgramCollide, SaysYesWithAPointOnBoth) {
  const nlohmann::json json = json_of(run(
      {"collide", "scene:ball", "scene:square", "--json", "--pose-a", "0,0,5,1,0,0,0", "--pose-b", "0,0,4.5,1,0,0,0"}));
  EXPECT_EQ(keys_of(json),
            (Keys{"build_us", "collision", "inside", "node_tests", "query", "query_us", "triangle_tests", "witness"}));
  EXPECT_EQ(json["query"], "collide");
  EXPECT_EQ(json["collision"], true);
  EXPECT_EQ(keys_of(json["witness"]), witness_keys);
  EXPECT_NEAR(point_of(json["witness"]["point_a"]).z, 4.5, 1e-12);
  EXPECT_EQ(json["witness"]["point_a"], json["witness"]["point_b"]);
}

TEST(ProgramCollide, SaysNoWithoutAWitness) {
  const nlohmann::json json =
      json_of(run({"collide", "scene:ball", "scene:square", "--json", "--pose-a", "0,0,1.001,1,0,0,0"}));
  EXPECT_EQ(json["collision"], false);
  EXPECT_TRUE(json["witness"].is_null());
  const Outcome text = run({"collide", "scene:ball", "scene:square", "--pose-a", "0,0,1.001,1,0,0,0"});
  EXPECT_EQ(text.out.find("collision no"), 0U) << text.out;
}

TEST(ProgramCollide, TouchingIsMeeting) {
  EXPECT_EQ(json_of(run({"collide", "scene:ball", "scene:square", "--json", "--pose-a", "0,0,1,1,0,0,0"}))["collision"],
            true);
}

TEST(ProgramCollide, AllEnginesAgreeWithTheDistance) {
  for (int seed = 1; seed <= 6; ++seed) {
    const std::string a = "scene:lattice:" + std::to_string(seed), b = "scene:lattice:" + std::to_string(seed + 100);
    for (const std::string pose : {"0,0,0,1,0,0,0", "3,0,0,1,0,0,0", "4,4,0,1,0,0,0"}) {
      SCOPED_TRACE(a + " " + pose);
      const auto ask = [&](const std::string& verb, const std::string& engine) {
        return json_of(run({verb, a, b, "--pose-b", pose, "--engine", engine, "--json"}));
      };
      const nlohmann::json truth = ask("collide", "reference");
      for (const char* engine : {"fast", "classic"}) {
        EXPECT_EQ(ask("collide", engine)["collision"], truth["collision"]) << engine;
        EXPECT_EQ(truth["collision"].get<bool>(), ask("distance", engine)["status"] == "collision") << engine;
      }
    }
  }
}

TEST(ProgramWithin, IsClosedAndTheSameForAllEngines) {
  const Folder folder;
  const std::string ball = folder.store("ball.obj", scenes::ball(8, 6).view());
  const std::string square = folder.store("square.obj", scenes::grid(2, 2, -4, -4, 4, 4).view());
  for (const std::string engine : {"fast", "classic", "reference"}) {
    const auto ask = [&](const std::string& limit) {
      return json_of(run({"within", ball, square, "--pose-a", "0,0,3,1,0,0,0", "--engine", engine, "--max-distance",
                          limit, "--json"}));
    };
    EXPECT_EQ(ask("1.9999")["within"], false) << engine;
    EXPECT_TRUE(ask("1.9999")["witness"].is_null()) << engine;
    EXPECT_EQ(ask("2")["within"], true) << engine;
    const nlohmann::json json = ask("2.5");
    EXPECT_EQ(keys_of(json), (Keys{"build_us", "inside", "max_distance", "node_tests", "query", "query_us",
                                   "triangle_tests", "within", "witness"}));
    EXPECT_EQ(json["query"], "within");
    EXPECT_EQ(json["max_distance"], 2.5);
    EXPECT_EQ(keys_of(json["witness"]), witness_keys);
    const Vec3 gap = point_of(json["witness"]["point_a"]) - point_of(json["witness"]["point_b"]);
    EXPECT_LE(length(gap), 2.5) << engine;
  }
  const Outcome text = run({"within", ball, square, "--max-distance", "0.5"});
  EXPECT_EQ(text.out.find("within    yes\nlimit     0.5\npoint a   "), 0U) << text.out;
}

TEST(ProgramWithin, AgreesWithTheDistance) {
  const SoupFiles soups(11);
  for (const std::string pose : {"0,0,0,1,0,0,0", "2,0,0,1,1,0,0", "-3,4,1,0,0,2,1"}) {
    const std::string upper =
        json_of(run({"distance", soups.path_a, soups.path_b, "--pose-a", pose, "--json"}))["upper"].dump();
    const auto is_within = [&](const std::string& limit) {
      return json_of(run({"within", soups.path_a, soups.path_b, "--pose-a", pose, "--json", "--max-distance", limit}));
    };
    EXPECT_EQ(is_within(upper)["within"], true) << pose;
    if (upper == "0" || upper == "0.0") continue;
    EXPECT_EQ(is_within(std::to_string(0.99 * std::strtod(upper.c_str(), nullptr)))["within"], false) << pose;
  }
}

}  // namespace
}  // namespace limber::program_tests
