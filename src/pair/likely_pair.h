// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "bvh/tree.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "pair/placed_pair.h"

namespace limber::pair {

// A guess of the closest pair where one model lies or moves over a flat part of the other, a floor, a wall, the top of
// a table: the vertex nearest to the plane of that part, and the triangle at its foot in the plane. Below, the model
// with the flat part is the ground, and the other one is above it.

/// A part of a model that is flat for as far as the other one reaches.
struct FlatPart {
  Side side;      ///< the ground: the model that has this part
  Vec3 center;    ///< in the world
  Vec3 normal;    ///< towards the other model, in the world
  double radius;  ///< of the bounding sphere of the other model
  double room;  ///< from the part to the bounding volume of the other model, along the normal; negative if they overlap
};

/// The largest flat part of the larger model: its slot, `near_a` or `near_b`, or one above that slot. None if the slot
/// itself is not flat, or if all flat ones are smaller than the other model.
std::optional<FlatPart> flat_part(const PlacedPair& placed, bvh::SlotId near_a, bvh::SlotId near_b);

/// A pair of triangles that is likely to be the closest: a triangle of the other model at the vertex that comes nearest
/// to the plane of a flat part, and one at the foot of that vertex. None if the vertex is beyond the plane.
///
/// Both searches end after a fixed number of nodes, so neither triangle need be exactly the one described.
std::optional<TrianglePair> likely_pair(const PlacedPair& placed, const FlatPart& part, QueryStats& stats);

}  // namespace limber::pair
