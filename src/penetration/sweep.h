// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "bvh/tree.h"
#include "limber/distance.h"
#include "limber/geometry.h"
#include "limber/math.h"
#include "pair/budget_meter.h"
#include "pair/pair_walk.h"
#include "point/placed_model.h"

namespace limber::penetration {

/// When two triangles meet last, if the second one moves along z: an interval of how far it has moved then.
struct LastContact {
  static constexpr double never = -std::numeric_limits<double>::infinity();

  double upper = never;  ///< having moved by more than this, they do not meet
  double lower = never;  ///< having moved by this, they meet, up to the tolerance; `never` if no such move was found
  Vec3 normal;           ///< of the plane that keeps them apart from `upper` on, towards the second one
  Vec3 weights_a, weights_b;  ///< of the corners, for the points that meet at `lower`
};

/// Bounds how far b has to move along z to leave a. Fills all but `lower` and the weights. Ends early once the bound is
/// not above `least`.
///
/// Promise  `upper` holds for all triangles whose corners are within a third of `error` of these. It exceeds the truth
///          by little more than `error`, unless all planes are steep, also where the triangles are segments or points.
/// Pre      Coordinates are at most about 1 in size, and `error` is at least 2^-46.
LastContact bound_last_contact(const Triangle& a, const Triangle& b, double error, double least = LastContact::never);

/// Fills `lower` and the weights: finds the last points that meet within a tolerance across z.
void find_last_contact(const Triangle& a, const Triangle& b, double tolerance, LastContact& contact);

/// How far b has to move along a direction to leave a, and what it touches last.
struct SweepResult {
  double lower = 0, upper = 0;     ///< as SeparatingTranslation says
  std::optional<Witness> witness;  ///< as SeparatingTranslation says
  Vec3 normal;           ///< of length 1, from a to b: of the pair of triangles that raised `upper` last, if any
  bool is_over = false;  ///< whether the search ended because `lower` reached `enough`; `upper` means nothing then
};

/// Moves b along directions until it leaves a for good: a PairWalk, best first, whose bounds and visitor it is.
///
/// Based on  Branch and bound over pairs of nodes: how far b moves while their volumes may meet.
class Sweep {
  /// A volume as the sweep sees it, in scaled coordinates whose z is along the direction.
  struct Projection {
    Vec3 center;
    double radius, half_x, half_y;  // across the direction
    double up, down;                // how far it reaches along the direction, and against it
  };
  /// A model's axes, in its own frame, for the direction of the sweep.
  struct Side {
    const point::PlacedModel* model;
    Vec3 x, y, z;
  };

 public:
  Sweep(const point::PlacedModel& a, const point::PlacedModel& b);

  /// Pre: the direction has length 1. Ends early once b has to move by `enough` at least.
  SweepResult along(const Vec3& direction, pair::Meter& meter, double enough = std::numeric_limits<double>::infinity());

  /// An upper bound of how much the rounding of placed vertices changes a length.
  double tolerance() const { return error_ / scale_; }

  // What PairWalk asks.
  struct Pair {
    double bound;  // how far b moves at most while the volumes may meet
    bvh::SlotId a, b;

    bool comes_before(const Pair& p) const { return bound != p.bound ? bound > p.bound : a != p.a ? a < p.a : b < p.b; }
  };
  /// The larger volume is replaced by its children.
  struct Expansion {
    Pair pair;
    bool opens_a;
    std::uint32_t node;
    Projection other;  // of the volume that stays
    double bounds[bvh::width];
    struct {
      unsigned all;
    } kept;
  };
  /// A budget that is spent makes `upper` what no pair that is left exceeds.
  bool has_to_end() {
    if (!(waiting_.next().bound > best_.upper) || best_.lower >= enough_) return true;
    if (!meter_->is_spent()) return false;
    best_.upper = waiting_.next().bound;
    return true;
  }
  static constexpr void count_step() {}
  static constexpr bool prepare_visit(const Pair&) { return false; }
  static constexpr bool prunes(const Pair&, double&) { return false; }
  bool are_leaves(const Pair& pair) const { return is_leaf(a_, pair.a) && is_leaf(b_, pair.b); }
  template <bool raises>
  pair::Next open(Expansion& e, double&) const;
  void bound_children(Expansion& e, float*) const;
  Pair child_pair(const Expansion& e, std::uint32_t child) const {
    const bvh::SlotId slot = e.node * bvh::width + child;
    return {e.bounds[child], e.opens_a ? slot : e.pair.a, e.opens_a ? e.pair.b : slot};
  }
  bool compare(const Pair& pair, bool, double&);

 private:
  static bool is_leaf(const Side& side, bvh::SlotId slot) {
    return bvh::has_leaf_or_coincides(side.model->tree(), slot);
  }
  void set_direction(const Vec3& direction);
  Vec3 scaled(const Vec3& world) const { return scale_ * Vec3{dot(x_, world), dot(y_, world), dot(z_, world)}; }
  Projection project(const Side& side, bvh::SlotId slot) const;
  double bound_of(const Projection& a, const Projection& b) const;
  void compare(const bvh::Leaf& leaf_a, std::size_t i, const Triangle& a, const bvh::Leaf& leaf_b, std::size_t k,
               const Triangle& b);

  Side a_, b_;
  double scale_;  // a power of two: coordinates of a and of b are together less than 1 in size
  double error_;  // at least three times what rounding moves a placed corner by; scaled
  Vec3 x_, y_, z_;
  pair::HeapOrder<Pair> waiting_;
  SweepResult best_;   // lengths are scaled
  double enough_ = 0;  // scaled
  pair::Meter* meter_ = nullptr;
};

}  // namespace limber::penetration
