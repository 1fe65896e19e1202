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

#include "page_decoding.h"
#include "run_program.h"

namespace limber::program_tests {
namespace {

struct LatticeBox {
  std::array<int, 3> low{}, high{};
};

/// A mesh that is put together from boxes.
struct Boxes {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;

  /// The faces of a cavity run the other way round.
  Boxes& add(const LatticeBox& box, bool is_cavity = false) {
    const auto first = static_cast<VertexId>(positions.size());
    for (int i = 0; i < 8; ++i) {
      Vec3& p = positions.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = (i >> axis & 1) != 0 ? box.high[axis] : box.low[axis];
    }
    for (Corners c : std::vector<Corners>{{0, 2, 1},
                                          {1, 2, 3},
                                          {0, 1, 4},
                                          {1, 5, 4},
                                          {2, 6, 3},
                                          {3, 6, 7},
                                          {0, 4, 2},
                                          {2, 4, 6},
                                          {1, 3, 5},
                                          {3, 7, 5},
                                          {4, 5, 6},
                                          {5, 7, 6}}) {
      if (is_cavity) std::swap(c[1], c[2]);
      triangles.push_back({c[0] + first, c[1] + first, c[2] + first});
    }
    return *this;
  }
  MeshView view() const { return {positions, triangles}; }
};

std::string stored(const Folder& folder, const std::string& name, const LatticeBox& box) {
  return folder.store(name, Boxes().add(box).view());
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
  for (const std::string engine : {"fast", "classic", "reference"}) {
    const Outcome outcome =
        run("distance --min-clearance 1.5 --engine " + engine + " --pairs " + folder.store("pairs.csv", pairs));
    const std::vector<Row> rows = table_of(outcome.out);
    ASSERT_EQ(rows.size(), boxes.size() * boxes.size());
    std::map<std::string, int> counts;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const Expected expected = expected_of(boxes[r / boxes.size()], boxes[r % boxes.size()], 1.5);
      EXPECT_EQ(rows[r].at("clash"), expected.clash) << engine << ' ' << r;
      EXPECT_EQ(rows[r].at("solids"), expected.solids) << engine << ' ' << r;
      EXPECT_EQ(rows[r].at("too_close"), expected.clash == "clear" ? "false" : "true") << engine << ' ' << r;
      ++counts[expected.clash + ' ' + expected.solids];
    }
    EXPECT_EQ(counts.size(), 7U);
  }
}

TEST(ProgramClash, NamesTheModelThatIsEnclosed) {
  const Folder folder;
  const std::string wall = stored(folder, "wall.obj", {{0, 0, 0}, {4, 1, 3}});
  const std::string pipe = stored(folder, "pipe.obj", {{0, 0, 0}, {1, 1, 1}});
  const auto clash_line = [&](const std::string& line) {
    for (const std::string& found : lines_of(run("distance " + line).out)) {
      if (found.starts_with("clash")) return found;
    }
    return std::string();
  };
  const std::string both = wall + ' ' + pipe;
  EXPECT_EQ(clash_line(both + " --pose-b 1,0,1,1,0,0,0"), "clash     hard clash: B is enclosed in A");
  EXPECT_EQ(clash_line(pipe + ' ' + wall + " --pose-a 1,0,1,1,0,0,0"), "clash     hard clash: A is enclosed in B");
  EXPECT_EQ(clash_line(both + " --pose-b 1,-0.5,1,1,0,0,0"), "clash     hard clash");
  EXPECT_EQ(clash_line(wall + ' ' + wall), "clash     hard clash: both volumes are equal");
  EXPECT_EQ(clash_line(both + " --pose-b 1,1,1,1,0,0,0"), "clash     touching");
  EXPECT_EQ(clash_line(both + " --pose-b 1,2,1,1,0,0,0"), "clash     clear");
  EXPECT_EQ(clash_line(both + " --pose-b 1,2,1,1,0,0,0 --min-clearance 1.25"), "clash     clearance");
}

TEST(ProgramClash, PartsInCavitiesAreClear) {
  const Folder folder;
  const Boxes hollow = Boxes().add({{0, 0, 0}, {9, 9, 9}}).add({{2, 2, 2}, {7, 7, 7}}, true);
  const std::string start = "distance " + folder.store("hollow.obj", hollow.view()) + ' ' +
                            stored(folder, "part.obj", {{0, 0, 0}, {1, 1, 1}}) + " --pose-b ";
  EXPECT_EQ(json_of(start + "4,4,4,1,0,0,0")["clash"], "clear");
  EXPECT_EQ(json_of(start + "2,4,4,1,0,0,0")["clash"], "touching");
  EXPECT_EQ(json_of(start + "1,4,4,1,0,0,0")["solids"], "b_inside_a");
  EXPECT_EQ(json_of(start + "1.5,4,4,1,0,0,0")["solids"], "overlapping");
  EXPECT_EQ(json_of(start + "1,4,4,1,0,0,0")["depth"], 1);
  EXPECT_EQ(json_of(start + "1.5,4,4,1,0,0,0")["depth"], 0.5);
  EXPECT_TRUE(json_of(start + "2,4,4,1,0,0,0")["depth"].is_null());
  EXPECT_NE(answer_to(start + "1.5,4,4,1,0,0,0").find("\nclash     hard clash\ndepth     at least 0.5\n"),
            std::string::npos);
}

TEST(ProgramClash, IsWhatSurfacesTellWhereAModelIsOpen) {
  const Folder folder;
  const std::string box = stored(folder, "box.obj", {{0, 0, 0}, {9, 9, 9}});
  Boxes open = Boxes().add({{0, 0, 0}, {2, 2, 2}});
  open.triangles.pop_back();
  const std::string bowl = folder.store("bowl.obj", open.view());
  const auto clash = [&](const std::string& line) {
    const nlohmann::json json = nlohmann::json::parse(run("distance --json " + line).out);
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
  const std::string room = stored(folder, "room.obj", {{-9, -9, -9}, {9, 9, 9}});
  const std::string line = "distance " + room + " scene:ball ";
  EXPECT_EQ(run(line + "--min-clearance 0.1").exit_code, 3);
  EXPECT_NE(run(line + "--min-clearance 0.1").out.find("\nclearance below 0.1\n"), std::string::npos);
  EXPECT_EQ(run(line + "--max-distance 0.1 --exit-code").exit_code, 3);
  EXPECT_EQ(run(line + "--max-distance 0.1 --exit-code --pose-b 20,0,0,1,0,0,0").exit_code, 0);
  EXPECT_EQ(run(line + "--min-clearance 0.1 --pose-b 20,0,0,1,0,0,0").exit_code, 0);
}

TEST(ProgramClash, IsInTheReportAndNotAskedOfPaths) {
  const Report report("distance scene:ball scene:ball --pose-b 0.5,0,0,1,0,0,0");
  EXPECT_EQ(report.data["rows"]["clash"][0], "hard_clash");
  EXPECT_EQ(report.data["rows"]["solids"][0], "overlapping");
  const Folder folder;
  const std::string path = folder.store("path.csv", "5,0,0,1,0,0,0\n3,0,0,1,0,0,0\n");
  const nlohmann::json json = json_of("distance scene:ball scene:ball --path-a " + path);
  EXPECT_TRUE(json["clash"].is_null());
  EXPECT_TRUE(json["solids"].is_null());
  EXPECT_EQ(run("distance scene:ball scene:ball --path-a " + path).out.find("clash"), std::string::npos);
}

}  // namespace
}  // namespace limber::program_tests
