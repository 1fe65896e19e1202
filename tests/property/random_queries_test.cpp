// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// More than 200 000 random queries of the fast engine against brute force, on every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "limber/distance.h"
#include "limber/model.h"
#include "simd/kernels.h"
#include "support/brute_force.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

class Campaign {
 public:
  void run(Rng& rng) {
    const Scene s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b);
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    const double truth = brute_force_distance({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b});
    const double limit = truth * (0.5 + 0.5 * static_cast<double>(rng.below(3))) + 4 * s.tolerance;
    const DistanceOptions asked[] = {
        {},
        {.relative_error = rng.uniform(0, 1)},
        {.absolute_error = rng.uniform(0, 0.05) * s.size},
        {.relative_error = 0.01, .max_distance = limit},
    };
    for (const DistanceOptions& options : asked) {
      const DistanceResult first = ask(simd::scalar_kernels, a, b, options);
      check(first, truth, options, s.size);
      for (const simd::Kernels& set : simd::all_kernels()) {
        const DistanceResult result = ask(set, a, b, options);
        ++queries;
        ASSERT_TRUE(same(result, first)) << set.name;
      }
    }
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::use_kernels(&set);
      ASSERT_EQ(collide(a, b).is_yes(), truth == 0) << set.name;
      ++queries;
    }
    simd::use_kernels(nullptr);
    contacts += truth == 0 ? 1 : 0;
  }

  int queries = 0, contacts = 0;
  double worst = 0;  // difference from the truth, as a fraction of the size

 private:
  static DistanceResult ask(const simd::Kernels& set, const Placed& a, const Placed& b,
                            const DistanceOptions& options) {
    simd::use_kernels(&set);
    const DistanceResult result = distance(a, b, options);
    simd::use_kernels(nullptr);
    return result;
  }

  static bool same(const DistanceResult& x, const DistanceResult& y) {
    return std::memcmp(&x.lower, &y.lower, sizeof(double)) == 0 &&
           std::memcmp(&x.upper, &y.upper, sizeof(double)) == 0 && x.witness.has_value() == y.witness.has_value() &&
           (!x.witness || std::memcmp(&*x.witness, &*y.witness, sizeof(Witness)) == 0) && x.status == y.status;
  }

  void check(const DistanceResult& r, double truth, const DistanceOptions& options, double size) {
    const double rounding = 1e-14 * size;
    ASSERT_LE(r.lower, truth + rounding);
    ASSERT_GE(r.upper, truth - rounding);
    if (r.status == Status::beyond_limit) {
      ASSERT_GT(truth, options.max_distance - rounding);
      return;
    }
    ASSERT_EQ(r.upper == 0, truth == 0);
    const double allowed = std::max(truth * (1 + options.relative_error), truth + options.absolute_error);
    ASSERT_LE(r.upper, allowed + rounding);
    if (options.relative_error != 0 || options.absolute_error != 0) return;
    ASSERT_EQ(r.lower, r.upper);
    worst = std::max(worst, std::abs(r.upper - truth) / size);
  }
};

TEST(RandomQueries, OfTheFastEngineEqualTheReferenceOnEveryInstructionSet) {
  Rng rng(90);
  Campaign campaign;
  while (campaign.queries < 200'000 && !HasFatalFailure()) campaign.run(rng);
  std::printf("%d queries, %d scenes in contact, worst difference %.2g of the size\n", campaign.queries,
              campaign.contacts, campaign.worst);
  EXPECT_LE(campaign.worst, 1e-12);
  EXPECT_GT(campaign.contacts, 500);
}

}  // namespace
}  // namespace limber::testing
