// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "core/float_environment.h"
#include "geometry/primitives.h"
#include "query/options.h"
#include "query/traversal.h"

namespace limber {

Pair::Pair() = default;
Pair::Pair(Pair&&) noexcept = default;
Pair& Pair::operator=(Pair&&) noexcept = default;
Pair::~Pair() = default;

/// Where a query starts: what the last one left in a Pair, if there is one.
class Start {
 public:
  explicit Start(Pair* pair) : pair_(pair) {}

  /// Whether there are triangles to start with.
  bool known(const Placed& a, const Placed& b) const {
    return pair_ != nullptr && pair_->triangle_a_ < a.model.mesh().triangles().size() &&
           pair_->triangle_b_ < b.model.mesh().triangles().size();
  }
  TriangleId triangle_a() const { return pair_->triangle_a_; }
  TriangleId triangle_b() const { return pair_->triangle_b_; }
  void remember(const Witness& witness) const {
    if (pair_ != nullptr) pair_->triangle_a_ = witness.triangle_a, pair_->triangle_b_ = witness.triangle_b;
  }

  query::Front* front() const {
    if (pair_ == nullptr) return nullptr;
    if (pair_->front_ == nullptr) pair_->front_ = std::make_unique<query::Front>();
    return pair_->front_.get();
  }

 private:
  Pair* pair_;
};

namespace {

using query::PlacedLeaf;
using query::PlacedPair;
using query::PlacedTriangle;
using query::Side;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Some pair of triangles that intersects.
class Contact {
 public:
  static constexpr bool any = true;
  std::optional<Witness> witness;

  double cut() const { return std::numeric_limits<double>::min(); }
  bool finished() const { return witness.has_value(); }
  bool is_apart(PlacedLeaf&, std::uint32_t, PlacedLeaf&, std::uint32_t) const { return false; }
  void compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (!geometry::intersects(a.corners, b.corners)) return;
    const Vec3 shared = geometry::closest_points(a.corners, b.corners).point_a;
    witness = Witness{shared, shared, a.id, b.id};
  }
};

/// The closest pair of triangles, or one near enough.
class Closest {
 public:
  Closest(PlacedPair& placed, const DistanceOptions& options, double enough)
      : placed_(placed), options_(options), enough_(enough) {
    // Closed: a pair exactly max_distance apart matters.
    cut_ = std::max(std::nextafter(options.max_distance, infinity), smallest);
  }

  static constexpr bool any = false;
  double upper = infinity;
  Witness witness{};

  double cut() const { return cut_; }
  bool finished() const { return upper <= enough_; }

  /// Whether two triangles are so far apart along the direction in which the best pair is closest that they cannot
  /// matter.
  ///
  /// Triangles that share the corner or edge at which the best pair was found, or its plane, are as far apart as the
  /// best up to rounding. They are many and can improve the answer by no more than that, so where the distance itself
  /// is asked for they are not compared. A pair that may be within a limit always is, and so is every contact.
  bool is_apart(PlacedLeaf& a, std::uint32_t lane_a, PlacedLeaf& b, std::uint32_t lane_b) const {
    if (!placed_.is_aimed()) return false;
    const double gap = placed_.gap_along(a.id(lane_a), b.id(lane_b)), rounding = placed_.rounding_of_gap();
    if (gap >= cut_ + rounding) return gap > rounding;
    if (gap < cut_ - rounding) return false;
    // As far apart as the best, or as the limit allows.
    const double harmless = std::max(placed_.rounding_of_placing(), tie_of_distances * cut_);
    if (may_tie_ && rounding <= harmless && gap >= cut_ - usual_part * rounding) return gap > rounding;
    return is_apart(a.at(lane_a).corners, b.at(lane_b).corners);
  }

  void compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    const ClosestPoints closest = geometry::closest_points(a.corners, b.corners);
    LIMBER_ASSERT(closest.distance >= 0);
    if (closest.distance >= upper) return;
    upper = closest.distance;
    witness = {closest.point_a, closest.point_b, a.id, b.id};
    // A pair beyond the limit is no answer, so nothing may be left out for its sake.
    if (upper <= options_.max_distance) {
      const double relative = upper / (1 + options_.relative_error) * rounded_down();
      cut_ = std::max(std::min({cut_, relative, upper - options_.absolute_error}), smallest);
      may_tie_ = cut_ == upper;
    }
    const Vec3 apart = closest.point_b - closest.point_a;
    const double size = length(apart);
    if (!(size > 0x1p-500)) return;  // too short to have a direction
    direction_ = apart * (1 / size);
    placed_.aim(direction_);
  }

 private:
  /// The same for placed triangles, relative to a corner of one of them: an offset that they share costs nothing.
  bool is_apart(const Triangle& a, const Triangle& b) const {
    const Vec3& d = direction_;
    const Vec3 a1 = a.v1 - a.v0, a2 = a.v2 - a.v0, b0 = b.v0 - a.v0, b1 = b.v1 - a.v0, b2 = b.v2 - a.v0;
    const double gap = std::min({dot(d, b0), dot(d, b1), dot(d, b2)}) - std::max({0.0, dot(d, a1), dot(d, a2)});
    const double extent = max_abs(max(max(max(abs(a1), abs(a2)), max(abs(b0), abs(b1))), abs(b2)));
    const double rounding = rounding_of_gaps * extent;
    return gap > rounding && gap >= (may_tie_ ? cut_ - tie_of_gaps * extent : cut_ + rounding);
  }

