// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "core/check.h"
#include "core/error_bounds.h"
#include "query/placed_models.h"

namespace limber::query {

/// What a traversal has pruned, and how far the models may move before that has to be compared again.
///
/// Based on  Front tracking [EhmannLin2001]: the frontier of the last traversal is where the next one starts.
/// Differs   The front is not compared as a whole. odometer() sums up all motion, as an upper bound of what two
///           points can have come closer by; a pruned pair is not compared again until that sum has used up its
///           distance.
///
/// A record is one expansion: the wide node that was expanded, the slot of the other tree that its children were
/// compared with, the children that were pruned, and a lower bound of their distance. The other children have been
/// expanded and have records of their own, so all records together account for every pair of triangles.
///
/// States   Empty, recording or complete. start() empties it and starts to record; resume() continues to record on a
///          complete front; finish() completes it, or empties it if that is not worthwhile. An exception leaves it
///          recording, and only a complete front can be resumed.
class Front {
 public:
  struct Record {
    double valid_until;  ///< its children stay pruned while odometer() + prune distance is at most that
    bvh::SlotId slot[2];
    bool expands_a;
    std::uint8_t pruned;  ///< bit mask of children
  };
  static constexpr std::uint16_t none = 0xffff;

  /// Whether the last traversal that it recorded was one of these models, and has ended.
  bool can_resume(const PlacedModels& placed) const {
    return is_complete_ && count_ > 0 && assignment_id_[0] == placed.tree(Side::a).assignment_id &&
           assignment_id_[1] == placed.tree(Side::b).assignment_id;
  }

  /// Starts to record a traversal of the models as they are placed.
  void start(const PlacedModels& placed, const Transform& a_from_b) {
    clear();
    for (const Side s : {Side::a, Side::b}) assignment_id_[index(s)] = placed.tree(s).assignment_id;
    set_place(placed, a_from_b);
  }

  /// Adds the motion from where the models were to where they are. Pre: can_resume(placed).
  void resume(const PlacedModels& placed, const Transform& a_from_b) {
    LIMBER_ASSERT(can_resume(placed));
    const double deformation = deformation_of(placed) - deformation_, rounding = deformation_ * (core::sum_up - 1);
    odometer_ += placed.max_displacement(a_from_b_, error_, a_from_b) + deformation + rounding;
    odometer_ *= core::sum_up;
    set_place(placed, a_from_b);
    expansions_ = 0;
    is_complete_ = false;
  }
  double odometer() const { return odometer_; }

  void clear() {
    count_ = 0, expansions_ = 0, first_expansions_ = 0;
    odometer_ = 0;
    is_complete_ = false;
  }

  /// Ends a traversal; `complete` says whether every pair was compared or pruned, and recorded. A front that saves
  /// little next to a new traversal is dropped.
  void finish(bool complete) {
    if (first_expansions_ == 0) first_expansions_ = expansions_;
    const bool is_new = expansions_ == first_expansions_;
    const bool is_worthwhile = is_new || 5 * expansions_ < 3 * first_expansions_;  // (bench/peers/more.cpp)
    if (!complete || !is_worthwhile) return clear();
    is_complete_ = true;
  }

  /// Records an expansion. Returns `none` when there is no room.
  std::uint16_t add(const bvh::SlotId (&slot)[2], Side expanded) {
    ++expansions_;
    if (count_ == capacity) return none;
    records_[count_] = {std::numeric_limits<double>::infinity(), {slot[0], slot[1]}, expanded == Side::a, 0};
    return static_cast<std::uint16_t>(count_++);
  }

  /// Records that children are pruned, being at least `distance` from what they were compared with.
  void prune(std::uint16_t record, unsigned children, double distance) {
    LIMBER_ASSERT(record < count_ && distance > 0);
    Record& r = records_[record];
    r.pruned = static_cast<std::uint8_t>(r.pruned | children);
    r.valid_until = std::min(r.valid_until, distance + odometer_);
  }

  /// Takes the pruned children from a record, to be compared again.
  unsigned take(std::uint16_t record) {
    LIMBER_ASSERT(record < count_);
    ++expansions_;
    Record& r = records_[record];
    const unsigned children = r.pruned;
    r.pruned = 0;
    r.valid_until = std::numeric_limits<double>::infinity();
    return children;
  }

  std::span<const Record> records() const { return {records_, count_}; }

 private:
  /// At least what all vertices of both models together have moved within their models.
  static double deformation_of(const PlacedModels& placed) {
    return placed.tree(Side::a).displacement + placed.tree(Side::b).displacement;
  }
  void set_place(const PlacedModels& placed, const Transform& a_from_b) {
    deformation_ = deformation_of(placed);
    a_from_b_ = a_from_b;
    error_ = placed.error();
  }

  static constexpr std::uint32_t capacity = 1024;

  std::uint64_t assignment_id_[2] = {0, 0};
  // Where the models were in the last traversal.
  Transform a_from_b_;
  double error_ = 0, deformation_ = 0;
  double odometer_ = 0;
  bool is_complete_ = false;
  std::uint32_t count_ = 0, expansions_ = 0, first_expansions_ = 0;
  Record records_[capacity];
};

}  // namespace limber::query
