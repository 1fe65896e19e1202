// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/mesh.h"
#include "limber/query.h"

/// Brute-force twins of every query: each triangle of one mesh against each of the other, no tree and no tricks.
///
/// They are what every engine is tested against, and share the semantics of query.h.
namespace limber::reference {

struct Placed {
  MeshView mesh;
  Transform pose{};  ///< world_from_model
};

/// Whether the meshes meet, with the first intersecting pair in the order of ids.
///
/// Pre      Both meshes are sound.
/// Throws   std::invalid_argument unless both poses are rigid; distance() and within() also for bad options.
/// Cost     O(n m).
/// Threads  Reentrant.
CollideResult collide(const Placed& a, const Placed& b);

/// Shortest distance, with the first pair in the order of ids that attains it.
///
/// The exact answer serves any error, so of the options only `max_distance` makes a difference.
/// Cost     O(n m).
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options = {});

/// Whether the meshes are at most `max_distance` apart, with the closest pair.
///
/// Cost     O(n m).
WithinResult within(const Placed& a, const Placed& b, double max_distance);

}  // namespace limber::reference
