// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "bvh/tree.h"
#include "limber/distance.h"
#include "limber/math.h"
#include "pair/meter.h"
#include "penetration/last_contact.h"
#include "point/placed_model.h"

namespace limber::penetration {

/// How far b has to move along a direction to leave a, and what it touches last.
struct SweepResult {
  double lower = 0, upper = 0;     ///< as SeparatingTranslation says
  std::optional<Witness> witness;  ///< as SeparatingTranslation says
  Vec3 normal;                     ///< of length 1, from a to b: of the pair of triangles that gives `upper`, if any
  bool is_over = false;  ///< whether the search ended because `lower` reached `enough`; `upper` means nothing then
};

/// Moves b along directions until it leaves a for good.
///
/// Based on  Branch and bound, best first, over pairs of nodes: how far b moves while their volumes may meet.
class Sweep {
 public:
  Sweep(const point::PlacedModel& a, const point::PlacedModel& b);

  /// Pre: the direction has length 1. Ends early once b has to move by `enough` at least.
  SweepResult along(const Vec3& direction, pair::Meter& meter, double enough = std::numeric_limits<double>::infinity());

  /// An upper bound of how much the rounding of placed vertices changes a length.
  double tolerance() const { return error_ / scale_; }

 private:
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
  struct Entry {
    double bound;  // how far b moves at most while the volumes may meet
    bvh::SlotId a, b;
  };

  static bool is_later(const Entry& p, const Entry& q);
  void set_direction(const Vec3& direction);
  Vec3 scaled(const Vec3& world) const { return scale_ * Vec3{dot(x_, world), dot(y_, world), dot(z_, world)}; }
  Projection project(const Side& side, bvh::SlotId slot) const;
  double bound_of(const Projection& a, const Projection& b) const;
  void add(const Entry& entry);
  void expand(const Entry& entry, pair::Meter& meter);
  void compare_leaves(const Entry& entry, pair::Meter& meter);
  void compare(const bvh::Leaf& leaf_a, std::size_t i, const Triangle& a, const bvh::Leaf& leaf_b, std::size_t k,
               const Triangle& b);

  Side a_, b_;
  double scale_;  // a power of two that makes all coordinates less than 1
  double error_;  // of scaled lengths
  Vec3 x_, y_, z_;
  std::vector<Entry> waiting_;  // a heap with the largest bound first
  SweepResult best_;            // lengths are scaled
};

}  // namespace limber::penetration
