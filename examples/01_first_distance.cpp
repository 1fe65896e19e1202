// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Two models, one turned and shifted: distance, witness points, contact.
#include <cstdio>

#include "limber/limber.h"

int main() {
  const std::vector<limber::Vec3> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const limber::Mesh square = limber::Mesh::create(corners, {{0, 1, 2}, {0, 2, 3}}).value();
  const limber::Model table(square), tray(square);

  const limber::Transform above = limber::transform_from_quaternion({0.5, 0, 2}, 1, 0, 0, 0.2).value();
  const limber::DistanceResult near = limber::distance({table}, {tray, above});
  const limber::Witness& w = *near.witness;
  std::printf("%g apart: (%g, %g, %g) on triangle %u and (%g, %g, %g) on triangle %u\n", near.upper, w.point_a.x,
              w.point_a.y, w.point_a.z, w.triangle_a, w.point_b.x, w.point_b.y, w.point_b.z, w.triangle_b);

  const limber::Transform leaning = limber::transform_from_quaternion({0.5, 0, 0.2}, 1, 0.3, 0, 0).value();
  const limber::CollideResult apart = limber::collide({table}, {tray, leaning});
  const limber::Transform dropped = limber::transform_from_quaternion({0.5, 0.2, -0.1}, 1, 0.3, 0, 0).value();
  const limber::CollideResult hit = limber::collide({table}, {tray, dropped});
  if (hit.witness) {
    const limber::Vec3& p = hit.witness->point_a;
    std::printf("touching at (%g, %g, %g)\n", p.x, p.y, p.z);
  }
  return near.upper == 2 && !apart.is_yes() && hit.is_yes() ? 0 : 1;
}
