// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "contact_meshes.h"
#include "formats/scenes.h"

namespace limber::program_tests {
namespace {

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
  for (const std::string verb : {"distance", "collide", "within --max-distance 0.01", "within --max-distance 7"}) {
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
  const auto stored = [&](const std::string& name, const Parts& parts) { return ' ' + parts.stored(folder, name); };
  const auto seeds = [&](const std::string& name, const Vec3& second) {
    Parts both = Parts().add_ball(0.1, {1, 0, 0}).add_ball(0.1, second);
    both.triangles.pop_back();  // what lies inside may be open
    return stored(name, both);
  };
  const std::string of_shell = stored("shell.obj", shell), seed = stored("seed.obj", Parts().add_ball(0.1));
  const std::string far = of_shell + seed + " --pose-a 1000,0,0,1,1,0.5,0", ball = " scene:ball";
  for (const auto& [line, pose_b, inside] : std::vector<std::tuple<std::string, std::string, std::string>>{
           {of_shell + seed, "3,3,0", "b_inside_a"},
           {of_shell + seed, "4.5,4.5,0", "none"},  // in a corner of the box
           {far, "1003,3,0", "b_inside_a"},
           {far, "1005,5,5", "none"},
           {stored("open.obj", open) + ball, "0,0,0", "none"},
           {stored("fin.obj", fin) + ball, "0,0,0", "none"},
           {stored("twice.obj", hollow) + seed, "0,0,0", "b_inside_a"},  // both balls have their inside
           {stored("cavity.obj", cavity) + seed, "4,0,0", "b_inside_a"},
           {stored("cavity.obj", cavity) + seed, "0,0,0", "none"},
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
