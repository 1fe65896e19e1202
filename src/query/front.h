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

/// What a traversal has not expanded, pruned or still open, and how far the models may move before that has to be
/// compared again.
///
/// Based on  Front tracking [EhmannLin2001]: the frontier of the last traversal is where the next one starts.
/// Differs   The front is not compared as a whole. odometer() sums up all motion, as an upper bound of what two
///           points can have come closer by; a pair is not compared again until that sum has used up its distance. A
///           traversal that was interrupted leaves a front like any other: what was open has smaller bounds.
///
/// A record is one expansion: the wide node that was expanded, the slot of the other tree that its children were
/// compared with, the children that were not expanded in turn, and a lower bound of their distance. The other children
/// have records of their own, so all records together account for every pair of triangles. Where there is no room for
/// another record, the child that was to be expanded stays with the record of its parent, and stands for all below it.
///
/// States   Empty, recording or complete. start() empties it and starts to record; resume() continues to record on a
///          complete front; finish() completes it. An exception leaves it recording, and only a complete front can be
///          resumed.
class Front {
 public:
  /// Children that are not expanded: pruned or compared, some of them hardly beyond the prune distance; or still open
  /// when the traversal was interrupted. Each kind is compared again as a whole.
  enum Kind { settled, near, open };
  static constexpr std::size_t kinds = 3;
  struct Record {
    double distance[kinds];  ///< lower bounds for the children of each kind, when the odometer stood at `odometer`
    double odometer;
    bvh::SlotId slot[2];
    bool expands_a;
    std::uint8_t children[kinds];  ///< of each kind, a bit mask
  };
  static constexpr std::uint16_t none = 0xffff;

  /// Whether the last traversal that it recorded was one of these models, and has ended.
  bool can_resume(const PlacedModels& placed) const { return is_complete_ && is_of(placed); }

  /// Starts to record a traversal of the models as they are placed.
  void start(const PlacedModels& placed, const Transform& a_from_b) {
    clear();
    for (const Side s : {Side::a, Side::b}) assignment_id_[index(s)] = placed.tree(s).assignment_id;
    set_place(placed, a_from_b);
  }

  /// Adds the motion from where the models were to where they are. Pre: can_resume(placed).
  void resume(const PlacedModels& placed, const Transform& a_from_b) {
    LIMBER_ASSERT(can_resume(placed));
    is_complete_ = false;
    if (is_at_rest(placed)) return;
    const double deformation = deformation_of(placed) - deformation_, rounding = deformation_ * (core::sum_up - 1);
    odometer_ += placed.max_displacement(a_from_b_, error_, a_from_b) + deformation + rounding;
    odometer_ *= core::sum_up;
    set_place(placed, a_from_b);
  }
  double odometer() const { return odometer_; }

  /// Forgets all records, as they are of no use, but not the bound of the distance. Pre: resume() has been called.
  void start_over() {
    if (count_ > 0) ++useless_;
    count_ = 0, open_pairs_ = 0;
    work_ = work_of_new_ = 0;
  }
  /// Notes that the records are of use.
  void be_useful() { useless_ = 0; }
  /// Whether to record the next traversal. While fronts are of no use one after the other, recording only costs time;
  /// then it is tried now and then, two times in a row.
  bool should_record() {
    constexpr std::uint32_t tolerated = 2, period = 16;
    return useless_ < tolerated || ++queries_ % period < 2;
  }

  /// A lower bound of the distance of what a record has not expanded.
  double bound_of(const Record& record) const {
    return remaining(std::min({record.distance[settled], record.distance[near], record.distance[open]}),
                     record.odometer);
  }
  /// A lower bound of the distance of the models: the best that a traversal has found, less the motion since.
  double bound() const { return remaining(distance_, distance_odometer_); }
  /// The same before resume() or start() is called: only if the models are where they were.
  double bound_at_rest(const PlacedModels& placed) const {
    return can_resume(placed) && is_at_rest(placed) ? bound() : 0;
  }
  /// Notes a lower bound of the distance of the models as they are placed now.
  void improve_bound(double distance) {
    if (distance > bound()) distance_ = distance, distance_odometer_ = odometer_;
  }

  void clear() {
    count_ = 0;
    work_ = work_of_new_ = 0;
    odometer_ = distance_ = distance_odometer_ = 0;
    is_complete_ = false;
  }

