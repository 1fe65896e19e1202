// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Tests of `limber distance`: the kind of clash of a pair, and which model lies inside the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <tuple>
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
    const nlohmann::json json = json_lines_of(run("distance --json " + line)).at(0);
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

/// The field `inside` of a query, or "none"; where there is one, there is one line of warning.
std::string inside_of(const std::string& line) {
  const Outcome outcome = run(line + " --json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(lines_of(outcome.err).size(), json["inside"].is_null() ? 0U : 1U) << outcome.err;
  return json["inside"].is_null() ? "none" : json["inside"].get<std::string>();
}

TEST(ProgramInside, IsToldByEveryVerb) {
  const Folder folder;
  const std::string shell = Parts().add_ball(5).stored(folder, "shell.obj");
  const std::string in_shell = " scene:ball " + shell, around_ball = ' ' + shell + " scene:ball";
  for (const std::string verb :
       {"distance", "collide", "within --max-distance 0.01", "within --max-distance 7", "contacts --margin 0.01"}) {
    EXPECT_EQ(inside_of(verb + around_ball + " --pose-b 3,0,0,1,2,3,4"), "b_inside_a");
    EXPECT_EQ(inside_of(verb + in_shell + " --pose-a 3,0,0,1,2,3,4"), "a_inside_b");
    EXPECT_EQ(inside_of(verb + around_ball + " --pose-b 10,0,0,1,0,0,0"), "none");  // apart
    EXPECT_EQ(inside_of(verb + around_ball + " --pose-b 3,3,0,1,0,0,0"), "none");   // touching
  }
  const Outcome outcome = run("collide" + around_ball);
  EXPECT_EQ(
      outcome.err,
      "limber: collide: warning: B lies inside A without touching it; models are surfaces, not solids, so they do "
      "not collide\n");
  EXPECT_EQ(outcome.out.find("collision no\n"), 0U) << outcome.out;
}

TEST(ProgramInside, IsOfClosedSurfacesAndAllPartsOfWhatIsInside) {
  const Folder folder;
  const Parts shell = Parts().add_ball(5), hollow = Parts().add_ball(5).add_ball(3);
  Parts open = shell, fin = shell;
  open.triangles.pop_back();
  fin.positions.push_back({9, 9, 9});
  fin.triangles.push_back(
      {shell.triangles[0][0], shell.triangles[0][1], static_cast<VertexId>(shell.positions.size())});
  Parts cavity = hollow;
  cavity.turn(hollow.triangles.size() / 2);
  const auto kept = [&](const std::string& name, const Parts& parts) { return ' ' + parts.stored(folder, name); };
  const auto seeds = [&](const std::string& name, const Vec3& second) {
    Parts both = Parts().add_ball(0.1, {1, 0, 0}).add_ball(0.1, second);
    both.triangles.pop_back();  // what lies inside may be open
    return kept(name, both);
  };
  const std::string of_shell = kept("shell.obj", shell), seed = kept("seed.obj", Parts().add_ball(0.1));
  const std::string far = of_shell + seed + " --pose-a 1000,0,0,1,1,0.5,0", ball = " scene:ball";
  for (const auto& [line, pose_b, inside] : std::vector<std::tuple<std::string, std::string, std::string>>{
           {of_shell + seed, "3,3,0", "b_inside_a"},
           {of_shell + seed, "4.5,4.5,0", "none"},  // in a corner of the box
           {far, "1003,3,0", "b_inside_a"},
           {far, "1005,5,5", "none"},
           {kept("open.obj", open) + ball, "0,0,0", "none"},
           {kept("fin.obj", fin) + ball, "0,0,0", "none"},
           {kept("twice.obj", hollow) + seed, "0,0,0", "b_inside_a"},  // both balls have their inside
           {kept("cavity.obj", cavity) + seed, "4,0,0", "b_inside_a"},
           {kept("cavity.obj", cavity) + seed, "0,0,0", "none"},
           {of_shell + seeds("both.obj", {0, 3, 0}), "0,0,0", "b_inside_a"},
           {of_shell + seeds("one.obj", {4.5, 4.5, 0}), "0,0,0", "none"}}) {
    EXPECT_EQ(inside_of("distance" + line + " --pose-b " + pose_b + ",1,0,0,0"), inside) << line << ' ' << pose_b;
  }
}

TEST(ProgramInside, RowsOfPairsTellItInAColumnAndOneWarning) {
  const Folder folder;
  const std::string shell = Parts().add_ball(5).stored(folder, "shell.obj");
  const std::string rows = shell + ",scene:ball,0\n" + "scene:ball," + shell + ",0\n" + shell + ",scene:ball,9\n";
  const Outcome outcome = run("distance --pairs " + folder.store("pairs.csv", "model_a,model_b,pose_b_tx\n" + rows));
  EXPECT_EQ(outcome.err,
            "limber: distance: warning: in 2 rows a model lies inside the other without touching it; models are "
            "surfaces, not solids (column inside)\n");
  const std::vector<Row> table = table_of(outcome.out);
  ASSERT_EQ(table.size(), 3U);
  EXPECT_EQ(table[0].at("inside"), "b_inside_a");
  EXPECT_EQ(table[1].at("inside"), "a_inside_b");
  EXPECT_EQ(table[2].at("inside"), "");
}

}  // namespace
}  // namespace limber::program_tests
