// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

#include "limber/geometry.h"

/// Continuous collision of two elements, a vertex and a face or two edges: whether, and when, they touch first.
///
/// Time goes from 0, the start, to 1, the end. Vertices move on straight lines at constant speed: at time t a vertex is
/// at (1 - t) start + t end, in exact arithmetic. Elements are closed sets. They may be degenerate or stand still.
/// Two triangles that are apart at the start touch first where a vertex of one touches the other's face, or where two
/// of their edges touch.
///
/// All functions are pure, reentrant and do not allocate; none depends on the caller's floating-point environment.
namespace limber {

struct MovingPoint {
  Vec3 start, end;
};

struct MovingSegment {
  Segment start, end;
};

struct MovingTriangle {
  Triangle start, end;
};

enum class ImpactStatus : std::uint8_t {
  clear,            ///< they do not touch until the largest time
  contact,          ///< they are apart at the start and touch later
  initial_contact,  ///< they touch at the start
};

/// When two elements touch first.
struct ElementImpact {
  ImpactStatus status = ImpactStatus::clear;
  /// The first time at which they touch is in [lower, upper]; they are apart at all times before `lower`. Both are 0
  /// for `initial_contact`, and infinite for `clear`.
  double lower = std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

struct ElementImpactOptions {
  double max_time = 1;    ///< contacts after this time are not looked for; from 0 to 1
  double time_error = 0;  ///< how far `upper` may be above `lower`; 0 for about the rounding of a time, 2^-53
};

/// The first time at which a vertex touches a face.
///
/// Promise  The status is exact, for every input: nothing touches unnoticed, not even for a moment, and whatever is
///          reported touches. lower <= time <= upper, and upper - lower <= max(time_error, 2^-53). Coordinates that are
///          all multiplied by one power of two give the same bits, as long as that rounds none of them.
/// Throws   std::invalid_argument if a coordinate is not finite or above `max_coordinate` in size, if max_time is not
///          in [0, 1], or time_error is negative or not a number.
/// Cost     Some 0.1 us where a filter in float64 decides, some 10 us where exact arithmetic has to.
/// Source   docs/algorithms/impact.md; compare [WangFerguson2021].
LIMBER_API ElementImpact time_of_impact(const MovingPoint& point, const MovingTriangle& triangle,
                                        const ElementImpactOptions& options = {});

/// The first time at which two edges touch. All else as above.
LIMBER_API ElementImpact time_of_impact(const MovingSegment& a, const MovingSegment& b,
                                        const ElementImpactOptions& options = {});

}  // namespace limber
