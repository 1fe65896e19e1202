// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Points of a needle in a ring of tissue: how deep each of them is inside, before and after the tissue gives way.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "limber/limber.h"

namespace {

/// A ring around the z axis, of radius 1 and thickness 0.8. Neighbors share their vertices, so it is closed.
limber::Mesh ring(std::uint32_t slices) {
  std::vector<limber::Vec3> positions;
  std::vector<limber::Corners> triangles;
  for (std::uint32_t j = 0; j < slices; ++j) {
    for (std::uint32_t i = 0; i < slices; ++i) {
      const double around = 2 * std::numbers::pi * i / slices, across = 2 * std::numbers::pi * j / slices;
      const double radius = 1 + 0.4 * std::cos(across);
      positions.push_back({radius * std::cos(around), radius * std::sin(around), 0.4 * std::sin(across)});
      const std::uint32_t next_i = (i + 1) % slices, next_j = (j + 1) % slices;
      const std::uint32_t v = j * slices + i, right = j * slices + next_i;
      const std::uint32_t above = next_j * slices + i, above_right = next_j * slices + next_i;
      triangles.push_back({v, right, above_right});
      triangles.push_back({v, above_right, above});
    }
  }
  return limber::Mesh::create(std::move(positions), std::move(triangles)).value();
}

}  // namespace

int main() {
  limber::Model tissue(ring(48));
  // Closed surfaces have an inside. This is checked once: the tissue may deform afterwards.
  const limber::Result<limber::ClosedSurface> surface = limber::ClosedSurface::create(tissue);
  if (!surface) {
    std::printf("%s\n", surface.error().text.c_str());
    return 1;
  }

  // Points along a needle, from outside to the middle.
  std::vector<limber::Vec3> needle;
  for (int i = 0; i <= 8; ++i) needle.push_back({1.01, 0.02, 0.8 - 0.1 * i});
  const auto count_inside = [&] {
    std::vector<limber::SignedDistance> found(needle.size());
    surface->signed_distance_many(needle, found);  // on all threads
    int inside = 0;
    for (const limber::SignedDistance& point : found) inside += point.is_inside ? 1 : 0;
    const limber::SurfacePoint& tip = *found.back().closest;
    std::printf("%d of %zu points are inside; the tip by %g, next to triangle %u at (%g, %g, %g)\n", inside,
                needle.size(), -found.back().distance(), tip.triangle, tip.position.x, tip.position.y, tip.position.z);
    return inside;
  };
  const int before = count_inside();

  // The tissue gives way. Its surface is the same, so it is still known to be closed.
  std::vector<limber::Vec3> positions = tissue.mesh().positions();
  for (limber::Vec3& p : positions) {
    const double aside = (p.x - 1) * (p.x - 1) + p.y * p.y;
    if (p.z > 0) p.z -= 0.5 * p.z * std::exp(-8 * aside);
  }
  tissue.move_all(positions).value();
  tissue.commit();
  const int after = count_inside();

  // Any triangles, open or not, have a winding number around a point: about 1 inside and 0 outside.
  const double around_tip = limber::generalized_winding_number({tissue}, needle.back());
  const double around_start = limber::generalized_winding_number({tissue}, needle.front());
  std::printf("winding numbers: %g at the tip, %g at the start\n", around_tip, around_start);
  return before > after && after > 0 && std::abs(around_tip - 1) < 1e-9 && std::abs(around_start) < 1e-9 ? 0 : 1;
}
