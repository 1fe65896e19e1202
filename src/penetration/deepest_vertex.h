// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "bvh/tree.h"
#include "geometry/local_frame.h"
#include "limber/math.h"
#include "limber/penetration.h"
#include "limber/points.h"
#include "pair/budget_meter.h"
#include "pair/pair_walk.h"
#include "point/closest_point.h"
#include "point/placed_model.h"

namespace limber::penetration {

using geometry::perpendicular_to;
using geometry::unit;

/// The shortest way out of a solid, of length 1, from a position in it to the closest point of its surface: as
/// DeepestVertex::direction says.
Vec3 way_out(const point::PlacedModel& solid, const Vec3& position, const SurfacePoint& closest);

/// Finds the vertex of a model that is deepest inside of a closed one, the solid.
///
/// Based on  Branch and bound, best first. No vertex of a node is deeper than the node's center by more than the radius
///           of its sphere, nor than its distance from any point of the solid's surface.
class DeepestVertexSearch {
 public:
  DeepestVertexSearch(const point::PlacedModel& model, const point::PlacedModel& solid);

  /// Searches until the meter is spent, and keeps what is deepest.
  void run(pair::Meter& meter);

  const std::optional<DeepestVertex>& deepest() const { return best_; }
  /// No vertex is deeper in the solid than this, up to rounding; below 0 if none is in it.
  double upper() const;

 private:
  /// A point, how deep it is in the solid, negative outside, and the closest point of the solid's surface.
  struct Depth {
    Vec3 at;  // in the world
    double depth;
    Vec3 surface;  // in the world
  };
  struct Entry {
    double bound;  // no vertex below the slot is deeper
    bvh::SlotId slot;
    bool is_inside;  // whether all vertices below it are known to be inside
    Vec3 surface;    // a point of the solid's surface near the slot, in the world; none yet for the root

    bool comes_before(const Entry& e) const { return bound != e.bound ? bound > e.bound : slot < e.slot; }
  };

  bool can_win(double bound) const { return bound + error_ >= (best_ ? best_->depth : 0); }
  double radius_of(bvh::SlotId slot) const;
  double reach_from(const Vec3& surface, bvh::SlotId slot) const;
  std::optional<Depth> depth_at(const Entry& entry, pair::Meter& meter);
  void add_children(const Entry& entry, const Depth& center);
  void compare_vertices(const Entry& entry, const Depth& center, pair::Meter& meter);
  void compare(VertexId v, const Vec3& position, double farthest, bool is_inside, pair::Meter& meter);

  const point::PlacedModel &model_, &solid_;
  point::ClosestPointSearch closest_;
  double error_;  // what rounding of placed points can change a length by
  pair::HeapOrder<Entry> waiting_;
  std::vector<bool> is_compared_;
  std::optional<DeepestVertex> best_;
};

/// A point that two bodies have in common, and the largest balls about it in each.
struct CommonBalls {
  Vec3 center;
  double radii = 0;   ///< the sum of both radii
  Vec3 out_a, out_b;  ///< the shortest ways out of both bodies, of length 1
};

/// Looks for balls about a common point of two bodies, as large as possible. Each translation that parts the bodies
/// parts the two balls, so it is at least as long as their radii together.
class CommonBallsSearch {
 public:
  CommonBallsSearch(const point::PlacedModel& a, const point::PlacedModel& b);

  /// The balls about a point; nothing if it is not in both bodies.
  std::optional<CommonBalls> at(const Vec3& point, pair::Meter& meter);

  /// Goes uphill from a point while that makes the balls larger. The first step is at most `reach` long.
  void climb(const Vec3& start, double reach, pair::Meter& meter);

  const std::optional<CommonBalls>& best() const { return best_; }

 private:
  const point::PlacedModel &a_, &b_;
  point::ClosestPointSearch closest_a_, closest_b_;
  std::optional<CommonBalls> best_;
};

}  // namespace limber::penetration
