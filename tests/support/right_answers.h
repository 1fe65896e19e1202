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
};

template <typename Placed>
std::string wrong_witness(const Witness& w, const Placed& a, const Placed& b, double distance, double tolerance) {
  const auto lies_on = [&](const Vec3& point, const Placed& placed, TriangleId id) {
    const Triangle world = mapped(placed.model().mesh().triangle(id), placed.pose);
    return closest_points(point, world).distance <= 10 * tolerance;
  };
  if (!lies_on(w.point_a, a, w.triangle_a) || !lies_on(w.point_b, b, w.triangle_b))
    return "a point is not on its triangle";
  if (distance == 0 && w.point_a != w.point_b) return "the shared point is two";
  const double apart = closest_points(w.point_a, Triangle{w.point_b, w.point_b, w.point_b}).distance;
  return std::abs(apart - distance) <= tolerance + 0x1p-1021 ? "" : "the points are not as far apart";
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
  if (const std::string wrong = wrong_witness(*r.witness, a, b, r.upper, tolerance); !wrong.empty()) return wrong;
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
  return r.witness && limit == 0 ? wrong_witness(*r.witness, a, b, 0, truth.tolerance) : "";
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
