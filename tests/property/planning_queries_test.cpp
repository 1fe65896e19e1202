// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries in motion planners' scenes, with every instruction set and with a cache along short paths, next to brute
// force. The environment variable LIMBER_PLANNING_QUERIES changes how many there are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>

#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/scenes.h"
#include "simd/kernels.h"
#include "support/brute_force.h"
#include "support/right_answers.h"

namespace limber::testing {
namespace {

struct NamedScene {
  const char* name;
  scenes::PlanningScene (*make)(double detail);
};

class PlanningQueries : public ::testing::TestWithParam<NamedScene> {
 protected:
  ~PlanningQueries() override { simd::use_kernels(nullptr); }
};

TEST_P(PlanningQueries, HaveTheAnswersOfBruteForce) {
  constexpr std::uint64_t scene_count = 9;
  const std::uint64_t wanted = count_from("LIMBER_PLANNING_QUERIES", 3000) / scene_count;
  const scenes::PlanningScene scene = GetParam().make(1);
  const Model environment(scene.environment), robot(scene.robot);
  const auto [low, high] = environment.bounding_box();
  const double size = max_abs(high - low);
  // So many queries of a pose that they take about as long as brute force.
  const std::uint64_t pairs = scene.environment.triangles().size() * scene.robot.triangles().size();
  const std::uint64_t per_pose = std::clamp<std::uint64_t>(pairs / 50'000, 8, 400);
  Rng rng(95);
  std::uint64_t queries = 0, poses = 0;
  QueryCache cache;
  Transform pose;
  while (queries <= wanted) {
    if (poses % 4 == 0) {
      const Vec3 place{rng.uniform(low.x, high.x), rng.uniform(low.y, high.y), rng.uniform(low.z, high.z)};
      pose = {scenes::random_rotation(rng), place};
    } else {
      pose.translation += 0.01 * size * uniform_point(rng);
    }
    const Truth truth{brute_force_distance({scene.environment, {}}, {scene.robot, pose}), 1e-13 * size};
    ++poses;
    const Placed a{environment, {}}, b{robot, pose};
    for (std::uint64_t i = 0; i < per_pose; ++i, ++queries) {
      const std::span<const simd::Kernels> sets = simd::all_kernels();
      simd::use_kernels(&sets[i % sets.size()]);
      const bool is_cached = rng.below(2) == 0;
      const std::string wrong = !is_cached && rng.below(2) == 0
                                    ? wrong_answer_to_any(rng, b, a, truth)
                                    : wrong_answer_to_any(rng, a, b, truth, is_cached ? &cache : nullptr);
      ASSERT_EQ(wrong, "") << "pose " << poses << ", " << sets[i % sets.size()].name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, PlanningQueries,
    ::testing::Values(NamedScene{"sculptures", scenes::sculptures}, NamedScene{"house", scenes::house},
                      NamedScene{"twisty_wall", scenes::twisty_wall}, NamedScene{"cubicles", scenes::cubicles},
                      NamedScene{"alpha_puzzle", scenes::alpha_puzzle}, NamedScene{"bug_trap", scenes::bug_trap},
                      NamedScene{"spiral_tunnel", scenes::spiral_tunnel},
                      NamedScene{"furnished_flat", scenes::furnished_flat}, NamedScene{"assembly", scenes::assembly}),
    [](const auto& scene) { return scene.param.name; });

}  // namespace
}  // namespace limber::testing
