// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "limber/distance.h"
#include "limber/model.h"

/// Queries of two models, compared with brute force.
namespace limber::fuzz {

/// The error that distances may have, as a part of the largest placed coordinates of both models, and at least: the sum
/// of the bounds of docs/algorithms/numerics.md, with extents of twice that and distances of four times that.
inline constexpr double relative_tolerance = 0x1p-42, least_tolerance = 0x1p-1020;

/// The true answers about two placed models.
struct Truth {
  double distance = 0;   ///< 0 exactly when the models meet
  double size = 0;       ///< at least the largest placed coordinate of both models
  double tolerance = 0;  ///< for distances and points of these models
};

Truth truth_about(const Placed& a, const Placed& b);

/// One query each, in the caller's floating-point environment; `cache` may be null.
void check_collide(const Placed& a, const Placed& b, const Truth& truth, std::uint8_t environment, QueryCache* cache);
void check_distance(const Placed& a, const Placed& b, const Truth& truth, std::uint8_t environment, QueryCache* cache,
                    const DistanceOptions& options);
void check_within(const Placed& a, const Placed& b, const Truth& truth, std::uint8_t environment, QueryCache* cache,
                  double max_distance);

}  // namespace limber::fuzz
