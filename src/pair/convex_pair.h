// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "limber/base.h"
#include "limber/distance.h"
#include "limber/math.h"
#include "model/convex_parts.h"
#include "pair/convex_start.h"
#include "pair/placed_pair.h"

namespace limber::pair {

/// A corner of the Minkowski difference of two cores, b less a: the way from a corner of a to one of b.
struct DifferenceCorner {
  Vec3 way;
  std::uint32_t a, b;
};

/// The Minkowski difference of the placed cores of two convex bodies. It contains the origin if and only if they meet.
///
/// Frame    World, in units: lengths times a power of two, so that products of six of them do not leave float64.
class ConvexDifference {
 public:
  ConvexDifference(const PlacedPair& placed, const model::ConvexParts& a, const model::ConvexParts& b);

  const model::ConvexParts& parts(Side s) const { return s == Side::a ? a_ : b_; }
  DifferenceCorner corner(std::uint32_t a, std::uint32_t b) const;
  /// The corner that is lowest along a direction, as far as climbing finds it; from the corners that were found last.
  DifferenceCorner lowest(const Vec3& direction);
  /// The height of the lowest of all corners along a direction of length 1.
  double least_height(const Vec3& direction) const;
  /// From the middle of a to that of b.
  Vec3 between_centers() const;
  /// Where climbing starts.
  void start_at(std::uint32_t a, std::uint32_t b) { last_a_ = a, last_b_ = b; }

  double units(double length) const { return length * scale_; }
  double from_units(double units) const { return units / scale_; }
  /// What rounding of placed corners and of their heights can change a height by: a part of both magnitudes.
  double rounding() const { return rounding_; }

 private:
  Vec3 turned(Side s, const Vec3& v) const { return (s == Side::a ? pose_a_ : pose_b_).rotation * v; }

  const model::ConvexParts &a_, &b_;
  const Transform &pose_a_, &pose_b_;
  Mat3 back_a_, back_b_;
  Vec3 translation_;  // from a to b
  double scale_, rounding_;
  std::uint32_t last_a_ = 0, last_b_ = 0;
};

/// Up to four corners of the difference, and the point of their hull that is nearest to the origin.
struct Simplex {
  std::array<DifferenceCorner, 4> corners;
  std::array<double, 4> weights;  // of the nearest point
  std::uint32_t count = 0;
  Vec3 direction;       // from the origin to the nearest point, of length 1
  double distance = 0;  // 0 where the hull has the origin
};

/// What is known of the distance of the cores of two convex bodies.
struct ConvexGap {
  double lower = 0;     ///< no two points are closer, whatever rounding has done
  double height = 0;    ///< the gap along a direction, rounded: `lower` before it was lowered for rounding
  double rounding = 0;  ///< by how much a distance may exceed `height`, if they are one number but for rounding
  TriangleId a = no_id, b = no_id;  ///< triangles that have the closest points, if these were found
};

/// Finds the nearest point of up to four corners, and leaves those that it is between. False if the hull has the
/// origin.
bool reduce(Simplex& simplex);

/// The nearest point as one of a core, in the frame of its model, and a triangle that has it.
Vec3 point_of(const model::ConvexParts& parts, const Simplex& simplex, Side side);
TriangleId triangle_at(const model::ConvexParts& parts, const Simplex& simplex, Side side);

/// Searches for the closest points of two cores by supports.
///
/// Based on  GJK [GilbertJohnsonKeerthi1988], with the lower bound of each step as in [VanDenBergen2001].
/// Differs   The direction of a step is perpendicular to the nearest face or edge, by a cross product or a second
///           projection: so it has all digits also where bodies nearly touch. A bound counts once all corners have
///           been looked at, so that nothing depends on the bodies being convex to the last bit.
class ConvexSearch {
 public:
  explicit ConvexSearch(ConvexDifference& difference) : difference_(difference) {}

  /// Ends when the lower bound is `enough`, or no step brings the origin closer. `start` may be of other bodies. Where
  /// bodies overlap deeply along their centers, it `may_give_up` at once: another search finds a contact sooner.
  void run(double enough, const ConvexStart& start, bool may_give_up, QueryStats& stats);

  /// The best proven height, in units; 0 if there is none.
  double height() const { return height_; }
  const Vec3& direction() const { return best_direction_; }
  bool is_over() const { return is_over_; }
  /// Whether the hull of the simplex has the origin, as far as rounding tells.
  bool meets() const { return simplex_.distance <= difference_.rounding(); }
  const Simplex& simplex() const { return simplex_; }

 private:
  void prove();

  ConvexDifference& difference_;
  Simplex simplex_;
  Vec3 best_direction_;
  double best_height_ = 0, height_ = 0;
  bool is_over_ = false;
};

/// Searches for the gap of two bodies that are known to be convex; 0 if they are not. With a budget that may end the
/// query, it does not search. Where the gap is `enough`, the triangles are not named.
ConvexGap find_gap(const Placed& a, const Placed& b, const PlacedPair& placed, double enough, const QueryBudget& budget,
                   QueryCache* cache, QueryStats& stats);

}  // namespace limber::pair
