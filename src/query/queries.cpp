// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
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

using query::PlacedPair;
using query::Side;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Some pair of triangles that intersects.
class Contact {
 public:
  explicit Contact(const PlacedPair& placed) : placed_(placed) {}

  static constexpr bool any = true;
  std::optional<Witness> witness;

  double cut() const { return std::numeric_limits<double>::min(); }
  bool finished() const { return witness.has_value(); }
  bool apart(TriangleId, TriangleId) const { return false; }
  void compare(TriangleId id_a, TriangleId id_b) {
    const Triangle a = placed_.triangle(Side::a, id_a), b = placed_.triangle(Side::b, id_b);
    if (!intersects(a, b)) return;
    const Vec3 shared = closest_points(a, b).point_a;
    witness = Witness{shared, shared, id_a, id_b};
  }

 private:
  const PlacedPair& placed_;
};

/// The closest pair of triangles, or one near enough.
class Closest {
 public:
  Closest(PlacedPair& placed, const DistanceOptions& options, double enough)
      : placed_(placed), options_(options), enough_(enough), tie_(0x1p-7 * placed.error()) {
    // Closed: a pair exactly max_distance apart matters.
    cut_ = std::max(std::nextafter(options.max_distance, infinity), smallest);
  }

  static constexpr bool any = false;
  double upper = infinity;
  Witness witness{};

  double cut() const { return cut_; }
  bool finished() const { return upper <= enough_; }

  /// Whether the triangles are apart along the way by as much as matters, up to rounding. Triangles that share the
  /// corner or edge the best pair was found at are, exactly, and are many.
  bool apart(TriangleId a, TriangleId b) const {
    if (!placed_.is_aimed()) return false;
    const double gap = placed_.gap_along(a, b);
    // A pair as far apart as the best adds nothing; one as far apart as the limit allows is sought. Contacts always
    // are.
    return gap > placed_.error() && gap >= (upper <= options_.max_distance ? cut_ - tie_ : cut_ + tie_);
  }

  void compare(TriangleId id_a, TriangleId id_b) {
    const ClosestPoints closest = closest_points(placed_.triangle(Side::a, id_a), placed_.triangle(Side::b, id_b));
    LIMBER_ASSERT(closest.distance >= 0);
    if (closest.distance >= upper) return;
    upper = closest.distance;
    witness = {closest.point_a, closest.point_b, id_a, id_b};
    // A pair beyond the limit is no answer, so nothing may be left out for its sake.
    if (upper <= options_.max_distance) {
      const double relative = upper / (1 + options_.relative_error) * rounded_down();
      cut_ = std::max(std::min({cut_, relative, upper - options_.absolute_error}), smallest);
    }
    const Vec3 apart = closest.point_b - closest.point_a;
    const double size = length(apart);
    if (!(size > 0x1p-500)) return;  // too short to have a direction
    placed_.aim(apart * (1 / size));
  }

 private:
  double rounded_down() const { return options_.relative_error == 0 ? 1 : 1 - 0x1p-51; }

  // Contacts matter at any setting, so the cut stays above 0.
  static constexpr double smallest = std::numeric_limits<double>::min();

  PlacedPair& placed_;
  DistanceOptions options_;
  double enough_;
  double tie_;
  double cut_ = infinity;
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
    goal.compare(start.triangle_a(), start.triangle_b());
    if (goal.finished()) return true;
  }
  query::Front* const front = start.front();
  return front != nullptr ? traverse<true>(placed, front, goal, stats) : traverse<false>(placed, nullptr, goal, stats);
}

CollideResult collide_from(const Placed& a, const Placed& b, const Start& start) {
  CollideResult result;
  PlacedPair placed(a, b);
  Contact contact(placed);
  search(a, b, placed, start, contact, result.stats);
  result.collision = contact.witness.has_value();
  result.witness = contact.witness;
  if (contact.witness) start.remember(*contact.witness);
  return result;
}

DistanceResult distance_from(const Placed& a, const Placed& b, const DistanceOptions& options, const Start& start) {
  LIMBER_ASSERT(std::isfinite(options.relative_error) && options.relative_error >= 0);
  LIMBER_ASSERT(std::isfinite(options.absolute_error) && options.absolute_error >= 0);
  LIMBER_ASSERT(options.max_distance >= 0);
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
  LIMBER_ASSERT(std::isfinite(max_distance) && max_distance >= 0);
  WithinResult result;
  PlacedPair placed(a, b);
  Closest closest(placed, {.max_distance = max_distance}, max_distance);
  search(a, b, placed, start, closest, result.stats);
  result.within = closest.upper <= max_distance;
  if (result.within) result.witness = closest.witness, start.remember(closest.witness);
  return result;
}

}  // namespace

CollideResult collide(const Placed& a, const Placed& b) { return collide_from(a, b, Start(nullptr)); }
CollideResult collide(const Placed& a, const Placed& b, Pair& pair) { return collide_from(a, b, Start(&pair)); }

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  return distance_from(a, b, options, Start(nullptr));
}
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, Pair& pair) {
  return distance_from(a, b, options, Start(&pair));
}

WithinResult within(const Placed& a, const Placed& b, double max_distance) {
  return within_from(a, b, max_distance, Start(nullptr));
}
WithinResult within(const Placed& a, const Placed& b, double max_distance, Pair& pair) {
  return within_from(a, b, max_distance, Start(&pair));
}

}  // namespace limber
