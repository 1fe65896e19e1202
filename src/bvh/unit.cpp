// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/check.h"
#include "base/parallel.h"

namespace limber::bvh {
namespace {

// A bounding box is found in parts, one task each: at least so many triangles in a part, and at most so many parts.
constexpr std::size_t triangles_per_part = 8192, most_parts = 64;

}  // namespace

double unit_for(double size, double magnitude) {
  LIMBER_ASSERT(std::isfinite(size) && std::isfinite(magnitude));
  constexpr double magnitude_resolved = 0x1p-50, smallest_unit = 0x1p-900;
  int exponent = 0;
  // The argument is fraction * 2^exponent with 0.5 <= fraction < 1: itself a power of two if the fraction is 0.5.
  const double fraction = std::frexp(std::max({size, magnitude_resolved * magnitude, smallest_unit}), &exponent);
  return std::ldexp(1, fraction == 0.5 ? exponent - 1 : exponent);
}

BoundingBox bounding_box_of(MeshView mesh) {
  const std::size_t count = mesh.triangles.size();
  const std::size_t size = std::max(triangles_per_part, (count + most_parts - 1) / most_parts);
  std::array<BoundingBox, most_parts> boxes;  // no vector: commits must not allocate
  base::parallel_for_ranges(count, size, [&](std::size_t begin, std::size_t end) {
    BoundingBox box;  // not boxes[i] itself: the compiler keeps a local variable in registers
    for (std::size_t t = begin; t < end; ++t) box.add(mesh.triangle(static_cast<TriangleId>(t)));
    boxes[begin / size] = box;
  });
  BoundingBox all;
  for (const BoundingBox& box : boxes) all.add(box);
  return all;
}

}  // namespace limber::bvh
