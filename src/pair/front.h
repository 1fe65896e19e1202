// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>

#include "base/check.h"
#include "base/error_bounds.h"
#include "pair/node_pair.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"
#include "pair/traversal_state.h"

namespace limber::pair {

/// Remembers what a traversal has not expanded: pairs of nodes that were pruned, leaves that were compared, and what
/// was still open when the budget was spent. The next traversal of the same models compares only those pairs again that
/// may have come closer than its cutoff.
///
/// A record is one expansion: the node that was expanded, the slot of the other tree that its children were
/// compared with, the children that were not expanded in turn, and a lower bound of their distance. The other children
/// have records of their own, so all records together account for every pair of triangles. Where there is no room for
/// another record, the child that was to be expanded stays with the record of its parent, and stands for all below it.
///
/// The motion bound sums up all motion since the front was new: no two points of the models have come closer by more. A
/// record is compared again when the motion since it was written has used up its distance.
///
/// A traversal with a front goes one of two ways:
///   1. begin() notes the motion; the records are queued (FrontRecorder::add_records()), or forgotten for a walk from
///      the roots; finish() ends it, or suspend() if it is interrupted: then its queue stays in the front.
///   2. go_on() goes on with that queue and repeats no step, but for two leaves whose comparison was cut short
///      (docs/design/real_time.md). Where it may not, can_continue(), begin() gives the pairs of the queue to the
///      records that they come from.
/// From begin() or go_on() on the front is incomplete, until finish() or suspend(). An exception leaves it so, and only
/// a complete front is used again.
///
/// Based on  Front tracking [EhmannLin2001]: the frontier of the last traversal is where the next one starts. Here it
///           is not compared as a whole, but only where distances are used up.
class Front {
 public:
  /// Why children are not expanded. All children of one kind in a record share one bound and are compared again
  /// together. Those of `near` have a bound of their own, so that little motion brings back only them.
  enum class Kind : std::uint8_t {
    settled,  ///< pruned, or leaves that were compared
    near,     ///< as settled, but at a distance hardly beyond the cutoff
    open      ///< neither, because the traversal was interrupted
  };
  static constexpr std::size_t kinds = 3;
  struct Record {
    double distance[kinds];  ///< lower bounds for the children of each kind, as of `recorded_at`
    double recorded_at;      ///< the value of motion_bound() when these bounds were found
    bvh::SlotId slot[2];
    bool expands_a;
    std::uint8_t children[kinds];  ///< of each kind, a bit mask
  };

  /// The state of the traversal that is recorded, or was interrupted.
  TraversalState& state() { return state_; }

  /// Whether a traversal with this cutoff can go on where the last one was interrupted: the models have neither moved
  /// nor got other units, and the last one has pruned nothing that is closer than `cutoff`.
  bool can_continue(const PlacedPair& placed, double cutoff) const {
    return is_suspended_ && is_complete_ && is_of(placed) && is_at_rest(placed) && cutoff <= cutoff_ &&
           unit_[0] == placed.tree(Side::a).unit && unit_[1] == placed.tree(Side::b).unit;
  }
  /// Goes on with an interrupted traversal. Returns the search direction that it had. Pre: can_continue().
  std::optional<Vec3> go_on() {
    LIMBER_ASSERT(is_complete_ && is_suspended_);
    is_complete_ = is_suspended_ = false;
    return direction_;
  }
  /// Begins a traversal, for which the caller clears state(). If the last one was of the same models, its records and
  /// its bound stay, less the motion since. Otherwise there are none.
  void begin(const PlacedPair& placed, const Transform& a_from_b) {
    moved_ = 0;
    if (!is_complete_ || !is_of(placed)) {
      clear();
      moved_ = infinity;
      for (const Side s : {Side::a, Side::b}) build_id_[index(s)] = placed.tree(s).build_id;
    } else {
      if (is_suspended_) open_pairs_ = give_back_queue();
      if (!is_at_rest(placed)) add_motion(placed, a_from_b);
    }
    for (const Side s : {Side::a, Side::b}) {
      pose_[index(s)] = placed.pose(s);
      displacement_[index(s)] = placed.tree(s).displacement;
      unit_[index(s)] = placed.tree(s).unit;
    }
    a_from_b_ = a_from_b;
    error_ = placed.error();
    without_room_ = 0;
    is_complete_ = is_suspended_ = false;
  }
  /// Ends a traversal that is interrupted: what it has left is in the queue of state(), all else is at least `cutoff`
  /// apart.
  void suspend(double cutoff, const std::optional<Vec3>& direction) {
    LIMBER_ASSERT(!is_complete_ && cutoff > 0);
    is_complete_ = is_suspended_ = true;
    cutoff_ = cutoff;
    direction_ = direction;
  }
  /// Ends a traversal that needs no continuation. If its collector was done early, there are pairs left in the queue:
  /// they are given to the records that they come from.
  void finish() {
    give_back_queue();
    open_pairs_ = 0;
    is_complete_ = true;
  }
  double motion_bound() const { return motion_bound_; }
  /// Whether begin() has found a bound of the last traversal, from which it took the motion since.
  bool has_bound() const { return moved_ < infinity; }
  /// Whether the models have moved so little since the last traversal that records are likely to help the next one. To
  /// record costs part of a query, and of a cache's first ones more, as they touch its memory.
  bool has_moved_little(const PlacedPair& placed) const {
    const double radius = std::min(bvh::root_radius(placed.tree(Side::a)), bvh::root_radius(placed.tree(Side::b)));
    return moved_ <= little_of_radius * radius + little_of_distance * distance_;
  }

