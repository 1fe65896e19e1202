// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What kind of clash a pair is, as `limber distance` says it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "contact_meshes.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

struct LatticeBox {
  std::array<int, 3> low{}, high{};
};

Vec3 point_at(const std::array<int, 3>& corner) {
  return {static_cast<double>(corner[0]), static_cast<double>(corner[1]), static_cast<double>(corner[2])};
}

std::string stored(const Folder& folder, const std::string& name, const LatticeBox& box) {
  return Parts().add_box(point_at(box.low), point_at(box.high)).stored(folder, name);
}

/// The words for two boxes, by their intervals on each axis.
struct Expected {
  std::string clash, solids;
};

Expected expected_of(const LatticeBox& a, const LatticeBox& b, double clearance) {
  double gap_sq = 0;
  bool overlap = true, a_in_b = true, b_in_a = true, apart = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int gap = std::max(a.low[axis] - b.high[axis], b.low[axis] - a.high[axis]);
    gap_sq += gap > 0 ? gap * gap : 0;
    apart = apart || gap > 0;
    overlap = overlap && gap < 0;
    a_in_b = a_in_b && b.low[axis] <= a.low[axis] && a.high[axis] <= b.high[axis];
    b_in_a = b_in_a && a.low[axis] <= b.low[axis] && b.high[axis] <= a.high[axis];
  }
  if (apart) return {std::sqrt(gap_sq) < clearance ? "clearance" : "clear", "apart"};
  if (!overlap) return {"touching", "touching"};
  return {"hard_clash", a_in_b && b_in_a ? "equal" : a_in_b ? "a_inside_b" : b_in_a ? "b_inside_a" : "overlapping"};
}

TEST(ProgramClash, OfBoxesOnALatticeIsThatOfTheirIntervals) {
  const Folder folder;
  std::mt19937 random(5);
  std::vector<LatticeBox> boxes = {{{0, 0, 0}, {4, 4, 4}}, {{1, 1, 1}, {3, 3, 3}}, {{0, 0, 0}, {4, 4, 4}},
                                   {{4, 1, 1}, {6, 3, 3}}, {{0, 0, 4}, {4, 4, 5}}, {{0, 0, 0}, {2, 4, 4}}};
  for (int i = 0; i < 14; ++i) {
    LatticeBox& box = boxes.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = static_cast<int>(random() % 6);
      box.high[axis] = box.low[axis] + 1 + static_cast<int>(random() % 3);
    }
  }
  std::string pairs = "model_a,model_b\n";
  for (std::size_t i = 0; i < boxes.size(); ++i) stored(folder, std::to_string(i) + ".obj", boxes[i]);
  const auto file = [&](std::size_t i) { return folder.path(std::to_string(i) + ".obj"); };
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = 0; j < boxes.size(); ++j) pairs += file(i) + ',' + file(j) + '\n';
  }
  const std::vector<Row> rows =
      table_of(run("distance --min-clearance 1.5 --pairs " + folder.store("pairs.csv", pairs)).out);
  ASSERT_EQ(rows.size(), boxes.size() * boxes.size());
  std::map<std::string, int> counts;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Expected expected = expected_of(boxes[r / boxes.size()], boxes[r % boxes.size()], 1.5);
    EXPECT_EQ(rows[r].at("clash"), expected.clash) << r;
    EXPECT_EQ(rows[r].at("solids"), expected.solids) << r;
    EXPECT_EQ(rows[r].at("too_close"), expected.clash == "clear" ? "false" : "true") << r;
    ++counts[expected.clash + ' ' + expected.solids];
  }
  EXPECT_EQ(counts.size(), 7U);
}

