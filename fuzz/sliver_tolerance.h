// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "fuzz/coordinates.h"
#include "limber/geometry.h"

namespace limber::fuzz {

/// The smallest height of a triangle as a part of `size`. Edges are divided first, so no product vanishes or overflows.
inline double relative_height(const Triangle& t, double size) {
  const Vec3 p = scaled(t.v1 - t.v0, 1 / size), q = scaled(t.v2 - t.v0, 1 / size);
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

}  // namespace limber::fuzz
