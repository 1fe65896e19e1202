// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Every promise of the queries, on random soups, poses and settings, with every instruction set.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "simd/kernels.h"
#include "support/brute_force.h"
#include "support/options.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void require_witness(const Scene& s, const Witness& w, double distance) {
  const auto lies_on = [&](const Vec3& point, const Triangle& t, const Transform& pose) {
    return closest_points(point, Triangle{pose(t.v0), pose(t.v1), pose(t.v2)}).distance <= 10 * s.tolerance;
  };
  RC_ASSERT(lies_on(w.point_a, s.mesh_a.triangle(w.triangle_a), s.pose_a));
  RC_ASSERT(lies_on(w.point_b, s.mesh_b.triangle(w.triangle_b), s.pose_b));
  RC_ASSERT(std::abs(length(w.point_b - w.point_a) - distance) <= 10 * s.tolerance);
  if (distance == 0) RC_ASSERT(w.point_a == w.point_b);
}

/// `a` and `b` are models of the scene's meshes; `truth` is the reference's distance.
void require_right_answers(Rng& rng, const Scene& s, const Placed& a, const Placed& b, double truth) {
  const double tolerance = s.tolerance;
  const DistanceResult exact = distance(a, b);
  RC_ASSERT(std::abs(exact.upper - truth) <= tolerance);
  RC_ASSERT(exact.lower == exact.upper);
  RC_ASSERT((exact.upper == 0) == (truth == 0));
  RC_ASSERT(exact.status == (truth == 0 ? Status::collision : Status::exact));
  require_witness(s, exact.witness.value(), exact.upper);

  const CollideResult hit = collide(a, b);
  RC_ASSERT(hit.is_yes() == (truth == 0));
  RC_ASSERT(hit.witness.has_value() == hit.is_yes());
  if (hit.witness) require_witness(s, *hit.witness, 0);

  const double relative = rng.uniform(0, 1), absolute = rng.below(2) == 0 ? 0 : rng.uniform(0, 1) * s.size / 20;
  const DistanceResult rough = distance(a, b, {.relative_error = relative, .absolute_error = absolute});
  RC_ASSERT((rough.upper == 0) == (truth == 0));
  RC_ASSERT(rough.lower <= truth + tolerance);
  RC_ASSERT(rough.upper >= truth - tolerance);
  RC_ASSERT(rough.upper <= std::max(truth * (1 + relative), truth + absolute) + tolerance);
  require_witness(s, rough.witness.value(), rough.upper);

  const double limit = rng.below(4) == 0 ? truth : truth * (0.5 + 0.5 * static_cast<double>(rng.below(3)));
  if (std::abs(limit - truth) > tolerance || limit == 0) {
    const CollideResult near = within(a, b, limit);
    RC_ASSERT(near.is_yes() == (truth <= limit));
    RC_ASSERT(near.witness.has_value() == near.is_yes());
    const DistanceResult limited = distance(a, b, {.max_distance = limit});
    RC_ASSERT((limited.status == Status::beyond_limit) == (truth > limit));
    RC_ASSERT(limited.lower <= truth + tolerance);
    if (truth > limit) RC_ASSERT(limited.upper == infinity && limited.lower >= limit);
    if (truth <= limit) RC_ASSERT(std::abs(limited.upper - truth) <= tolerance);
  }
}

RC_GTEST_PROP(FastEngine, IsRightOnAnySceneAtAnySetting, (std::uint64_t seed)) {
  Rng rng(seed);
  const Scene s = arbitrary_scene(rng);
  const Model model_a(s.mesh_a), model_b(s.mesh_b);
  RC_ASSERT(static_cast<bool>(model_a.validate()));
  const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
  const double truth = brute_force_distance({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b});
  require_right_answers(rng, s, a, b, truth);

  QueryCache cache;
  distance(a, {model_b, random_pose(rng, 1)}, {.cache = &cache});  // a start that does not help
  const DistanceResult warm = distance(a, b, {.cache = &cache});
  RC_ASSERT(std::abs(warm.upper - truth) <= s.tolerance);
  RC_ASSERT(collide(a, b, {.cache = &cache}).is_yes() == (truth == 0));
  const DistanceResult swapped = distance(b, a);
  RC_ASSERT(std::abs(swapped.upper - truth) <= s.tolerance);
}

/// One step of a motion: usually small, sometimes none, a jump, or a jump far away, after which it is back to `home`.
Transform step_from(Rng& rng, const Transform& pose, const Transform& home, double size) {
  if (rng.below(8) == 0) return pose;
  if (length(pose.translation - home.translation) > 100 * size) return home;
  if (rng.below(8) == 0 && size < 0x1p150)
    return {pose.rotation, pose.translation + (1e12 * size) * uniform_point(rng)};
  const double most = rng.below(8) == 0 ? 1 : std::pow(10.0, rng.uniform(-6, -1));
  const Vec3 axis = uniform_point(rng);
  const Transform turn = transform_from_quaternion({}, 1, most * axis.x, most * axis.y, most * axis.z).value();
  return {turn.rotation * pose.rotation, pose.translation + (most * size) * uniform_point(rng)};
}