  /// Notes that the traversal has skipped ties (Ties::skipped): pairs that are as far apart as the best, which is at
  /// `distance`, up to rounding. By that rounding they may be nearer than the bounds of this front.
  void note_skipped_ties(double distance) { tied_distance_ = std::min(tied_distance_, distance); }
  /// Whether a pair within `limit` may have been skipped as a tie, so that the front must not be used to answer whether
  /// there is one. After any motion, however small, there is no such doubt: add_motion() lowers all bounds by twice the
  /// errors of placing, before and after, and ties differ by less than that.
  bool may_lack_ties(const PlacedPair& placed, double limit) const {
    if (std::isinf(tied_distance_) || !is_of(placed) || !is_at_rest(placed)) return false;
    const double rounding = placed.error() + base::tie_error * tied_distance_;
    return std::abs(limit - tied_distance_) <= 2 * rounding;  // of the best and of the tie
  }

  /// Forgets all records, but keeps bound(), a lower bound of the distance of the models.
  void forget_records() { count_ = 0, without_room_ = 0, open_pairs_ = 0; }
  /// Whether more expansions found no room than there is room for: then the records are hardly of use.
  bool overflows() const { return without_room_ > capacity; }
  /// How many pairs were open where the last traversal was interrupted.
  std::size_t open_count() const { return open_pairs_; }

  /// A lower bound of the distance of all children of a record.
  double bound_of(const Record& record) const {
    return remaining(*std::min_element(std::begin(record.distance), std::end(record.distance)), record.recorded_at);
  }
  /// A lower bound of the distance of the models: the greatest that a traversal has found, less the motion since.
  double bound() const { return remaining(distance_, found_at_); }
  /// The lower bound that bound() will give after begin(), if the models are where they were; else 0.
  double bound_at_rest(const PlacedPair& placed) const {
    return is_complete_ && is_of(placed) && is_at_rest(placed) ? bound() : 0;
  }
  /// Notes a lower bound of the distance of the models as they are placed now.
  void improve_bound(double distance) {
    if (distance > bound()) distance_ = distance, found_at_ = motion_bound_;
  }

  void clear() {
    forget_records();
    motion_bound_ = distance_ = found_at_ = 0;
    tied_distance_ = infinity;
    is_complete_ = is_suspended_ = false;
  }

  /// Records an expansion. Returns `no_record` when there is no room.
  std::uint16_t add(const bvh::SlotId (&slot)[2], Side expanded) {
    if (count_ == capacity) {
      ++without_room_;
      return NodePair::no_record;
    }
    records_[count_] = {
        {infinity, infinity, infinity}, motion_bound_, {slot[0], slot[1]}, expanded == Side::a, {0, 0, 0}};
    return static_cast<std::uint16_t>(count_++);
  }

  /// Adds children to a record. They are at least `distance` from what they were compared with.
  void record_children(std::uint16_t record, unsigned children, Kind kind, double distance) {
    LIMBER_ASSERT(record < count_ && distance >= 0);
    Record& r = updated(record);
    const auto k = static_cast<std::size_t>(kind);
    r.children[k] = static_cast<std::uint8_t>(r.children[k] | children);
    r.distance[k] = std::min(r.distance[k], distance);
  }

  /// Takes from a record the children of every kind whose bound is below `distance`, to be compared again.
  unsigned take_children(std::uint16_t record, double distance) {
    LIMBER_ASSERT(record < count_);
    Record& r = updated(record);
    unsigned children = 0;
    for (std::size_t k = 0; k < kinds; ++k) {
      if (r.distance[k] >= distance) continue;
      children |= r.children[k];
      r.children[k] = 0;
      r.distance[k] = infinity;
    }
    return children;
  }