  double rounded_down() const { return options_.relative_error == 0 ? 1 : 1 - 0x1p-51; }

  // What rounding can make of a gap between placed triangles, and of the distance it is compared with, as a part of
  // their extent: with u = 2^-53, heights are off by 7 u each (four roundings, a length of sqrt(3)), a direction whose
  // length is 1 up to 5 u adds 9 u, and closest_points() is off by at most 8 u.
  static constexpr double rounding_of_gaps = 0x1p-47;
  // What it usually makes of the gap of a pair with the same closest features as the best, of the extent and of
  // PlacedPair::rounding_of_gap(). Pairs whose gap is off by more are compared, which costs time only.
  static constexpr double tie_of_gaps = 0x1p-51, usual_part = 0x1p-3;
  // Rounding of this part of the distance may decide which of many equal pairs is the answer.
  static constexpr double tie_of_distances = 0x1p-45;

  // Contacts matter at any setting, so the cut stays above 0.
  static constexpr double smallest = std::numeric_limits<double>::min();

  PlacedPair& placed_;
  DistanceOptions options_;
  double enough_;
  double cut_ = infinity;
  bool may_tie_ = false;  // whether there is an answer, and only a better one matters
  Vec3 direction_;  // from a to b where the best pair is closest
};

/// Compares everything that matters. Returns whether something was left out.
template <bool records, typename Goal>
bool traverse(PlacedPair& placed, query::Front* front, Goal& goal, QueryStats& stats) {
  ++stats.node_tests;
  const double root_bound = placed.root_bound();
  if (root_bound >= goal.cut()) return true;
  query::Traversal<Goal, records> traversal(placed, goal, stats);
  traversal.start(root_bound, front);
  while (traversal.step()) {
  }
  traversal.finish();
  if (placed.slack() > 0) placed.pay(traversal.due_to_slack());
  return traversal.dropped();
}

/// The same, after what the start knows.
template <typename Goal>
bool search(const Placed& a, const Placed& b, PlacedPair& placed, const Start& start, Goal& goal, QueryStats& stats) {
  if (start.known(a, b)) {
    ++stats.triangle_tests;
    const TriangleId id_a = start.triangle_a(), id_b = start.triangle_b();
    goal.compare({id_a, placed.triangle(Side::a, id_a)}, {id_b, placed.triangle(Side::b, id_b)});
    if (goal.finished()) return true;
  }
  query::Front* const front = start.front();
  return front != nullptr ? traverse<true>(placed, front, goal, stats) : traverse<false>(placed, nullptr, goal, stats);
}

CollideResult collide_from(const Placed& a, const Placed& b, const Start& start) {
  CollideResult result;
  PlacedPair placed(a, b);
  Contact contact;
  search(a, b, placed, start, contact, result.stats);
  result.collision = contact.witness.has_value();
  result.witness = contact.witness;
  if (contact.witness) start.remember(*contact.witness);
  return result;
}

DistanceResult distance_from(const Placed& a, const Placed& b, const DistanceOptions& options, const Start& start) {
  query::check_options(options);
  DistanceResult result;
  PlacedPair placed(a, b);
  Closest closest(placed, options, 0);
  const bool dropped = search(a, b, placed, start, closest, result.stats);
  if (closest.upper > options.max_distance) {
    result.upper = infinity;
    result.lower = options.max_distance;
    result.status = Status::beyond_limit;
    return result;
  }
  start.remember(closest.witness);
  result.upper = closest.upper;
  result.lower = dropped ? std::min(closest.upper, closest.cut()) : closest.upper;
  result.witness = closest.witness;
  result.status = result.upper == 0              ? Status::collision
                  : result.lower == result.upper ? Status::exact
                                                 : Status::within_error;
  return result;
}

WithinResult within_from(const Placed& a, const Placed& b, double max_distance, const Start& start) {
  query::check_max_distance(max_distance);
  WithinResult result;
  PlacedPair placed(a, b);
  Closest closest(placed, {.max_distance = max_distance}, max_distance);
  search(a, b, placed, start, closest, result.stats);
  result.within = closest.upper <= max_distance;
  if (result.within) result.witness = closest.witness, start.remember(closest.witness);
  return result;
}

}  // namespace

CollideResult collide(const Placed& a, const Placed& b) {
  const core::DefaultFloatEnvironment environment;
  return collide_from(a, b, Start(nullptr));
}
CollideResult collide(const Placed& a, const Placed& b, Pair& pair) {
  const core::DefaultFloatEnvironment environment;
  return collide_from(a, b, Start(&pair));
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  const core::DefaultFloatEnvironment environment;
  return distance_from(a, b, options, Start(nullptr));
}
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, Pair& pair) {
  const core::DefaultFloatEnvironment environment;
  return distance_from(a, b, options, Start(&pair));
}

WithinResult within(const Placed& a, const Placed& b, double max_distance) {
  const core::DefaultFloatEnvironment environment;
  return within_from(a, b, max_distance, Start(nullptr));
}
WithinResult within(const Placed& a, const Placed& b, double max_distance, Pair& pair) {
  const core::DefaultFloatEnvironment environment;
  return within_from(a, b, max_distance, Start(&pair));
}

}  // namespace limber
