// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "limber/convex.h"
#include "pair/convex_pair.h"
#include "pair/placed_pair.h"
#include "penetration/expanding_polytope.h"

namespace limber {
namespace {

/// The points of both bodies that meet once b is moved along a direction.
Witness witness_of(const pair::ConvexDifference& difference, const pair::Simplex& simplex, const Placed& a,
                   const Placed& b, const Vec3& direction) {
  const auto point_of = [&](pair::Side side, const Transform& pose) {
    return pose(pair::point_of(difference.parts(side), simplex, side));
  };
  return {point_of(pair::Side::a, a.pose) + a.body().radius() * direction,
          point_of(pair::Side::b, b.pose) - b.body().radius() * direction,
          pair::triangle_at(difference.parts(pair::Side::a), simplex, pair::Side::a),
          pair::triangle_at(difference.parts(pair::Side::b), simplex, pair::Side::b)};
}

const model::ConvexParts& parts_of(const Placed& body, const char* text) {
  const model::ConvexParts* const parts = Access::convex_parts(body.body());
  LIMBER_REQUIRE(parts != nullptr, text);
  return *parts;
}

}  // namespace

ConvexDepth convex_depth(const Placed& a, const Placed& b, const ConvexDepthOptions& options) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(base::is_finite_and_not_negative(options.relative_error),
                 "limber::convex_depth: relative_error must be finite and at least 0");
  const model::ConvexParts& parts_a = parts_of(a, "limber::convex_depth: a is not known to be convex");
  const model::ConvexParts& parts_b = parts_of(b, "limber::convex_depth: b is not known to be convex");
  const pair::PlacedPair placed(a, b);
  const pair::Radii radii(a, b);
  ConvexDepth result;
  pair::ConvexDifference difference(placed, parts_a, parts_b);
  pair::ConvexSearch search(difference);
  // Beyond this the bodies are apart for certain.
  search.run(difference.units(radii.radius()) * base::outward * base::outward + 2 * difference.rounding(), {}, false,
             result.stats);
  const pair::Simplex& simplex = search.simplex();
  const double apart = search.height() - difference.rounding();
  if (apart > 0 && difference.from_units(apart) * base::inward > radii.radius()) return result;
  if (apart > 0) {  // the cores are apart, but not by both radii
    result.direction = search.direction();
    result.lower = radii.radius() - difference.from_units(simplex.distance + difference.rounding()) * base::outward;
    result.upper = radii.radius() - difference.from_units(apart) * base::inward;
    result.witness = witness_of(difference, simplex, a, b, result.direction);
  } else {
    penetration::ExpandingPolytope polytope(difference);
    polytope.run(simplex, options.relative_error, result.stats);
    result.direction = -polytope.normal();
    result.lower = radii.radius() + difference.from_units(polytope.lower());
    result.upper = radii.radius() + difference.from_units(polytope.upper());
    result.witness = witness_of(difference, polytope.nearest(), a, b, result.direction);
  }
  const double rounding = 0x1p-50 * (radii.radius() + result.upper);
  result.lower = std::max(0.0, result.lower - rounding), result.upper += rounding;
  return result;
}

}  // namespace limber