  std::span<const Record> records() const { return {records_, count_}; }

 private:
  /// Empties the queue: gives its pairs to the records that they come from. Returns how many pairs it had. Pairs are
  /// only dropped where a record has them already, or none is needed:
  ///   - a pair that stands for a whole record, which still has its children;
  ///   - the pair of the roots, and all pairs if the records were forgotten: the next traversal starts from the roots.
  std::size_t give_back_queue() {
    std::size_t pairs = 0;
    for (; !state_.queue.empty(); ++pairs) {
      const NodePair pair = state_.queue.pop();
      if (pair.child == NodePair::whole_record || pair.record >= count_) continue;
      const double bound = std::sqrt(static_cast<double>(pair.bound_sq)) * unit_[0] * double{base::squares_down};
      record_children(pair.record, 1U << pair.child, Kind::open, bound);
    }
    return pairs;
  }
  /// Adds what has happened since the last traversal: motion of the poses, and of the vertices in their models. The
  /// displacement of a tree sums up many motions of its vertices; `rounding` is an upper bound of that sum's rounding.
  void add_motion(const PlacedPair& placed, const Transform& a_from_b) {
    const double before = displacement_[0] + displacement_[1], rounding = before * (base::sum_up - 1);
    const double deformation = placed.tree(Side::a).displacement + placed.tree(Side::b).displacement - before;
    moved_ = placed.max_displacement(a_from_b_, error_, a_from_b) + deformation + rounding;
    motion_bound_ = (motion_bound_ + moved_) * base::sum_up;
    tied_distance_ = infinity;
  }
  bool is_of(const PlacedPair& placed) const {
    return build_id_[0] == placed.tree(Side::a).build_id && build_id_[1] == placed.tree(Side::b).build_id;
  }
  /// Whether nothing has moved since the last traversal. Every motion of vertices makes `displacement` of a tree
  /// larger.
  bool is_at_rest(const PlacedPair& placed) const {
    return pose_[0] == placed.pose(Side::a) && pose_[1] == placed.pose(Side::b) &&
           displacement_[0] == placed.tree(Side::a).displacement &&
           displacement_[1] == placed.tree(Side::b).displacement;
  }
  /// What is left of a distance that was found at `recorded_at`: all of it if nothing has moved since; else less the
  /// motion, rounded down. The inner factor covers the addition and itself, the outer one the subtraction and itself.
  double remaining(double distance, double recorded_at) const {
    constexpr double down = 2 - base::sum_up;
    return recorded_at == motion_bound_ ? distance
                                        : std::max(0.0, ((distance + recorded_at) * down - motion_bound_) * down);
  }
  /// A record, with its bounds made those of now.
  Record& updated(std::uint16_t record) {
    Record& r = records_[record];
    for (double& distance : r.distance) distance = remaining(distance, r.recorded_at);
    r.recorded_at = motion_bound_;
    return r;
  }

  // Parts of the smaller radius and of the distance: beyond, a front that was kept saved nothing, on the mix's scenes
  // along paths. No answer depends on it.
  static constexpr double little_of_radius = 1. / 4, little_of_distance = 1. / 32;
  // In records of 48 bytes. No answer depends on it: with less room, more records stand for all below their children.
  static constexpr std::uint32_t capacity = 1024;

  std::uint64_t build_id_[2] = {0, 0};
  // Where the models were in the last traversal.
  Transform pose_[2], a_from_b_;
  double error_ = 0, displacement_[2] = {0, 0};
  double unit_[2] = {1, 1};              // of the trees; a model that grows or shrinks a lot gets another one
  double motion_bound_ = 0, moved_ = 0;  // in all, and since the last traversal, infinite if there was none
  double distance_ = 0, found_at_ = 0;   // the bound of the models' distance, and motion_bound() when it was found
  double tied_distance_ = infinity;      // at which ties were skipped since the last motion
  bool is_complete_ = false;
  bool is_suspended_ = false;  // whether the queue of state_ has what the last traversal has left
  double cutoff_ = 0;          // that of the interrupted traversal
  std::optional<Vec3> direction_;
  std::uint32_t count_ = 0, without_room_ = 0;
  std::size_t open_pairs_ = 0;
  Record records_[capacity];
  TraversalState state_;
};

/// The observer of PairWalk that gives a front what the walk adds, prunes and compares. If it may give up, it stops
/// recording where the front overflows: then the front keeps no records, and the walk goes on as if it had no observer.
class FrontRecorder {
 public:
  FrontRecorder(Front& front, const Pruning& pruning, const SquaredLimits& limits)
      : front_(front), pruning_(pruning), limits_(limits) {}

