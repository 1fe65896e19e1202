// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "limber/distance.h"
#include "limber/model.h"
#include "support/random_geometry.h"

/// Random queries of two models, and what is wrong with their answers: a text, empty if nothing is.
namespace limber::testing {

/// Adds a cache and a budget to options.
inline DistanceOptions with(DistanceOptions options, QueryCache* cache, const QueryBudget& budget = {}) {
  options.cache = cache, options.budget = budget;
  return options;
}

/// The distance of two models, and how far rounding may be off.
struct Truth {
  double distance, tolerance;
  double size = 0;  ///< of the largest coordinate; above 0, slivers that meet may share a point that is off by more
};

/// The smallest height of a triangle as a part of `size`. Edges are divided first, so no product vanishes or overflows.
inline double relative_height(const Triangle& t, double size) {
  const Vec3 p = (1 / size) * (t.v1 - t.v0), q = (1 / size) * (t.v2 - t.v0);
  const double longest = std::max({length(p), length(q), length(q - p)});
  return longest == 0 ? 0 : length(cross(p, q)) / longest;
}

/// How far off the shared point of triangles that meet may be if one is a sliver (docs/algorithms/numerics.md). `size`
/// is at least their largest coordinate.
inline double sliver_tolerance(const Triangle& a, const Triangle& b, double size) {
  if (!(size > 0x1p-1000)) return 0;
  const double height = std::min(relative_height(a, size), relative_height(b, size));
  return size * std::min(0x1p-50 / std::max(height, 0x1p-100), 0x1p-26);
}

/// How far apart points are, also where squares of differences underflow.
inline double distance_between(const Vec3& a, const Vec3& b) { return std::hypot(b.x - a.x, b.y - a.y, b.z - a.z); }

/// What is wrong with a witness of that distance. `meet` says that its triangles have to; otherwise they may be so
/// little apart that rounding makes one point of both.
template <typename Placed>
std::string wrong_witness(const Witness& w, const Placed& a, const Placed& b, double distance, bool meet,
                          const Truth& truth) {
  const auto in_world = [](const Placed& placed, TriangleId id) {
    const Triangle t = placed.model().mesh().triangle(id);
    return Triangle{placed.pose(t.v0), placed.pose(t.v1), placed.pose(t.v2)};
  };
  if (w.triangle_a >= a.model().mesh().triangles().size() || w.triangle_b >= b.model().mesh().triangles().size())
    return "there is no such triangle";
  const Triangle t = in_world(a, w.triangle_a), u = in_world(b, w.triangle_b);
  const double off = 10 * truth.tolerance + (meet ? sliver_tolerance(t, u, truth.size) : 0);
  // Poses put the largest coordinates farther away than closest_points() takes, but not more than four times.
  const auto is_off = [&](const Vec3& p, const Triangle& on) {
    return !(closest_points(0.25 * p, {0.25 * on.v0, 0.25 * on.v1, 0.25 * on.v2}).distance <= 0.25 * off);
  };
  if (is_off(w.point_a, t) || is_off(w.point_b, u)) return "a point is not on its triangle";
  if (meet && w.point_a != w.point_b) return "the shared point is two";
  if (meet && !intersects(t, u)) return "the triangles do not meet";
  const double apart = distance_between(w.point_a, w.point_b);
  return std::abs(apart - distance) <= truth.tolerance + 0x1p-1021 ? "" : "the points are not as far apart";
}

template <typename Placed>
std::string wrong_answer(const DistanceResult& r, const DistanceOptions& asked, const Placed& a, const Placed& b,
                         const Truth& truth) {
  const double distance = truth.distance, tolerance = truth.tolerance;
  if (r.lower > distance + tolerance || r.upper < distance - tolerance)
    return "the interval does not hold the distance";
  if ((r.status == DistanceStatus::interrupted) != (r.stopped_by != StoppedBy::nothing))
    return "interrupted by nothing";
  if (r.witness.has_value() != (r.status != DistanceStatus::beyond_limit))
    return "a witness is missing, or there without reason";
  if (!r.witness) {
    const bool is_beyond = distance > asked.max_distance - (asked.max_distance == 0 ? 0 : tolerance);
    const bool is_said = std::isinf(r.upper) && r.lower >= asked.max_distance;
    return is_beyond && is_said ? "" : "it is not beyond the limit";
  }
  if (const std::string wrong = wrong_witness(*r.witness, a, b, r.upper, r.upper == 0, truth); !wrong.empty())
    return wrong;
  if (r.status == DistanceStatus::interrupted) return "";
  const bool meets = distance == 0;
  if ((r.upper == 0) != meets || (r.status == DistanceStatus::collision) != meets)
    return "whether the models meet is wrong";
  if (distance > asked.max_distance + tolerance) return "it is beyond the limit";
  const double most = std::max(distance * (1 + asked.relative_error), distance + asked.absolute_error);
  if (r.upper > most + tolerance) return "the error is too large";
  const bool is_exact = asked.relative_error == 0 && asked.absolute_error == 0;
  return is_exact && r.lower != r.upper ? "the distance is not exact" : "";
}

/// What is wrong with an answer of collide() if the limit is 0, otherwise of within().
template <typename Placed>
std::string wrong_answer(const CollideResult& r, double limit, const Placed& a, const Placed& b, const Truth& truth) {
  const double tolerance = limit == 0 ? 0 : truth.tolerance;
  if (r.is_yes() && truth.distance > limit + tolerance) return "yes is wrong";
  if (r.is_no() && truth.distance <= limit - tolerance) return "no is wrong";
  if ((r.answer == Answer::undecided) != (r.stopped_by != StoppedBy::nothing)) return "interrupted by nothing";
  if (r.witness.has_value() != r.is_yes()) return "a witness is missing, or there without reason";
  if (!r.witness) return "";
  const double apart = limit == 0 ? 0 : distance_between(r.witness->point_a, r.witness->point_b);
  if (apart > limit + tolerance) return "the points are too far apart";
  return wrong_witness(*r.witness, a, b, apart, limit == 0, truth);
}

/// Asks for the distance with any errors and limit, whether the models meet, or whether they are within a limit.
inline std::string wrong_answer_to_any(Rng& rng, const Placed& a, const Placed& b, const Truth& truth,
                                       QueryCache* cache = nullptr, const QueryBudget& budget = {}) {
  const std::uint64_t kind = rng.below(6);
  const double limit =
      truth.distance * (rng.below(2) == 0 ? 0.5 * static_cast<double>(rng.below(4)) : rng.uniform(0, 2));
  if (kind == 0) return wrong_answer(collide(a, b, {.cache = cache, .budget = budget}), 0, a, b, truth);
  if (kind == 1) return wrong_answer(within(a, b, limit, {.cache = cache, .budget = budget}), limit, a, b, truth);
  const double relative = rng.below(2) == 0 ? 0 : rng.uniform(0, 1);
  const double absolute = rng.below(3) == 0 ? rng.uniform(0, 0x1p42) * truth.tolerance : 0;
  DistanceOptions asked{.relative_error = relative, .absolute_error = absolute, .cache = cache, .budget = budget};
  if (kind == 2) asked.max_distance = limit;
  return wrong_answer(distance(a, b, asked), asked, a, b, truth);
}

}  // namespace limber::testing
