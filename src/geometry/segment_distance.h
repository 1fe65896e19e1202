// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/geometry.h"

namespace limber::geometry {

/// Parameters in [0, 1] of the closest points p0 + s (p1 - p0) of two segments.
///
/// Pre      Coordinates are at most 2^100 in size, so that fourth powers stay finite.
struct SegmentParameters {
  double s, t;
};
SegmentParameters closest_parameters(const Segment& a, const Segment& b);

}  // namespace limber::geometry