  /// Ends a traversal: every pair has been compared, or is accounted for by a record. `open_pairs` would have been
  /// expanded or compared if the traversal had gone on; `work` is how many it has expanded or compared. A front that
  /// saves little next to a new traversal is given up.
  void finish(std::size_t open_pairs, std::uint64_t work) {
    open_pairs_ = open_pairs;
    is_complete_ = true;
    work_ += work;
    if (open_pairs > 0) return;
    if (work_of_new_ == 0) work_of_new_ = work_;
    const bool is_new = work_ == work_of_new_;
    work_ = 0;
    if (!is_new && 5 * work > 3 * work_of_new_) start_over();  // (bench/realtime/deadlines.cpp)
  }
  /// How many pairs were open at the end of the last traversal.
  std::size_t open_count() const { return open_pairs_; }

  /// Records an expansion. Returns `none` when there is no room.
  std::uint16_t add(const bvh::SlotId (&slot)[2], Side expanded) {
    if (count_ == capacity) return none;
    records_[count_] = {{infinity, infinity, infinity}, odometer_, {slot[0], slot[1]}, expanded == Side::a, {0, 0, 0}};
    return static_cast<std::uint16_t>(count_++);
  }

  /// Gives children to a record, being at least `distance` from what they were compared with.
  void put(std::uint16_t record, unsigned children, Kind kind, double distance) {
    LIMBER_ASSERT(record < count_ && distance >= 0);
    Record& r = up_to_date(record);
    r.children[kind] = static_cast<std::uint8_t>(r.children[kind] | children);
    r.distance[kind] = std::min(r.distance[kind], distance);
  }

  /// Takes from a record the children of a kind that may be closer than `distance`, to be compared again.
  unsigned take(std::uint16_t record, double distance) {
    LIMBER_ASSERT(record < count_);
    Record& r = up_to_date(record);
    unsigned children = 0;
    for (const Kind kind : {settled, near, open}) {
      if (r.distance[kind] >= distance) continue;
      children |= r.children[kind];
      r.children[kind] = 0;
      r.distance[kind] = infinity;
    }
    return children;
  }

  std::span<const Record> records() const { return {records_, count_}; }

 private:
  bool is_of(const PlacedModels& placed) const {
    return assignment_id_[0] == placed.tree(Side::a).assignment_id &&
           assignment_id_[1] == placed.tree(Side::b).assignment_id;
  }
  /// At least what all vertices of both models together have moved within their models.
  static double deformation_of(const PlacedModels& placed) {
    return placed.tree(Side::a).displacement + placed.tree(Side::b).displacement;
  }
  bool is_at_rest(const PlacedModels& placed) const {
    return pose_[0] == placed.pose(Side::a) && pose_[1] == placed.pose(Side::b) &&
           displacement_[0] == placed.tree(Side::a).displacement &&
           displacement_[1] == placed.tree(Side::b).displacement;
  }
  void set_place(const PlacedModels& placed, const Transform& a_from_b) {
    for (const Side s : {Side::a, Side::b}) {
      pose_[index(s)] = placed.pose(s);
      displacement_[index(s)] = placed.tree(s).displacement;
    }
    deformation_ = deformation_of(placed);
    a_from_b_ = a_from_b;
    error_ = placed.error();
  }
  /// What is left of a distance, rounded down; all of it if nothing has moved since.
  double remaining(double distance, double odometer) const {
    constexpr double down = 2 - core::sum_up;
    return odometer == odometer_ ? distance : std::max(0.0, ((distance + odometer) * down - odometer_) * down);
  }
  Record& up_to_date(std::uint16_t record) {
    Record& r = records_[record];
    for (double& distance : r.distance) distance = remaining(distance, r.odometer);
    r.odometer = odometer_;
    return r;
  }

  static constexpr std::uint32_t capacity = 1024;
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  std::uint64_t assignment_id_[2] = {0, 0};
  // Where the models were in the last traversal.
  Transform pose_[2], a_from_b_;
  double error_ = 0, deformation_ = 0, displacement_[2] = {0, 0};
  double odometer_ = 0;
  double distance_ = 0, distance_odometer_ = 0;  // the bound of the models' distance, and when it was found
  bool is_complete_ = false;
  std::uint32_t count_ = 0;
  std::size_t open_pairs_ = 0;
  std::uint64_t work_ = 0, work_of_new_ = 0;  // of this traversal until it ends, and of one from the roots
  std::uint32_t useless_ = 0, queries_ = 0;
  Record records_[capacity];
};

}  // namespace limber::query
