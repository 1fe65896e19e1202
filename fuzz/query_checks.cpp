// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/query_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "fuzz/environment.h"
#include "fuzz/property.h"
#include "reference/reference.h"

namespace limber::fuzz {
namespace {

std::string numbers(double truth, double lower, double upper, double tolerance) {
  char text[200];
  std::snprintf(text, sizeof text, "truth %.17g, lower %.17g, upper %.17g, tolerance %.17g", truth, lower, upper,
                tolerance);
  return text;
}

double size_of(const Placed& placed) {
  double size = 0;
  for (const Vec3& p : placed.model().mesh().positions()) size = std::max(size, length(p));
  return size + max_abs(placed.pose.translation);
}

Triangle placed_triangle(const Placed& placed, TriangleId id) {
  const Triangle t = placed.model().mesh().triangle(id);
  return {placed.pose(t.v0), placed.pose(t.v1), placed.pose(t.v2)};
}

/// How far apart points are, also where squares of differences underflow.
double distance_between(const Vec3& a, const Vec3& b) { return std::hypot(b.x - a.x, b.y - a.y, b.z - a.z); }

/// How far a point is from a triangle. closest_points() takes coordinates up to 2^200, and a pose can put the largest
/// ones a model may have up to 2.8 times as far away.
double distance_to(const Vec3& p, const Triangle& t) {
  return 4 * closest_points(p * 0.25, {t.v0 * 0.25, t.v1 * 0.25, t.v2 * 0.25}).distance;
}

/// Points on the triangles they name.
void check_witness(const Placed& a, const Placed& b, const Witness& witness, double tolerance) {
  require(witness.triangle_a < a.model().mesh().triangles().size(), "the witness names a triangle of the first model");
  require(witness.triangle_b < b.model().mesh().triangles().size(), "the witness names a triangle of the second model");
  const auto is_on = [&](const Vec3& p, const Triangle& t) { return is_finite(p) && distance_to(p, t) <= tolerance; };
  require(is_on(witness.point_a, placed_triangle(a, witness.triangle_a)),
          "the witness's first point lies on its triangle");
  require(is_on(witness.point_b, placed_triangle(b, witness.triangle_b)),
          "the witness's second point lies on its triangle");
}

/// Whether the triangles that a witness names meet.
bool do_meet(const Placed& a, const Placed& b, const Witness& witness) {
  return intersects(placed_triangle(a, witness.triangle_a), placed_triangle(b, witness.triangle_b));
}

/// One point, on two triangles that meet.
void check_contact(const Placed& a, const Placed& b, const Witness& witness, const Truth& truth) {
  const double slack =
      sliver_tolerance(placed_triangle(a, witness.triangle_a), placed_triangle(b, witness.triangle_b), truth.size);
  check_witness(a, b, witness, truth.tolerance + slack);
  require(witness.point_a == witness.point_b, "the witness of a collision is one point");
  require(do_meet(a, b, witness), "the witness of a collision names triangles that meet");
}

}  // namespace

Truth truth_about(const Placed& a, const Placed& b) {
  const reference::Placed plain_a{a.model().mesh(), a.pose}, plain_b{b.model().mesh(), b.pose};
  const double size = size_of(a) + size_of(b);
  const Truth truth{reference::distance(plain_a, plain_b).upper, size,
                    std::max(relative_tolerance * size, least_tolerance)};
  require(reference::collide(plain_a, plain_b).is_yes() == (truth.distance == 0),
          "by brute force, models collide exactly when their distance is 0");
  return truth;
}

void check_collide(const Placed& a, const Placed& b, const Truth& truth, std::uint8_t environment, QueryCache* cache) {
  const CollideResult found = in_environment(environment, [&] { return collide(a, b, {.cache = cache}); });
  require(found.is_yes() == (truth.distance == 0),
          cache != nullptr ? "collide() with a cache is exact" : "collide() is exact",
          numbers(truth.distance, 0, 0, truth.tolerance));
  require(found.witness.has_value() == found.is_yes(), "collide() has a witness exactly when models collide");
  if (found.witness) check_contact(a, b, *found.witness, truth);
}

void check_distance(const Placed& a, const Placed& b, const Truth& truth, std::uint8_t environment, QueryCache* cache,
                    const DistanceOptions& options) {
  const DistanceResult found = in_environment(environment, [&] {
    DistanceOptions asked = options;
    asked.cache = cache;
    return distance(a, b, asked);
  });
  const double tolerance = truth.tolerance;
  const std::string detail = numbers(truth.distance, found.lower, found.upper, tolerance);
  require(!std::isnan(found.lower) && !std::isnan(found.upper), "bounds are numbers");
  require(found.lower <= found.upper, "lower does not exceed upper", detail);
  require(found.lower >= 0, "lower is not negative", detail);
  require(found.lower <= truth.distance + tolerance, "lower does not exceed the distance", detail);
  if (found.status == DistanceStatus::beyond_limit) {
    require(truth.distance > options.max_distance - tolerance, "models beyond the limit are that far apart", detail);
    require(found.lower >= options.max_distance && found.upper == std::numeric_limits<double>::infinity(),
            "bounds beyond the limit", detail);
    require(!found.witness, "no witness beyond the limit");
    return;
  }
  require(truth.distance <= options.max_distance + tolerance, "models within the limit are that close", detail);
  require(found.upper >= truth.distance - tolerance, "upper is not below the distance", detail);
  const double allowed =
      std::max(truth.distance * (1 + options.relative_error), truth.distance + options.absolute_error);
  require(found.upper <= allowed + tolerance, "upper is within the asked error", detail);
  require((found.upper == 0) == (truth.distance == 0), "distance() gives 0 exactly for models that meet", detail);
  const DistanceStatus expected = found.upper == 0             ? DistanceStatus::collision
                                  : found.lower == found.upper ? DistanceStatus::exact
                                                               : DistanceStatus::within_error;
  require(found.status == expected, "the status says what the bounds say", detail);
  require(found.witness.has_value(), "a witness within the limit");
  if (found.upper == 0) return check_contact(a, b, *found.witness, truth);
  check_witness(a, b, *found.witness, tolerance);
  const double between = distance_between(found.witness->point_a, found.witness->point_b);
  require(std::abs(between - found.upper) <= tolerance, "upper is the distance of the witness's points", detail);
}

void check_within(const Placed& a, const Placed& b, const Truth& truth, std::uint8_t environment, QueryCache* cache,
                  double max_distance) {
  const CollideResult found = in_environment(environment, [&] { return within(a, b, max_distance, {.cache = cache}); });
  const std::string detail = numbers(truth.distance, max_distance, max_distance, truth.tolerance);
  if (truth.distance <= max_distance - truth.tolerance || truth.distance == 0) {
    require(found.is_yes(), "within() finds models that are close", detail);
  }
  if (truth.distance > max_distance + truth.tolerance || (max_distance == 0 && truth.distance > 0)) {
    require(!found.is_yes(), "within() denies models that are far apart", detail);
  }
  require(found.witness.has_value() == found.is_yes(), "within() has a witness exactly when models are close");
  if (!found.witness) return;
  if (do_meet(a, b, *found.witness)) return check_contact(a, b, *found.witness, truth);
  const double between = distance_between(found.witness->point_a, found.witness->point_b);
  require(between <= max_distance + truth.tolerance, "the witness of within() is close", detail);
  check_witness(a, b, *found.witness, truth.tolerance);
}

}  // namespace limber::fuzz