TEST(ProgramClash, NamesTheModelThatIsEnclosed) {
  const Folder folder;
  const std::string wall = stored(folder, "wall.obj", {{0, 0, 0}, {4, 1, 3}});
  const std::string pipe = stored(folder, "pipe.obj", {{0, 0, 0}, {1, 1, 1}});
  const std::string both = wall + ' ' + pipe;
  for (const auto& [question, clash] : std::vector<std::pair<std::string, std::string>>{
           {both + " --pose-b 1,0,1,1,0,0,0", "hard clash: B is enclosed in A"},
           {pipe + ' ' + wall + " --pose-a 1,0,1,1,0,0,0", "hard clash: A is enclosed in B"},
           {both + " --pose-b 1,-0.5,1,1,0,0,0", "hard clash"},
           {wall + ' ' + wall, "hard clash: both volumes are equal"},
           {both + " --pose-b 1,1,1,1,0,0,0", "touching"},
           {both + " --pose-b 1,2,1,1,0,0,0", "clear"},
           {both + " --pose-b 1,2,1,1,0,0,0 --min-clearance 1.25", "clearance"}}) {
    EXPECT_NE(run("distance " + question).out.find("\nclash     " + clash + '\n'), std::string::npos) << question;
  }
}

TEST(ProgramClash, PartsInCavitiesAreClear) {
  const Folder folder;
  const Parts hollow = Parts().add_box({0, 0, 0}, {9, 9, 9}).add_box({2, 2, 2}, {7, 7, 7}).turn(12);
  const std::string start = "distance " + hollow.stored(folder, "hollow.obj") + ' ' +
                            stored(folder, "part.obj", {{0, 0, 0}, {1, 1, 1}}) + " --pose-b ";
  for (const auto& [x, clash, solids, depth] : {std::tuple{"4", "clear", "apart", 0.0},
                                                {"2", "touching", "touching", 0.0},
                                                {"1", "hard_clash", "b_inside_a", 1.0},
                                                {"1.5", "hard_clash", "overlapping", 0.5}}) {
    const nlohmann::json json = json_of(start + x + ",4,4,1,0,0,0");
    EXPECT_EQ(json["clash"], clash);
    EXPECT_EQ(json["solids"], solids);
    EXPECT_EQ(json["depth"], depth > 0 ? nlohmann::json(depth) : nlohmann::json());
  }
  EXPECT_NE(answer_to(start + "1.5,4,4,1,0,0,0").find("\nclash     hard clash\ndepth     at least 0.5\n"),
            std::string::npos);
}

TEST(ProgramClash, IsWhatSurfacesTellWhereAModelIsOpen) {
  const Folder folder;
  const std::string box = stored(folder, "box.obj", {{0, 0, 0}, {9, 9, 9}});
  Parts open = Parts().add_box({0, 0, 0}, {2, 2, 2});
  open.triangles.pop_back();
  const std::string bowl = open.stored(folder, "bowl.obj");
  const auto clash = [&](const std::string& line) {
    const nlohmann::json json = object_of("distance " + line);
    EXPECT_TRUE(json["solids"].is_null());
    return json["clash"].get<std::string>();
  };
  EXPECT_EQ(clash(box + ' ' + bowl), "surfaces_meet");
  EXPECT_EQ(clash(box + ' ' + bowl + " --pose-b 11,0,0,1,0,0,0"), "surfaces_apart");
  EXPECT_EQ(clash(box + ' ' + bowl + " --pose-b 11,0,0,1,0,0,0 --min-clearance 3"), "clearance");
  EXPECT_EQ(clash(box + ' ' + bowl + " --pose-b 3,3,3,1,0,0,0"), "hard_clash");  // a box has it inside
  EXPECT_EQ(clash(bowl + ' ' + box + " --pose-a 3,3,3,1,0,0,0 --max-distance 0.1"), "hard_clash");
}

TEST(ProgramClash, HardClashesAreFoundWhereverTheirSurfacesAre) {
  const Folder folder;
  const std::string line = "distance " + stored(folder, "room.obj", {{-9, -9, -9}, {9, 9, 9}}) + " scene:ball ";
  for (const auto& [options, exit_code] : {std::pair{"--min-clearance 0.1", 3},
                                           {"--max-distance 0.1 --exit-code", 3},
                                           {"--max-distance 0.1 --exit-code --pose-b 20,0,0,1,0,0,0", 0},
                                           {"--min-clearance 0.1 --pose-b 20,0,0,1,0,0,0", 0}}) {
    EXPECT_EQ(run(line + options).exit_code, exit_code) << options;
  }
}

}  // namespace
}  // namespace limber::program_tests
