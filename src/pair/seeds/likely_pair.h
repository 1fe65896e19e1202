// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "bvh/tree.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "pair/placed_pair.h"

namespace limber::pair {

/// A part of a model that is flat for as far as the other one reaches: a floor, a wall, the top of a table.
struct FlatPart {
  Side side;      ///< whose part it is
  Vec3 center;    ///< in the world
  Vec3 normal;    ///< towards the other model, in the world
  double room;    ///< between it and the bounding volume of the other model, along the normal; negative if they overlap
  double radius;  ///< of that volume
};

/// The largest flat part of the larger model around a slot of its tree; none if the slot itself is not flat, or if all
/// flat ones are smaller than the other model.
std::optional<FlatPart> flat_part(const PlacedPair& placed, bvh::SlotId near_a, bvh::SlotId near_b);

/// A pair of triangles that is likely to be the closest: a triangle of the other model at the vertex that comes nearest
/// to the plane of a flat part, and one at the foot of that vertex. None if the vertex is beyond the plane.
///
/// A guess, made in a fixed number of steps at most: neither triangle need be exactly the one described.
std::optional<TrianglePair> likely_pair(const PlacedPair& placed, const FlatPart& part, QueryStats& stats);

}  // namespace limber::pair
