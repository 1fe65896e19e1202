// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Points of a needle in a ball of tissue: how deep each of them is inside, before and after the tissue gives way.
#include <cmath>
#include <cstdio>
#include <vector>

#include "limber/limber.h"
#include "shapes.h"

int main() {
  limber::Model tissue(shapes::ball(48));
  // Closed surfaces have an inside. This is checked once: the tissue may deform afterwards.
  const limber::Result<limber::ClosedSurface> surface = limber::ClosedSurface::create(tissue);
  if (!surface) {
    std::printf("%s\n", surface.error().text.c_str());
    return 1;
  }

  // Points along a needle, from outside to the middle.
  std::vector<limber::Vec3> needle;
  for (int i = 0; i <= 8; ++i) needle.push_back({0.01, 0.02, 1.2 - 0.15 * i});
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
    if (p.z > 0) p.z -= 0.5 * p.z * std::exp(-8 * (p.x * p.x + p.y * p.y));
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