  bool is_recording() const { return is_recording_; }
  void set_may_give_up() { may_give_up_ = true; }

  /// Queues the records whose children may be nearer than the cutoff. False if that is so much that a new traversal is
  /// cheaper, or if there are no records.
  bool add_records(TraversalState& state) const {
    const std::span<const Front::Record> records = front_.records();
    state.is_descending = false;
    std::size_t queued = 0;
    state.least_sq = largest_bound_sq;
    for (std::size_t i = 0; i < records.size(); ++i) {
      const double bound = front_.bound_of(records[i]);
      if (bound >= pruning_.cutoff()) continue;
      ++queued;
      const float bound_sq = limits_.bound_of(bound);
      state.least_sq = std::min(state.least_sq, bound_sq);
      state.queue.push(NodePair::of_record(static_cast<std::uint16_t>(i), bound_sq));
    }
    // What the last traversal has left open is new work in any case, so it is no reason to begin anew. Each open pair
    // has queued at most one record, so at least so many others are compared again.
    const double compared_again = static_cast<double>(queued) - static_cast<double>(front_.open_count());
    return !records.empty() && compared_again < worth_resuming * static_cast<double>(records.size());
  }

  static bool is_record(const NodePair& pair) { return pair.child == NodePair::whole_record; }
  /// Opens a record again: its children are to be compared, unless they are beyond the cutoff by now. Pre: the front
  /// has the record that the pair stands for: it forgets none while any is queued.
  template <typename Bounds>
  bool reopens(Expansion& e, const Bounds& bounds) {
    const std::uint16_t record = e.pair.record;
    LIMBER_ASSERT(record < front_.records().size());
    const Front::Record& r = front_.records()[record];
    if (front_.bound_of(r) >= pruning_.cutoff()) return false;
    const Side side = r.expands_a ? Side::a : Side::b;
    e.start(bounds.tree(side), NodePair::of(r.slot[0], r.slot[1], e.pair.bound_sq), side);
    e.record = record;
    e.has_record = true;
    e.children = front_.take_children(record, pruning_.cutoff());
    return true;
  }

  /// Where the bounds of children are to be written.
  float* bounds_of_children() { return is_recording_ ? bound_sq_ : nullptr; }

  /// A node is opened. Where there is no room for a record, that of its parent stands for all below it.
  void added(Expansion& e) {
    if (!is_recording_) return;
    e.record = front_.add(e.pair.slot, e.side);
    e.has_record = e.record != NodePair::no_record;
    if (!e.has_record) e.record = e.pair.record;
    if (!may_give_up_ || !front_.overflows()) return;
    front_.forget_records();
    is_recording_ = false;
  }
  /// A pair is settled: it is not opened, and what it holds is at least max(distance, cutoff) apart.
  void pruned(const NodePair& pair, double distance) {
    if (is_recording_ && pair.record != NodePair::no_record) settle(pair.record, 1U << pair.child, distance);
  }
  void compared(const NodePair& pair, double distance) { pruned(pair, distance); }
  /// Children of a node that is opened were pruned, by the bounds that the kernel has given.
  void pruned_children(const Expansion& e) {
    const unsigned children = e.children & ~e.kept.all;
    if (!is_recording_ || children == 0 || e.record == NodePair::no_record) return;
    float least = no_limit_sq;
    for (unsigned rest = children; rest != 0; rest &= rest - 1) {
      least = std::min(least, bound_sq_[std::countr_zero(rest)]);
    }
    settle(e.record, e.has_record ? children : 1U << e.pair.child, limits_.length_of(e.side, least));
  }

 private:
  // A front is resumed if less than this part of its records has to be compared again, open ones not counted. Below 1:
  // to compare a pair again costs more than in a new walk (QueryCache::Impl, cost_of_resumed_work).
  static constexpr double worth_resuming = 0.5;
  // Children nearer than the cutoff times this are near. Without a bound of their own, the first small motion would
  // bring back all their siblings; if most were near, it would bring back most. A guess: no answer depends on it.
  static constexpr double near_factor = 1 + 1. / 64;

  /// Records children that were pruned or compared: they are at least max(distance, cutoff) apart.
  void settle(std::uint16_t record, unsigned children, double distance) {
    const Front::Kind kind = distance < near_factor * pruning_.cutoff() ? Front::Kind::near : Front::Kind::settled;
    front_.record_children(record, children, kind, std::max(distance, pruning_.cutoff()));
  }

  Front& front_;
  const Pruning& pruning_;
  const SquaredLimits& limits_;
  bool is_recording_ = true, may_give_up_ = false;
  alignas(32) float bound_sq_[bvh::width];
};

}  // namespace limber::pair
