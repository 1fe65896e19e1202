// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <span>
#include <string>

#include "base/check.h"
#include "limber/distance.h"
#include "limber/points.h"

/// What all queries require of the options of a query. Comparisons with NaN are false, so NaN is refused too.
namespace limber::base {

inline bool is_finite_and_not_negative(double x) { return x >= 0 && x <= std::numeric_limits<double>::max(); }

inline void check_limit(double max_distance, const char* function) {
  LIMBER_REQUIRE(max_distance >= 0, (std::string(function) + ": max_distance must be at least 0, or infinite").c_str());
}

inline void check_options(const DistanceOptions& options, const char* function) {
  const auto text = [&](const char* what) { return std::string(function) + ": " + what; };
  LIMBER_REQUIRE(is_finite_and_not_negative(options.relative_error),
                 text("relative_error must be finite and at least 0").c_str());
  LIMBER_REQUIRE(is_finite_and_not_negative(options.absolute_error),
                 text("absolute_error must be finite and at least 0").c_str());
  check_limit(options.max_distance, function);
}

/// Whether a budget can end a query whose answer counts.
inline bool is_limited(const QueryBudget& budget) {
  return budget.deadline || budget.cancel != nullptr || budget.max_steps < std::numeric_limits<std::uint64_t>::max();
}

inline void check_options(const PointOptions& options, const char* function) {
  check_limit(options.max_distance, function);
}

inline bool is_point(const Vec3& point) { return is_finite(point) && max_abs(point) <= max_coordinate; }
inline constexpr const char* bad_point = "has a coordinate that is not finite, or above 2^200";

inline void check_point(const Vec3& point, const char* function) {
  LIMBER_REQUIRE(is_point(point), (std::string(function) + ": point " + bad_point).c_str());
}

/// Checks the arguments of a query about many points.
inline void check_points(std::span<const Vec3> points, std::size_t result_count, const char* function) {
  LIMBER_REQUIRE(points.size() == result_count,
                 (std::string(function) + ": there must be as many results as points").c_str());
  for (std::size_t i = 0; i < points.size(); ++i) {
    LIMBER_REQUIRE_ENTRY(is_point(points[i]), (std::string(function) + ": points").c_str(), i, bad_point);
  }
}

inline void check_max_distance(double max_distance) {
  LIMBER_REQUIRE(is_finite_and_not_negative(max_distance),
                 "limber::within: max_distance must be finite and at least 0");
}

/// For functions that are about triangles alone.
inline void check_has_no_radius(const Placed& body, const char* function) {
  LIMBER_REQUIRE(body.body().radius() == 0, (std::string(function) + ": takes no shape that has a radius").c_str());
}

inline void check_margin(double margin, const char* function) {
  LIMBER_REQUIRE(is_finite_and_not_negative(margin),
                 (std::string(function) + ": margin must be finite and at least 0").c_str());
}

}  // namespace limber::base
