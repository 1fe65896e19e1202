// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Distances and weights of single elements, on triangles of every kind at any scale, against exact arithmetic.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "limber/elements.h"
#include "limber/model.h"
#include "limber/points.h"
#include "support/exact_distance.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

struct Pair {
  Triangle a, b;
};

/// Half of them in the unit that they are made in, half at a scale from the smallest doubles to the largest allowed.
Pair pair_of_any_kind(Rng& rng) {
  const auto any = static_cast<PairKind>(rng.below(static_cast<std::uint64_t>(PairKind::count)));
  const PairKind thin = rng.below(2) == 0 ? PairKind::one_line : PairKind::needle;
  const auto [a, b] = random_pair(rng, rng.below(2) == 0 ? any : thin);
  const int scale = rng.below(2) == 0 ? 0 : static_cast<int>(rng.below(1200)) - 1074;
  const auto scaled = [scale](const Vec3& p) {
    return Vec3{std::ldexp(p.x, scale), std::ldexp(p.y, scale), std::ldexp(p.z, scale)};
  };
  return {mapped(a, scaled), mapped(b, scaled)};
}

void require_distance(double found, const exact::Fraction& truth_sq, double tolerance) {
  RC_ASSERT(exact::is_at_most(found, truth_sq, tolerance));
  RC_ASSERT(exact::is_at_least(found, truth_sq, tolerance));
}

void require_weights(double w0, double w1, double w2) {
  RC_ASSERT(w0 >= 0 && w1 >= 0 && w2 >= 0);
  RC_ASSERT(std::abs(w0 + w1 + w2 - 1) <= 0x1p-51);
}

RC_GTEST_PROP(Primitives, TrianglesAreAsFarApartAsSaid, (std::uint64_t seed)) {
  Rng rng(seed);
  const auto [a, b] = pair_of_any_kind(rng);
  const exact::Fraction truth_sq = exact::squared_distance(a, b);
  for (const auto& [first, second] : {Pair{a, b}, Pair{b, a}}) {
    const double extent = extent_of_pair(first, second);
    require_distance(closest_points(first, second).distance, truth_sq, 0x1p-50 * extent + 0x1p-1022);
    const TriangleContact c = contact(first, second);
    RC_ASSERT(std::abs(length(c.normal) - 1) <= 0x1p-50);
    RC_ASSERT(std::isfinite(c.depth) && c.depth >= 0 && (c.depth == 0 || truth_sq == 0));
    const Model model_a(soup({first})), model_b(soup({second}));
    const double found = distance({model_a}, {model_b}).upper;
    require_distance(found, truth_sq, 0x1p-46 * extent + 0x1p-44 * found + 0x1p-1021);
  }
}

RC_GTEST_PROP(Primitives, PointsAndEdgesHaveWeights, (std::uint64_t seed)) {
  Rng rng(seed);
  const auto [a, b] = pair_of_any_kind(rng);
  const Model model_a(soup({a})), model_b(soup({b}));
  for (const Vec3& p : {a.v0, b.v0, b.v1, b.v2}) {
    const SurfacePoint found = closest_point({model_b}, p).closest.value();
    const double tolerance = 0x1p-50 * extent_of_pair({p, p, p}, b) + 0x1p-1022;
    require_distance(found.distance, exact::squared_distance({p, p, p}, b), tolerance);
    require_weights(found.weights[0], found.weights[1], found.weights[2]);
  }
  const ElementPairCount count = visit_element_pairs(
      {model_a}, {model_b}, 0x1p210,
      [](const VertexFacePair& pair) { return require_weights(pair.weights.x, pair.weights.y, pair.weights.z), true; },
      [](const EdgeEdgePair& pair) {
        RC_ASSERT(pair.parameter_a >= 0 && pair.parameter_a <= 1);
        RC_ASSERT(pair.parameter_b >= 0 && pair.parameter_b <= 1);
        return true;
      });
  RC_ASSERT(count.vertex_face == 6U && count.edge_edge == 9U);
}

}  // namespace
}  // namespace limber::testing
