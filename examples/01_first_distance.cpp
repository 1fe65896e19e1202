// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Two models, one turned and shifted, one bending: distance, error bound, contact.
#include <cstdio>

#include "limber/limber.h"

int main() {
  using limber::classic::Model;
  const std::vector<limber::Vec3> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const limber::Mesh square = limber::Mesh::create(corners, {{0, 1, 2}, {0, 2, 3}}).value();
  const Model table(square);
  Model cloth(square);

  const limber::Transform above = limber::transform_from_quaternion({0, 0, 2}, 1, 0, 0, 0).value();
  const auto near = limber::classic::distance({table}, {cloth, above});
  std::printf("%g apart, triangles %u and %u\n", near.upper, near.witness.triangle_a, near.witness.triangle_b);

  cloth.move_vertices(std::vector<limber::VertexId>{2}, std::vector<limber::Vec3>{{1, 1, -1.5}}).value();
  cloth.commit();
  const auto soon = limber::classic::distance({table}, {cloth, above}, {.relative_error = 0.1});
  std::printf("between %g and %g apart\n", soon.lower, soon.upper);

  const limber::Transform lower{{}, {0, 0, 1.5}};
  const auto hit = limber::classic::collide({table}, {cloth, lower});
  if (hit.witness)
    std::printf("touching at (%g, %g, %g)\n", hit.witness->point_a.x, hit.witness->point_a.y, hit.witness->point_a.z);
  return near.upper == 2 && soon.upper <= 0.55 && hit.collision ? 0 : 1;
}
