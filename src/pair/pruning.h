// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "base/check.h"
#include "base/error_bounds.h"
#include "pair/collectors/collector.h"
#include "pair/node_pair.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"

namespace limber::pair {

/// What is done with ties, pairs that are as far apart as the best one, up to rounding: they are skipped, or compared,
/// so that the answer is the least distance to the bit, whatever pair comes first.
enum class Ties { skipped, compared };

/// What a query prunes, in the words of the whole walk:
///   cutoff            Pairs at least so far apart do not matter: they are pruned, and no answer is among them. It only
///                     shrinks, so all that has been pruned is at least so far apart.
///   prune distance    distance(): the cutoff, or for tiny models a larger distance, which float32 bounds can resolve.
///   limit             The prune distance, squared and in the unit of a tree: SquaredLimits.
///   search direction  The one in which the best pair is apart: most pairs are at least as far apart along it. There is
///                     one once a pair that is apart has been compared.
class Pruning {
 public:
  /// `cutoff` is the first one. Ties are compared in any case while the cutoff is below `compared_below`.
  Pruning(const PlacedPair& placed, double cutoff, Ties ties = Ties::skipped, double compared_below = 0)
      : placed_(placed) {
    if (ties == Ties::skipped) skips_from_ = compared_below;
    in_frame_[0].has_direction = in_frame_[1].has_direction = false;
    set_cutoff(cutoff);
  }

  double cutoff() const { return cutoff_; }
  /// The prune distance.
  double distance() const { return in_frame_[0].distance; }
  bool has_direction() const { return in_frame_[0].has_direction; }
  /// Whether ties are skipped now. Rounding may make a skipped pair a little nearer.
  bool skips_ties() const { return skips_ties_; }

  /// Prune distance and search direction as the kernels need them, in the frame of either model.
  const simd::PruneLimits& of(Side s) const { return in_frame_[index(s)]; }

  /// Takes over what a collector has learnt.
  void update(const BoundUpdate& update) {
    if (update.cutoff < infinity) {
      set_cutoff(std::min(cutoff_, update.cutoff));
      skips_ties_ = may_skip_ties_ && distance() == update.distance;
    }
    const double length = limber::length(update.separation);
    if (length > shortest_separation) set_direction(update.separation * (1 / length));
  }

  /// The search direction, if there is one.
  std::optional<Vec3> direction() const { return has_direction() ? std::optional(direction_) : std::nullopt; }
  /// Goes on with what direction() has returned before.
  void restore_direction(const std::optional<Vec3>& direction) {
    in_frame_[0].has_direction = in_frame_[1].has_direction = false;
    if (direction) set_direction(*direction);
  }

  /// Whether two triangles are so far apart along the search direction that they need not be compared. No contact is
  /// pruned. Triangles that share the corner or edge at which the best pair was found, or lie in the plane of its face,
  /// are ties. They are many, and can improve the answer by no more than rounding: they are pruned while skips_ties().
  bool prunes(PlacedLeaf& a, std::uint32_t slot_a, PlacedLeaf& b, std::uint32_t slot_b) const {
    if (!has_direction()) return false;
    // Negative where they overlap. It is computed from the vertices before they are placed, and off by at most
    // local_gap_error times the error of placing.
    const double gap =
        offset_ - a.support(slot_a, out_of_a_, direction_number_) - b.support(slot_b, out_of_b_, direction_number_);
    if (const std::optional<bool> is_pruned = prunes_gap(gap)) return *is_pruned;
    return prunes_placed(a.at(slot_a).corners, b.at(slot_b).corners);
  }
  /// Whether no pair of triangles of two leaves need be compared, for the same reasons. False proves nothing. If true,
  /// `apart` becomes a lower bound of their distance, or the cutoff if that is larger.
  bool prunes(PlacedLeaf& a, PlacedLeaf& b, double& apart) const {
    if (!has_direction()) return false;
    const double gap = offset_ - a.support(out_of_a_, direction_number_) - b.support(out_of_b_, direction_number_);
    const bool is_pruned = prunes_gap(gap).value_or(false);
    if (is_pruned) apart = std::max(cutoff_, gap - 2 * base::local_gap_error * placed_.error());
    return is_pruned;
  }

 private:
  // A shorter separation has no direction: its square comes near the least float64 number.
  static constexpr double shortest_separation = 0x1p-500;

  void set_cutoff(double cutoff) {
    cutoff_ = std::max(cutoff, std::numeric_limits<double>::min());  // contacts are never pruned
    in_frame_[0].distance = in_frame_[1].distance = std::max(cutoff, simd::smallest_prune_distance);
    may_skip_ties_ = cutoff_ >= skips_from_ && skips_from_ < infinity;
  }

  /// `direction` has length 1, in the world, from a to b.
  void set_direction(const Vec3& direction) {
    LIMBER_ASSERT(std::abs(length_sq(direction) - 1) < 0x1p-40);
    direction_ = direction;
    ++direction_number_;
    out_of_a_ = transpose(placed_.pose(Side::a).rotation) * direction;
    out_of_b_ = transpose(placed_.pose(Side::b).rotation) * -direction;
    simd::PruneLimits &a = in_frame_[0], &b = in_frame_[1];
    a.has_direction = b.has_direction = true;
    for (std::size_t k = 0; k < 3; ++k) {
      a.direction[k] = out_of_a_[k];
      b.direction[k] = out_of_b_[k];
      a.direction32[k] = b.other_direction32[k] = static_cast<float>(out_of_a_[k]);
      b.direction32[k] = a.other_direction32[k] = static_cast<float>(out_of_b_[k]);
    }
    offset_ = dot(direction, placed_.pose(Side::b).translation - placed_.pose(Side::a).translation);
  }

