// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <utility>

#include "contact_meshes.h"
#include "formats/scenes.h"

namespace limber::program_tests {
namespace {

/// The field `inside` of a query; where it is not null, there is one line of warning.
nlohmann::json inside_of(const std::string& line) {
  const Outcome outcome = run(line + " --json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(lines_of(outcome.err).size(), json["inside"].is_null() ? 0U : 1U) << outcome.err;
  return json["inside"];
}

nlohmann::json inside(const std::string& a, const std::string& b, const std::string& pose_b = "0,0,0,1,0,0,0") {
  return inside_of("distance " + a + ' ' + b + " --pose-b " + pose_b);
}

TEST(ProgramInside, IsToldByEveryVerb) {
  const Folder folder;
  const std::string shell = Parts().add_ball(5).stored(folder, "shell.obj");
  const std::string in_shell = " scene:ball " + shell, around_ball = ' ' + shell + " scene:ball";
  for (const std::string verb : {"distance", "collide", "within --max-distance 0.01", "within --max-distance 7"}) {
    EXPECT_EQ(inside_of(verb + around_ball + " --pose-b 3,0,0,1,2,3,4"), "b_inside_a");
    EXPECT_EQ(inside_of(verb + in_shell + " --pose-a 3,0,0,1,2,3,4"), "a_inside_b");
    EXPECT_TRUE(inside_of(verb + around_ball + " --pose-b 10,0,0,1,0,0,0").is_null());  // apart
    EXPECT_TRUE(inside_of(verb + around_ball + " --pose-b 3,3,0,1,0,0,0").is_null());   // touching
  }
  const Outcome outcome = run("collide" + around_ball);
  EXPECT_EQ(
      outcome.err,
      "limber: collide: warning: B lies inside A without touching it; models are surfaces, not solids, so they do "
      "not collide\n");
  EXPECT_EQ(outcome.out.find("collision no\n"), 0U) << outcome.out;
}

TEST(ProgramInside, BoxesAreNotEnough) {
  const Folder folder;
  const std::string shell = Parts().add_ball(5).stored(folder, "shell.obj");
  const std::string seed = Parts().add_ball(0.1).stored(folder, "seed.obj");
  EXPECT_EQ(inside(shell, seed, "3,3,0,1,0,0,0"), "b_inside_a");
  EXPECT_TRUE(inside(shell, seed, "4.5,4.5,0,1,0,0,0").is_null());  // in a corner of the box
  // Nor is the box enough when both are turned and far away.
  const std::string far = "distance " + shell + ' ' + seed + " --pose-a 1000,0,0,1,1,0.5,0 --pose-b ";
  EXPECT_EQ(inside_of(far + "1003,3,0,1,0,0,0"), "b_inside_a");
  EXPECT_TRUE(inside_of(far + "1005,5,5,1,0,0,0").is_null());
}

TEST(ProgramInside, OnlyClosedMeshesHaveAnInside) {
  const Folder folder;
  Parts shell = Parts().add_ball(5);
  for (std::size_t t = 0; t < shell.triangles.size(); t += 3) std::swap(shell.triangles[t][0], shell.triangles[t][1]);
  EXPECT_EQ(inside(shell.stored(folder, "turned_over.obj"), "scene:ball"), "b_inside_a");
  Parts open = shell;
  open.triangles.pop_back();
  EXPECT_TRUE(inside(open.stored(folder, "open.obj"), "scene:ball").is_null());
  Parts fin = shell;
  fin.positions.push_back({9, 9, 9});
  fin.triangles.push_back(
      {shell.triangles[0][0], shell.triangles[0][1], static_cast<VertexId>(shell.positions.size())});
  EXPECT_TRUE(inside(fin.stored(folder, "fin.obj"), "scene:ball").is_null());
  // A tetrahedron that shares an edge with the shell leaves no edge open, but four triangles at one.
  Parts tent = shell;
  const VertexId u = shell.triangles[0][0], v = shell.triangles[0][1];
  const auto p = static_cast<VertexId>(shell.positions.size()), q = p + 1;
  tent.positions.insert(tent.positions.end(), {{9, 9, 9}, {9, 9, 8}});
  tent.triangles.insert(tent.triangles.end(), {{u, v, p}, {u, v, q}, {u, p, q}, {v, p, q}});
  EXPECT_TRUE(inside(tent.stored(folder, "tent.obj"), "scene:ball").is_null());
  // What lies inside may be open.
  const std::string speck = folder.store("speck.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(inside(shell.stored(folder, "shell.obj"), speck), "b_inside_a");
}

TEST(ProgramInside, CavitiesAndPartsCount) {
  const Folder folder;
  const std::string seed = Parts().add_ball(0.1).stored(folder, "seed.obj");
  Parts hollow = Parts().add_ball(5).add_ball(3);
  const std::string twice = hollow.stored(folder, "twice.obj");  // both balls have their inside
  for (const std::string verb : {"distance ", "collide "})
    EXPECT_EQ(inside_of(verb + twice + ' ' + seed), "b_inside_a");
  hollow.turn(hollow.triangles.size() / 2);
  const auto expect_cavity = [&](const std::string& file) {
    EXPECT_EQ(inside(file, seed, "4,0,0,1,0,0,0"), "b_inside_a");
    EXPECT_TRUE(inside(file, seed).is_null());
  };
  expect_cavity(hollow.stored(folder, "hollow.obj"));
  std::swap(hollow.triangles[0][0], hollow.triangles[0][1]);  // no orientation: what is crossed an odd number of times
  expect_cavity(hollow.stored(folder, "turned_over.obj"));
  const std::string shell = Parts().add_ball(5).stored(folder, "shell.obj");
  const std::string both = Parts().add_ball(0.1, {1, 0, 0}).add_ball(0.1, {0, 3, 0}).stored(folder, "both.obj");
  const std::string one = Parts().add_ball(0.1, {1, 0, 0}).add_ball(0.1, {4.5, 4.5, 0}).stored(folder, "one.obj");
  EXPECT_EQ(inside(shell, both), "b_inside_a");
  EXPECT_TRUE(inside(shell, one).is_null());
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
