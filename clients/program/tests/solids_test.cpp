// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// `limber collide --solids`: how the volumes of two models lie to each other.
#include <gtest/gtest.h>

#include <string>

#include "run_program.h"

namespace limber::program_tests {
namespace {

// A ball of diameter 2 around its own origin.
const std::string two_balls = "collide scene:ball scene:ball --solids --pose-b ";

TEST(Solids, SayHowVolumesLie) {
  EXPECT_EQ(json_of(two_balls + "5,0,0,1,0,0,0")["solids"], "apart");
  EXPECT_EQ(json_of(two_balls + "0.5,0,0,1,0,0,0")["solids"], "overlapping");
  EXPECT_EQ(json_of(two_balls + "0,0,0,1,0,0,0")["solids"], "equal");
  EXPECT_NE(answer_to(two_balls + "0,0,0,1,0,0,0").find("\nsolids    equal\n"), std::string::npos);
  EXPECT_FALSE(json_of("collide scene:ball scene:ball").contains("solids"));
}

TEST(Solids, NeedClosedModelsOfAnyEngine) {
  expect_refused("collide scene:ball scene:square --solids", "--solids: scene:square: the surface is not closed");
  for (const std::string engine : {"classic", "reference"}) {
    EXPECT_EQ(json_of(two_balls + "0.5,0,0,1,0,0,0 --engine " + engine)["solids"], "overlapping");
  }
}

}  // namespace
}  // namespace limber::program_tests
