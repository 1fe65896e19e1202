// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// 100 000 random sequences of everything that can be done to a model that bends, against brute force.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

#include "limber/model.h"
#include "limber/reference.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

class Sequence {
 public:
  explicit Sequence(Rng& rng)
      : rng_(rng),
        mesh_(arbitrary_mesh(rng, rng.below(8) == 0 ? 150 : 12, {}, 1)),
        bent_(mesh_, {.slack = some_slack(), .restructuring = static_cast<Restructuring>(rng.below(2))}),
        still_(arbitrary_mesh(rng, 5, {}, 1)) {}

  void step() {
    switch (rng_.below(10)) {
      case 0:
        return move_all();
      case 1:
        return reject();
      case 2:
        bent_.set_slack(some_slack());
        break;
      case 3:
        bent_.restructure();
        break;
      case 4:
        bent_.reset(mesh_ = moved(mesh_, 0.1 * uniform_point(rng_), 1));
        break;
      case 5:  // twice
        move();
        return move();
      case 6:
        bent_.commit();
        break;
      default:
        return move();
    }
  }

  /// Commits, and compares with what a mesh of its own says.
  void check() {
    bent_.commit();
    ASSERT_TRUE(bent_.is_committed());
    ASSERT_EQ(bent_.mesh().positions(), mesh_.positions());
    const Result<void> valid = bent_.validate();
    ASSERT_TRUE(static_cast<bool>(valid)) << valid.error().text;
    // Depth: docs/algorithms/bounds.md.
    const std::size_t leaves = (mesh_.triangles().size() + 7) / 8;
    std::uint32_t levels = 1;
    for (std::size_t reach = 1; reach < leaves; reach *= 8) ++levels;
    ASSERT_EQ(bent_.tree_stats().levels, levels);

    const Transform pose = rng_.below(3) == 0 ? random_pose(rng_, 4) : Transform{};
    const double truth = reference::distance({mesh_}, {still_.mesh(), pose}).upper;
    const DistanceResult cold = distance({bent_}, {still_, pose}), warm = distance({bent_}, {still_, pose}, {}, pair_);
    ASSERT_NEAR(cold.upper, truth, tolerance);
    ASSERT_NEAR(warm.upper, truth, tolerance);
    ASSERT_EQ(cold.upper == 0, truth == 0);
    ASSERT_EQ(collide({bent_}, {still_, pose}, pair_).collision, truth == 0);
  }

 private:
  static constexpr double tolerance = 1e-12;

  double some_slack() {
    const std::uint64_t kind = rng_.below(4);
    return kind == 0 ? ModelOptions::automatic : kind == 1 ? 0 : std::pow(10.0, rng_.uniform(-4, 0.5));
  }

  Vec3 some_move(const Vec3& p) { return p + std::pow(10.0, rng_.uniform(-4, 0.5)) * uniform_point(rng_); }

  void move() {
    std::vector<VertexId> ids;
    std::vector<Vec3> positions;
    for (std::uint64_t i = 0, count = 1 + rng_.below(5); i < count; ++i) {
      ids.push_back(static_cast<VertexId>(rng_.below(mesh_.positions().size())));
      positions.push_back(some_move(mesh_.positions()[ids.back()]));
      mesh_.set_position(ids.back(), positions.back());
    }
    ASSERT_TRUE(static_cast<bool>(bent_.move_vertices(ids, positions)));
  }

  void move_all() {
    std::vector<Vec3> positions = mesh_.positions();
    for (Vec3& p : positions) p = some_move(p);
    mesh_.set_positions(positions);
    ASSERT_TRUE(static_cast<bool>(bent_.move_all(positions)));
  }

  void reject() {
    std::vector<Vec3> positions = mesh_.positions();
    const std::size_t bad = rng_.below(positions.size());
    positions[bad].z = rng_.below(2) == 0 ? std::numeric_limits<double>::quiet_NaN() : 1e70;
    const Result<void> all = bent_.move_all(positions);
    ASSERT_FALSE(static_cast<bool>(all));
    ASSERT_EQ(all.error().where, bad);
    const std::vector<VertexId> ids{0, static_cast<VertexId>(positions.size())};
    const Result<void> some = bent_.move_vertices(ids, std::vector<Vec3>(2));
    ASSERT_FALSE(static_cast<bool>(some));
    ASSERT_EQ(some.error().where, 1U);
  }

  Rng& rng_;
  Mesh mesh_;  // what the model should be
  Model bent_, still_;
  Pair pair_;
};

TEST(UpdateSequences, LeaveEveryModelSoundAndEveryAnswerRight) {
  Rng rng(91);
  int sequences = 0, steps = 0;
  for (; sequences < 100'000 && !HasFatalFailure(); ++sequences) {
    Sequence sequence(rng);
    for (std::uint64_t i = 0, count = 1 + rng.below(6); i < count && !HasFatalFailure(); ++i, ++steps) {
      sequence.step();
      if (rng.below(2) == 0) sequence.check();
    }
    if (!HasFatalFailure()) sequence.check();
  }
  std::printf("%d sequences, %d steps\n", sequences, steps);
}

}  // namespace
}  // namespace limber::testing