  /// Whether a gap along the search direction prunes; nullopt if rounding could change that. In three ranges:
  ///   - certainly at least the prune distance: the pair is pruned;
  ///   - certainly less: it is not;
  ///   - between the two: it is pruned as a tie if ties are skipped and rounding is small next to the distance.
  /// In all of them a gap of no more than its rounding may hide a contact, and prunes nothing.
  std::optional<bool> prunes_gap(double gap) const {
    const double rounding = base::local_gap_error * placed_.error();
    // Where ties are compared, what is pruned must not even be computed to be nearer: comparing the placed triangles
    // may be off by as much again.
    if (gap >= distance() + (may_skip_ties_ ? 1 : 2) * rounding) return gap > rounding;
    if (gap < distance() - rounding) return false;
    // The rounding up to which a pair counts as a tie: a small part of the distance; or its bound, where placing may
    // round by about that much. Most gaps are off by less: by a small part of the bound, `usual`.
    const double tolerated = std::max(placed_.is_error_tight() ? rounding : 0, base::tie_error * distance());
    const double usual = base::usual_local_gap_part * rounding;
    if (skips_ties_ && rounding <= tolerated && gap >= distance() - usual) return gap > rounding;
    return std::nullopt;
  }

  /// Decides what prunes() does from placed triangles, relative to a corner of one of them, so that an offset that both
  /// share costs no precision.
  bool prunes_placed(const Triangle& a, const Triangle& b) const {
    const Vec3& d = direction_;
    const Vec3 a1 = a.v1 - a.v0, a2 = a.v2 - a.v0, b0 = b.v0 - a.v0, b1 = b.v1 - a.v0, b2 = b.v2 - a.v0;
    const double gap = std::min({dot(d, b0), dot(d, b1), dot(d, b2)}) - std::max({0.0, dot(d, a1), dot(d, a2)});
    const double extent = max_abs(max(max(max(abs(a1), abs(a2)), max(abs(b0), abs(b1))), abs(b2)));
    const double rounding = base::gap_error * extent;
    return gap > rounding && gap >= (skips_ties_ ? distance() - base::usual_gap_error * extent : distance() + rounding);
  }

  const PlacedPair& placed_;
  double cutoff_;
  simd::PruneLimits in_frame_[2];
  double skips_from_ = infinity;  // ties are skipped while the cutoff is at least that
  bool may_skip_ties_ = false;
  bool skips_ties_ = false;  // whether there is an answer, and only a better one matters
  Vec3 direction_, out_of_a_, out_of_b_;
  std::uint32_t direction_number_ = 0;
  double offset_ = 0;  // of b's origin from a's along the search direction
};

/// The prune distance, squared and in the unit of each tree, as bounds of nodes are: the limits.
class SquaredLimits {
 public:
  explicit SquaredLimits(const PlacedPair& placed) : placed_(placed) {
    const double ratio = placed.tree(Side::b).unit / placed.tree(Side::a).unit;
    to_a_sq_[1] = static_cast<float>(std::min(ratio * ratio, largest_unit_ratio_sq));
  }

  /// Takes another prune distance. False if it is the same as before.
  bool update(double distance) {
    LIMBER_ASSERT(distance > 0);
    if (distance == distance_) return false;
    distance_ = distance;
    for (const Side s : {Side::a, Side::b}) {
      const double units = distance / placed_.tree(s).unit;
      const double limit = std::min(units * units * (1 + base::storage_error), double{no_limit_sq});
      // A positive limit never prunes a pair whose bound is 0.
      limit_sq_[index(s)] = std::max(static_cast<float>(limit), std::numeric_limits<float>::min());
    }
    return true;
  }

  /// In squared units of the tree of that side.
  float of(Side s) const { return limit_sq_[index(s)]; }
  /// In those of the bounds of pairs, which are the units of a.
  float of_pairs() const { return of(Side::a); }

  /// Converts the bound of a child from squared units of its tree to those of a, and raises it to that of its parent.
  float bound_of_child(Side s, float order, float parent) const {
    // Stays below `no_limit_sq` even where the product overflows, so that an infinite limit prunes nothing.
    return std::min(std::max(order * to_a_sq_[index(s)], parent), largest_bound_sq);
  }
  /// A bound in squared units of the tree of that side as a length, rounded down.
  double length_of(Side s, float bound_sq) const {
    return std::sqrt(static_cast<double>(bound_sq)) * placed_.tree(s).unit * double{base::squares_down};
  }
  /// The bound of a pair as a length, rounded down.
  double length_of_pair(float bound_sq) const { return length_of(Side::a, bound_sq); }
  /// A length as a bound of a pair, rounded down.
  float bound_of(double length) const {
    const double units = length / placed_.tree(Side::a).unit;
    return static_cast<float>(std::min(units * units * double{base::squares_down}, double{largest_bound_sq}));
  }

 private:
  // Larger squared ratios of units leave the range of float32.
  static constexpr double largest_unit_ratio_sq = 0x1p126;

  const PlacedPair& placed_;
  double distance_ = -1;
  float limit_sq_[2] = {0, 0};
  float to_a_sq_[2] = {1, 1};  // squared units of either tree in those of a
};

/// Candidates with a squared bound of at least this are pruned: their triangles are at least `distance` apart.
inline double limit_sq_of(const simd::Candidates& found, double distance) {
  const double limit = distance * found.scale + static_cast<double>(found.error);
  return limit * limit * double{base::squares_up};
}

}  // namespace limber::pair
