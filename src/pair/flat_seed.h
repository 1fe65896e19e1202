// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "base/check.h"
#include "bvh/tree.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "pair/placed_pair.h"

namespace limber::pair {

// A guess of the closest pair where one model lies or moves over a flat part of the other, a floor, a wall, the top of
// a table: the vertex nearest to the plane of that part, and the triangle at its foot in the plane. The model with the
// flat part is the ground, and the other one is above it.

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

/// The seed of a traversal where one model is flat: a pair of triangles that is likely to be the closest. It is looked
/// for at the roots first (make_due()), and if these are not flat, once more near the first leaves that were compared
/// (look_near()); find() gives it.
class FlatSeed {
 public:
  void make_due() { state_ = State::due; }
  /// Whether no pair has been looked for next to a flat part so far.
  bool may_look_near() const { return state_ == State::none; }
  /// Makes the seed due near two slots. Pre: may_look_near().
  void look_near(bvh::SlotId a, bvh::SlotId b) {
    LIMBER_ASSERT(may_look_near());
    near_[0] = a, near_[1] = b;
    state_ = State::due;
  }
  bool is_due() const { return state_ == State::due; }

  /// The pair, if there is a flat part. Pre: is_due().
  std::optional<TrianglePair> find(const PlacedPair& placed, QueryStats& stats) {
    LIMBER_ASSERT(is_due());
    const bool is_first = near_[0] == bvh::root_slot && near_[1] == bvh::root_slot;
    const std::optional<FlatPart> part = flat_part(placed, near_[0], near_[1]);
    // Before any triangles have been compared it is worth it only if the models may well be apart.
    const bool is_worth_it = part && (!is_first || part->room >= least_room * part->radius);
    state_ = is_first && !is_worth_it ? State::none : State::done;
    return is_worth_it ? likely_pair(placed, *part, stats) : std::nullopt;
  }

 private:
  enum class State : std::uint8_t { none, due, done };
  // Least gap between a flat part and the other model, in radii of the latter, to look for a pair before any triangles
  // have been compared. Negative: the model's bounds may reach through the flat part. No answer depends on it.
  static constexpr double least_room = -3. / 8;

  State state_ = State::none;
  bvh::SlotId near_[2] = {bvh::root_slot, bvh::root_slot};
};

}  // namespace limber::pair
