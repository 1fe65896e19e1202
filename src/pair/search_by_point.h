// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "base/check.h"
#include "geometry/local_frame.h"
#include "limber/distance.h"
#include "pair/placed_leaf.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"
#include "point/closest_point.h"
#include "point/placed_model.h"

namespace limber::pair {

/// The side of which a model is a single point, as the core of a sphere is; b if both are.
inline std::optional<Side> side_of_point(const PlacedPair& placed) {
  for (const Side s : {Side::b, Side::a}) {
    if (placed.is_triangle(s) && geometry::is_point(placed.local_triangle(s, 0))) return s;
  }
  return std::nullopt;
}

/// Offers a collector of the closest pair the point that a model is, with each triangle of the other model that may be
/// closest to it. They are found as closest points are, but compared as all pairs are. So the answer is that of all
/// pairs, to the bit, and everything that is not compared is at least the cutoff apart, unless the collector is done.
template <typename Collector>
void search_by_point(const PlacedPair& placed, Side of_point, Collector& collector, Pruning& pruning,
                     QueryStats& stats) {
  const PlacedTriangle point = placed_triangle(placed, of_point, 0);
  LIMBER_ASSERT(geometry::is_point(point.corners));
  const Side side = other(of_point);
  const point::PlacedModel model(placed.tree(side), placed.mesh(side), placed.pose(side));
  point::NearestTriangles nearest(model);
  nearest.start(point.corners.v0, pruning.cutoff(), collector.close_enough());
  for (auto found = nearest.next(stats); !found.empty(); found = nearest.next(stats)) {
    for (const point::NearestTriangles::Candidate& candidate : found) {
      if (!nearest.matters(candidate)) continue;
      ++stats.primitive_tests;
      const PlacedTriangle triangle{candidate.id(), placed.triangle(side, candidate.vertices())};
      const auto update = side == Side::a ? collector.compare(triangle, point) : collector.compare(point, triangle);
      if (collector.is_done()) return;
      if (!update) continue;
      pruning.update(*update);
      nearest.lower_limit(pruning.cutoff());
    }
  }
}

}  // namespace limber::pair
