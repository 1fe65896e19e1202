// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/motions.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace limber::testing {
namespace {

struct Expected {
  scenes::Motion motion;
  std::uint64_t start, later;  // hashes of frames 0 and 100
};

std::uint64_t hash_at(const scenes::Motion& motion, double frame) {
  const std::vector<Vec3> positions = motion.positions(frame);
  return scenes::hash(MeshView{positions, motion.mesh.triangles()});
}

TEST(Motions, AreTheSameToTheBitOnEveryMachine) {
  const Expected all[] = {
      {scenes::waving_sheet(20, 10), 0x626562b68b91e032, 0xc33d5be7d6bcdcbb},
      {scenes::twisting_bar(5), 0xd1ff959ad5fcda7c, 0x3346af4acc6148a5},
      {scenes::crumpling_cloth(20), 0x3ab486cb921808d4, 0x3391a57572677942},
      {scenes::shuffled_soup(100), 0xa0eec1773746da06, 0x2ea4d064bbd7e30d},
  };
  for (const Expected& e : all) {
    EXPECT_EQ(hash_at(e.motion, 0), e.start) << e.motion.name << std::hex << " 0x" << hash_at(e.motion, 0);
    EXPECT_EQ(hash_at(e.motion, 100), e.later) << e.motion.name << std::hex << " 0x" << hash_at(e.motion, 100);
    EXPECT_EQ(scenes::hash(e.motion.mesh), e.start) << e.motion.name;
  }
}

TEST(Motions, ComeBack) {
  for (const scenes::Motion& motion : {scenes::twisting_bar(4), scenes::crumpling_cloth(10)}) {
    EXPECT_EQ(hash_at(motion, 500), hash_at(motion, 0)) << motion.name;
    EXPECT_NE(hash_at(motion, 250), hash_at(motion, 0)) << motion.name;
    EXPECT_EQ(hash_at(motion, 130), hash_at(motion, 370)) << motion.name;
  }
}

TEST(Motions, MorphsEndWhereTheyShould) {
  const Mesh from = scenes::wave_sheet(6, 6, 0), to = scenes::wave_sheet(6, 6, 3);
  const scenes::Motion morph = scenes::morph("wave", from, to, 4);
  EXPECT_EQ(morph.positions(0), from.positions());
  const std::vector<Vec3> end = morph.positions(4), half = morph.positions(2);
  for (std::size_t v = 0; v < end.size(); ++v) {
    EXPECT_NEAR(length(end[v] - to.positions()[v]), 0, 1e-15);
    EXPECT_NEAR(length(half[v] - 0.5 * (from.positions()[v] + to.positions()[v])), 0, 1e-15);
  }
  EXPECT_EQ(morph.positions(7), morph.positions(1));
}

}  // namespace
}  // namespace limber::testing
