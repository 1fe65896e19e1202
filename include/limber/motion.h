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
/// All functions are pure and reentrant; none depends on the caller's floating-point environment. Few pairs of elements
/// are left to exact arithmetic, which allocates where its numbers are long.
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
  clear,            ///< they do not touch up to and including the largest time
  contact,          ///< they are apart at the start and touch later
  initial_contact,  ///< they touch at the start
};

/// When two elements touch first.
struct ElementImpact {
  ImpactStatus status = ImpactStatus::clear;
  /// The first time at which they touch is in [lower, upper]. Both are 0 for `initial_contact`, and infinite for
  /// `clear`.
  double lower = std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

struct ElementImpactOptions {
  double max_time = 1;    ///< a first contact after this time does not count; from 0 to 1. `upper` may be after it
  double time_error = 0;  ///< how far `upper` may be above `lower`; never less than the rounding of a time, 2^-53
  /// Elements that are this far apart, or less, touch. 0 asks for exact contact. A greater number may be rounded up, at
  /// each time in another way: by up to 2^-44 of the extent, the largest coordinate of a corner relative to the first
  /// corner at the start. By more for slivers, short edges and nearly parallel edges that are about that near: the
  /// search doubles its tolerance until it ends.
  double min_separation = 0;
};

/// The first time at which a vertex touches a face.
///
/// Promise  With min_separation 0 the status is exact, for every input: no contact is missed, not even one at a single
///          instant, and a reported one is real. Otherwise nothing nearer than the separation is missed. lower <= time
///          <= upper, and upper - lower <= max(time_error, 2^-53). Coordinates and min_separation that are all
///          multiplied by one power of two give the same bits, as long as that rounds none of them.
/// Throws   std::invalid_argument if a coordinate is not finite or above `max_coordinate`, 2^200, in size, if max_time
///          is not in [0, 1], time_error is negative or not a number, or min_separation is not in [0, 2^200].
///          std::bad_alloc from exact arithmetic.
/// Cost     Up to 0.5 us where a filter in float64 decides that nothing touches; some 10 us for a contact; 2 to 40 us
///          on average for degenerate pairs; tens of milliseconds where coordinates span hundreds of binary digits.
///          With a min_separation some 4 us if the elements are clear, 30 us if not.
/// Source   docs/algorithms/impact.md; compare [WangFerguson2021].
LIMBER_API ElementImpact time_of_impact(const MovingPoint& point, const MovingTriangle& triangle,
                                        const ElementImpactOptions& options = {});

/// The first time at which two edges touch. All else as above.
LIMBER_API ElementImpact time_of_impact(const MovingSegment& a, const MovingSegment& b,
                                        const ElementImpactOptions& options = {});

}  // namespace limber