RC_GTEST_PROP(FastEngine, CachesAreRightAlongAnyMotion, (std::uint64_t seed)) {
  Rng rng(seed);
  Scene s = arbitrary_scene(rng);
  const Model model_a(s.mesh_a), model_b(s.mesh_b);
  const Transform home_a = s.pose_a, home_b = s.pose_b;
  const double tolerance_at_home = s.tolerance;
  QueryCache cache;
  for (int frame = 0; frame < 20; ++frame) {
    if (rng.below(4) == 0) s.pose_a = step_from(rng, s.pose_a, home_a, s.size);
    s.pose_b = step_from(rng, s.pose_b, home_b, s.size);
    s.tolerance = tolerance_at_home + 1e-14 * (length(s.pose_a.translation) + length(s.pose_b.translation));
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    const double truth = distance(a, b).upper, tolerance = s.tolerance;
    if (rng.below(20) == 0) distance(b, a, {.cache = &cache});  // the cache does not fit the models in this order
    switch (rng.below(5)) {
      case 0:
        RC_ASSERT(collide(a, b, {.cache = &cache}).is_yes() == (truth == 0));
        break;
      case 1: {
        const double limit = truth * rng.uniform(0, 2);
        if (std::abs(limit - truth) > tolerance)
          RC_ASSERT(within(a, b, limit, {.cache = &cache}).is_yes() == (truth <= limit));
        break;
      }
      case 2: {
        const double error = rng.uniform(0, 1);
        const DistanceResult rough = distance(a, b, {.relative_error = error, .cache = &cache});
        RC_ASSERT((rough.upper == 0) == (truth == 0));
        RC_ASSERT(rough.lower <= truth + tolerance && rough.upper >= truth - tolerance);
        RC_ASSERT(rough.upper <= truth * (1 + error) + tolerance);
        break;
      }
      default: {
        const DistanceResult exact = distance(a, b, {.cache = &cache});
        RC_ASSERT(std::abs(exact.upper - truth) <= tolerance);
        RC_ASSERT((exact.upper == 0) == (truth == 0));
        require_witness(s, exact.witness.value(), exact.upper);
      }
    }
  }
}

/// Asks for the distance with a cache, and notes what is as far apart as the answer up to rounding.
void ask_for_ties(Rng& rng, const Placed& a, const Placed& b, QueryCache& cache, std::vector<double>& limits) {
  const double known = limits.empty() ? infinity : limits[rng.below(limits.size())];
  const DistanceOptions asked[] = {{},
                                   {},
                                   {.relative_error = rng.uniform(0, 5)},
                                   {.max_distance = known},
                                   {.relative_error = 5, .max_distance = known}};
  const double upper = distance(a, b, with(asked[rng.below(std::size(asked))], &cache)).upper;
  if (upper == infinity) return;
  for (const double limit : {std::nextafter(upper, 0.0), upper, std::nextafter(upper, infinity)})
    limits.push_back(limit);
}

RC_GTEST_PROP(FastEngine, WithinIsThatOfComparingAllPairsWithAnyCache, (std::uint64_t seed)) {
  Rng rng(seed);
  Scene s = arbitrary_scene(rng);
  const Model model_a(s.mesh_a), model_b(s.mesh_b);
  const Transform home = s.pose_b;
  QueryCache cache;
  for (int pose = 0; pose < 3; ++pose) {
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    const double truth = brute_force_distance({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b});
    std::vector<double> limits{truth};
    for (int query = 0; query < 10; ++query) {
      if (rng.below(2) == 0) ask_for_ties(rng, a, b, cache, limits);
      const double limit = limits[rng.below(limits.size())];
      RC_ASSERT(within(a, b, limit, {.cache = &cache}).is_yes() == (truth <= limit));
      RC_ASSERT(within(a, b, limit).is_yes() == (truth <= limit));
      if (truth <= limit) {
        RC_ASSERT(distance(a, b, {.max_distance = limit, .cache = &cache}).status != Status::beyond_limit);
      }
    }
    s.pose_b = step_from(rng, s.pose_b, home, s.size);
  }
}

RC_GTEST_PROP(FastEngine, AnswersToTheBitAlikeOnEveryInstructionSet, (std::uint64_t seed)) {
  Rng rng(seed);
  const Scene s = arbitrary_scene(rng);
  const Model model_a(s.mesh_a), model_b(s.mesh_b);
  const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
  const DistanceOptions options{.relative_error = rng.below(2) == 0 ? 0 : rng.uniform(0, 1)};
  const auto ask = [&](const simd::Kernels& set) {
    simd::use_kernels(&set);
    const DistanceResult result = distance(a, b, options);
    simd::use_kernels(nullptr);
    return result;
  };
  const DistanceResult first = ask(simd::scalar_kernels);
  for (const simd::Kernels& set : simd::all_kernels()) {
    const DistanceResult result = ask(set);
    RC_ASSERT(std::memcmp(&result.lower, &first.lower, sizeof(double)) == 0);
    RC_ASSERT(std::memcmp(&result.upper, &first.upper, sizeof(double)) == 0);
    RC_ASSERT(std::memcmp(&*result.witness, &*first.witness, sizeof(Witness)) == 0);
    RC_ASSERT(result.stats.node_tests == first.stats.node_tests);
    RC_ASSERT(result.stats.triangle_tests == first.stats.triangle_tests);
  }
}

}  // namespace
}  // namespace limber::testing
