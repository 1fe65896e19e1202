// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "run_program.h"

namespace limber::program_tests {
namespace {

TEST(ProgramInfo, CountsWhatAMeshIsMadeOf) {
  const Folder folder;
  // A unit square of two triangles, a copy of one turned over, a third triangle at their common edge, one segment-like
  // triangle apart from all others, a stray vertex. The last vertex repeats the first.
  const std::string file = folder.store("odd.obj",
                                        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 2\n"
                                        "v 5 5 5\nv 6 6 6\nv 7 7 7\nv 100 0 0\nv 0 0 0\n"
                                        "f 1 2 3 4\nf 3 2 10\nf 1 3 5\nf 6 7 8\n");
  const nlohmann::json json = json_of("info " + file);
  EXPECT_EQ(json["query"], "info");
  for (const auto& [key, count] : {std::pair{"vertices", 9},
                                   {"triangles", 5},
                                   {"faces", 4},
                                   {"open_edges", 2 + 2 + 3},
                                   {"non_manifold_edges", 1},
                                   {"degenerate_triangles", 1},
                                   {"duplicate_triangles", 1},
                                   {"unreferenced_vertices", 1}}) {
    EXPECT_EQ(json[key], count) << key;
  }
  EXPECT_EQ(json["extent"]["low"], (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(json["extent"]["high"], (std::vector<double>{7, 7, 7}));
  EXPECT_DOUBLE_EQ(json["extent"]["diagonal"].get<double>(), std::sqrt(147.0));
  EXPECT_EQ(json["closed"], false);
  for (const char* const key : {"nodes", "leaves", "levels"}) EXPECT_EQ(json["tree"][key], 1) << key;
}

TEST(ProgramInfo, TellsOfEachPart) {
  const Folder folder;
  const std::string file = folder.store("parts.obj",
                                        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                        "o lid\nf 1 2 3\no pot\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const nlohmann::json parts = json_of("info " + file)["parts"];
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0]["name"], "lid");
  EXPECT_EQ(parts[0]["extent"]["high"], (std::vector<double>{1, 1, 0}));
  EXPECT_EQ(parts[0]["closed"], false);
  EXPECT_EQ(parts[1]["triangles"], 4);
  EXPECT_EQ(parts[1]["closed"], true);
  EXPECT_NE(answer_to("info " + file).find("  pot: 4 triangles, 0 0 0 to 1 1 1, closed\n"), std::string::npos);
}

TEST(ProgramInfo, TellsNearlyDegenerateFromDegenerate) {
  const Folder folder;
  const std::string file = folder.store("thin.obj",
                                        "v 0 0 0\nv 1 1 0\nv 2 2 0\nv 2 2.0000000000000004 0\n"
                                        "f 1 2 3\nf 1 2 4\nf 1 1 1\n");
  EXPECT_EQ(json_of("info " + file)["degenerate_triangles"], 2);
}

TEST(ProgramInfo, FindsNothingWrongWithBuiltInMeshes) {
  const nlohmann::json json = json_of("info scene:ball");
  for (const auto& [key, count] : {std::pair{"triangles", 1024},
                                   {"vertices", 514},
                                   {"open_edges", 0},
                                   {"non_manifold_edges", 0},
                                   {"degenerate_triangles", 0},
                                   {"duplicate_triangles", 0},
                                   {"unreferenced_vertices", 0}}) {
    EXPECT_EQ(json[key], count) << key;
  }
  EXPECT_EQ(json["closed"], true);
  EXPECT_EQ(json["tree"]["levels"], 4);
  EXPECT_EQ(json["tree"]["nodes"], 128 + 16 + 2 + 1);
  EXPECT_EQ(json["tree"]["leaves"], 128);
  EXPECT_DOUBLE_EQ(json["tree"]["bytes_per_triangle"].get<double>(), json["tree"]["bytes"].get<double>() / 1024);
  const std::string text = answer_to("info scene:sheet");
  for (const char* line : {"vertices               10201\n", "triangles              20000\n",
                           "open edges             400\n", " of them leaves\n", "extent high            100 100 0\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
}

}  // namespace
}  // namespace limber::program_tests
