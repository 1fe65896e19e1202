// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/check.h"
#include "limber/query.h"

/// What every engine requires of the options of a query. Comparisons with NaN are false, so NaN is refused too.
namespace limber::query {

inline bool is_finite_and_not_negative(double x) { return x >= 0 && x <= std::numeric_limits<double>::max(); }

inline void check_options(const DistanceOptions& options) {
  LIMBER_REQUIRE(is_finite_and_not_negative(options.relative_error),
                 "limber::distance: relative_error must be finite and at least 0");
  LIMBER_REQUIRE(is_finite_and_not_negative(options.absolute_error),
                 "limber::distance: absolute_error must be finite and at least 0");
  LIMBER_REQUIRE(options.max_distance >= 0, "limber::distance: max_distance must be at least 0, or infinite");
}

inline void check_max_distance(double max_distance) {
  LIMBER_REQUIRE(is_finite_and_not_negative(max_distance),
                 "limber::within: max_distance must be finite and at least 0");
}

}  // namespace limber::query
