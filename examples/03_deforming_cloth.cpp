// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A cloth whose vertices move in every frame: all of them, from a float32 buffer, or a few by their ids.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "limber/distance.h"
#include "shapes.h"

namespace {

/// The cloth at a time: waves run along it. Three float32 a vertex, as renderers and simulations keep them.
std::vector<float> simulated(const limber::Mesh& at_rest, double time) {
  std::vector<float> coordinates;
  for (const limber::Vec3& p : at_rest.positions()) {
    coordinates.push_back(static_cast<float>(p.x));
    coordinates.push_back(static_cast<float>(p.y));
    coordinates.push_back(static_cast<float>(0.2 * std::sin(3 * p.x - 4 * time)));
  }
  return coordinates;
}

}  // namespace

int main() {
  const limber::Mesh at_rest = shapes::sheet(80, 6);
  limber::Model cloth(at_rest);
  const limber::Model ball(shapes::ball(32));
  const limber::Transform pose{{}, {0.5, 0, 1.4}};

  limber::QueryCache cache;  // each query starts from what the last one found
  double nearest = 1e9, largest_difference = 0;
  for (int frame = 0; frame < 60; ++frame) {
    const std::vector<float> coordinates = simulated(at_rest, 0.05 * frame);
    cloth.move_all(limber::PositionsView::packed(coordinates)).value();
    cloth.commit();
    const limber::DistanceResult gap = limber::distance({cloth}, {ball, pose}, {.cache = &cache});

    const limber::Model built_anew(cloth.mesh());  // what the answer has to be
    const double expected = limber::distance({built_anew}, {ball, pose}).upper;
    nearest = std::min(nearest, gap.upper);
    largest_difference = std::max(largest_difference, std::abs(gap.upper - expected));
  }
  std::printf("nearest %g; %llu nodes refitted\n", nearest,
              static_cast<unsigned long long>(cloth.maintenance_stats().refits));

  // One vertex is pulled through the ball; an id that does not exist would be an error, and nothing would move.
  const limber::VertexId middle = 40 * 81 + 40;
  cloth.move_vertices(std::vector{middle}, std::vector{limber::Vec3{0, 0, 3}}).value();
  cloth.commit();
  const limber::CollideResult hit = limber::collide({cloth}, {ball, pose});
  if (hit.witness) std::printf("triangle %u of the cloth touches the ball\n", hit.witness->triangle_a);

  const limber::Result<void> refused = cloth.move_vertices(std::vector{999'999U}, std::vector{limber::Vec3{}});
  if (!refused) std::printf("refused: %s\n", refused.error().text.c_str());
  return largest_difference < 1e-12 && hit.is_yes() && !refused ? 0 : 1;
}
