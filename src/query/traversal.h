// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "query/front.h"
#include "query/pending.h"
#include "query/placed_leaf.h"
#include "query/placed_pair.h"

/// The one loop of all queries between two models.
///
/// Based on  [Quinlan1994]: pairs of nodes are compared, those that cannot matter are dropped, the others opened.
/// Differs   Eight children are compared at once, against one node: the thicker side is opened, the other stays as it
///           is. Pairs are taken nearest first. Bounds also use the direction in which the best pair so far was apart.
namespace limber::query {

/// What is sought. A pair of triangles at least `cut` apart cannot matter; `cut` only shrinks.
///
/// Needs    double cut() const              > 0
///          bool finished() const           nothing that is left can matter
///          bool is_apart(PlacedLeaf& a, std::uint32_t lane_a, PlacedLeaf& b, std::uint32_t lane_b)
///                                          a quick no, before compare()
///          void compare(const PlacedTriangle& a, const PlacedTriangle& b)
///          static constexpr bool any       whether any pair will do; otherwise the nearest is sought
///
/// With `records` a front is kept, or gone on from.
template <typename Goal, bool records>
class Traversal {
 public:
  Traversal(PlacedPair& placed, Goal& goal, QueryStats& stats)
      : placed_(placed), goal_(goal), stats_(stats), kernels_(simd::kernels()) {
    const double ratio = placed.tree(Side::b).unit / placed.tree(Side::a).unit;
    to_a_sq_[1] = static_cast<float>(std::min(ratio * ratio, 0x1p126));
  }

  /// Begins with the two roots, or where the front ends if it is about them. `front` is null unless it is kept.
  void start(double root_bound, Front* front) {
    pending_.clear();
    if constexpr (records) {
      front_ = front;
      is_recording_ = true;
      if (front_->is_about(placed_)) {
        front_->move(placed_);
        records_left_ = front_->records().size();
        return drop();
      }
      front_->start(placed_);
    }
    const double units = root_bound / placed_.tree(Side::a).unit;
    least_sq_ = static_cast<float>(std::min(units * units * (1 - 0x1p-20), double{Pending::largest_bound}));
    pending_.push_first({least_sq_, {tree::root, tree::root}, Front::none, 0});
  }

  /// Looks at one more pair. False when none that matters is left.
  bool step() {
    if (goal_.finished()) return false;
    update_limits();
    Opening o;
    if (records && records_left_ > 0 && !pending_.is_crowded()) {
      if (!reopen(static_cast<std::uint16_t>(--records_left_), o)) return true;
    } else {
      if (pending_.empty()) return false;
      o.pair = pending_.pop();
      if (!open(o)) return true;
    }
    compare_lanes(o);
    return true;
  }

  /// Ends the traversal, wherever it is.
  void finish() {
    if (records && front_ != nullptr) front_->finish(is_recording_ && !goal_.finished());
  }

  /// Steps that tight bounds would have made unnecessary, as far as can be told; a fraction stands for a chance.
  double due_to_slack() const { return due_to_slack_; }

  /// Whether something at least cut() away was left out.
  bool dropped() const { return dropped_; }

 private:
  /// A node being opened against another.
  struct Opening {
    Side side;  // of the one that is opened
    NodePair pair;
    std::uint32_t block;
    std::uint16_t record;
    unsigned lanes;        // what is compared
    simd::KeptLanes kept;  // what matters
    alignas(32) float order[simd::width];
  };

  /// Whether a node is not expanded: a leaf, or one whose triangles are all at one place, so that any leaf below stands
  /// for it and no bound could tell them apart. Vertices within the slack may be elsewhere than the mark says.
  bool is_leaf(Side s, const NodePair& pair) const {
    const tree::NodeId node = pair.node[index(s)];
    const tree::Tree& tree = placed_.tree(s);
    const bool is_coincident = (tree.blocks[tree::block_of(node)].coincident >> tree::lane_of(node) & 1) != 0;
    return tree::block_of(node) >= tree.lowest_level() || (is_coincident && tree.slack == 0);
  }
  /// The leaf that such a node is or stands for, as a node. Pre: is_leaf().
  tree::NodeId leaf_of(Side s, const NodePair& pair) const {
    return tree::first_leaf_below(placed_.tree(s), pair.node[index(s)]);
  }
  std::uint32_t child_of(Side s, tree::NodeId node) const {
    return placed_.tree(s).blocks[tree::block_of(node)].first_child + tree::lane_of(node);
  }
  simd::Seen seen_node(Side s, const NodePair& pair) const {
    const tree::NodeId node = pair.node[index(s)];
    return {&placed_.tree(s).blocks[tree::block_of(node)], tree::lane_of(node), nullptr};
  }
  simd::Seen seen_leaf(Side s, const NodePair& pair) const {
    const tree::NodeId node = leaf_of(s, pair);
    return {&placed_.tree(s).blocks[tree::block_of(node)], tree::lane_of(node),
            &placed_.tree(s).leaves[child_of(s, node)].corners};
  }
  /// What a node adds to the looseness of bounds: half the thickness of its slab, and a little of its ball.
  double looseness(Side s, tree::NodeId node) const {
    const tree::Tree& tree = placed_.tree(s);
    const simd::NodeBounds& n = tree.blocks[tree::block_of(node)].bounds;
    const std::uint32_t k = tree::lane_of(node);
    return tree.unit * static_cast<double>((n.high[k] - n.low[k]) * 0.5F + ball_share * n.radius[k]);
  }
  /// Whether to open the node of a: it can be, and the other cannot or is no looser.
  bool opens_a(const NodePair& pair) const {
    const bool looser = looseness(Side::a, pair.node[0]) >= looseness(Side::b, pair.node[1]);
    // Bitwise: nobody could predict the branches.
    const bool closed_a = is_leaf(Side::a, pair), closed_b = is_leaf(Side::b, pair);
    return (static_cast<int>(looser) | static_cast<int>(closed_b)) > static_cast<int>(closed_a);
  }

  /// How likely a pair that no tight bound is known to keep would have been dropped by one: where everything closer
  /// than the slack is kept, that depends on how large it is next to the bounds.
  double chance_of_slack(const NodePair& pair) const {
    if (tight_sq_ > 0) return 1;
    const double loose = looseness(Side::a, pair.node[0]) + looseness(Side::b, pair.node[1]);
    return placed_.slack() / (placed_.slack() + loose);
  }

  void drop() { dropped_ = true; }

  /// A lower bound as a length.
  double length_of(Side s, float bound_sq) const {
    return std::sqrt(static_cast<double>(bound_sq)) * placed_.tree(s).unit * (1 - 0x1p-20);
  }
  /// Nothing in this pair is nearer than `apart`, or it has been compared.
  void close(const NodePair& pair, double apart) {
    LIMBER_ASSERT(apart >= 0);
    drop();
    if (records && is_recording_ && pair.record != Front::none) {
      front_->rule_out(pair.record, 1U << pair.lane, std::max(apart, goal_.cut()));
    }
  }

  void update_limits() {
    if (goal_.cut() == limits_for_) return;
    limits_for_ = goal_.cut();
    placed_.set_cut(limits_for_);
    const double tight = std::max(0.0, limits_for_ - placed_.slack()) / placed_.tree(Side::a).unit;
    tight_sq_ = static_cast<float>(std::min(tight * tight, double{Pending::no_bound}));
    for (const Side s : {Side::a, Side::b}) {
      const double units = limits_for_ / placed_.tree(s).unit;
      const double limit =
          std::min(units * units * (1 + 0x1p-22), double{Pending::no_bound});  // rounding to float32 included
      // A positive limit never drops a pair whose bound is 0.
      limit_sq_[index(s)] = std::max(static_cast<float>(limit), std::numeric_limits<float>::min());
    }
    if (limit_sq_[0] - least_sq_ > 0.5F * (focus_sq_ - least_sq_)) return;
    focus_sq_ = limit_sq_[0];
    pending_.focus(least_sq_, focus_sq_);
  }

  /// Opens one node of a pair. False if there is nothing to be opened.
  bool open(Opening& o) {
    const NodePair& pair = o.pair;
    if (pair.bound_sq >= limit_sq_[0]) {
      close(pair, length_of(Side::a, pair.bound_sq));
      if (!records && pending_.all_beyond(limit_sq_[0])) pending_.clear();
      return false;
    }
    if (placed_.slack() > 0 && pair.bound_sq >= tight_sq_) due_to_slack_ += chance_of_slack(pair);
    if (is_leaf(Side::a, pair) && is_leaf(Side::b, pair)) {
      compare_leaves(pair);
      close(pair, goal_.cut());
      return false;
    }
    o.side = opens_a(pair) ? Side::a : Side::b;
    o.block = child_of(o.side, pair.node[index(o.side)]);
    o.lanes = (1U << placed_.tree(o.side).blocks[o.block].count) - 1;
    o.record = Front::none;
    if (records && is_recording_) {
      o.record = front_->add(pair.node, o.side);
      is_recording_ = o.record != Front::none;
    }
    return true;
  }

  /// The same for what a record has ruled out. False if that still holds.
  bool reopen(std::uint16_t record, Opening& o) {
    const Front::Record& r = front_->records()[record];
    if (r.lasts >= (front_->moved() + goal_.cut()) * (1 + 0x1p-50)) return false;
    o.side = r.opens_a ? Side::a : Side::b;
    o.pair = {0, {r.node[0], r.node[1]}, Front::none, 0};
    o.block = child_of(o.side, r.node[index(o.side)]);
    o.record = record;
    o.lanes = front_->reopen(record);
    return true;
  }

  /// Compares the children of the node that is opened with the other as it is.
  void compare_lanes(Opening& o) {
    LIMBER_ASSERT(o.lanes != 0);
    const Side closed = other(o.side);
    const simd::Seen seen = is_leaf(closed, o.pair) ? seen_leaf(closed, o.pair) : seen_node(closed, o.pair);
    const tree::Block& block = placed_.tree(o.side).blocks[o.block];
    stats_.node_tests += block.count;
    alignas(32) float bound_sq[simd::width];
    o.kept = kernels_.bound_lanes(block, seen, placed_.view(o.side), limit_sq_[index(o.side)], o.order,
                                  records ? bound_sq : nullptr);
    o.kept.all &= o.lanes, o.kept.meeting &= o.lanes;
    const unsigned ruled_out = o.lanes & ~o.kept.all;
    if (ruled_out != 0) {
      drop();
      if (records && is_recording_) rule_out(o, ruled_out, bound_sq);
    }
    if (o.kept.all != 0) keep(o);
  }

  void rule_out(const Opening& o, unsigned lanes, const float* bound_sq) {
    float least = Pending::no_bound;
    for (unsigned rest = lanes; rest != 0; rest &= rest - 1) least = std::min(least, bound_sq[std::countr_zero(rest)]);
    front_->rule_out(o.record, lanes, std::max(length_of(o.side, least), goal_.cut()));
  }

  /// Puts the lanes that matter where they will be taken in the right order.
  void keep(const Opening& o) {
    unsigned meeting = o.kept.meeting;
    if (meeting == 0) {
      if (Goal::any || placed_.is_aimed()) return push_rest(o, o.kept.all);
      return descend(o);
    }
    push_rest(o, o.kept.all & ~meeting);
    // The deepest overlap last, so that it is taken first.
    while (meeting != 0) {
      auto shallowest = static_cast<std::uint32_t>(std::countr_zero(meeting));
      for (unsigned rest = meeting & (meeting - 1); rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
        if (o.order[lane] >= o.order[shallowest]) shallowest = lane;
      }
      meeting &= ~(1U << shallowest);
      pending_.push_first(child_pair(o, shallowest));
    }
  }

  /// Straight down, by the nearest lane, while nothing has been found.
  void descend(const Opening& o) {
    auto nearest = static_cast<std::uint32_t>(std::countr_zero(o.kept.all));
    for (unsigned rest = o.kept.all; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
      if (o.order[lane] < o.order[nearest]) nearest = lane;
    }
    push_rest(o, o.kept.all & ~(1U << nearest));
    pending_.push_first(child_pair(o, nearest));
  }

  void push_rest(const Opening& o, unsigned lanes) {
    for (; lanes != 0; lanes &= lanes - 1) {
      pending_.push(child_pair(o, static_cast<std::uint32_t>(std::countr_zero(lanes))));
    }
  }

  NodePair child_pair(const Opening& o, std::uint32_t lane) const {
    // Below any limit that stands for none, even where the units of the trees are worlds apart.
    const float bound_sq = std::min(std::max(o.order[lane], 0.0F) * to_a_sq_[index(o.side)], Pending::largest_bound);
    const tree::NodeId child = o.block * simd::width + lane;
    const bool of_a = o.side == Side::a;
    return {bound_sq,
            {of_a ? child : o.pair.node[0], of_a ? o.pair.node[1] : child},
            o.record,
            static_cast<std::uint16_t>(lane)};
  }

  void compare_leaves(const NodePair& pair) {
    const simd::Seen seen_a = seen_leaf(Side::a, pair), seen_b = seen_leaf(Side::b, pair);
    simd::Candidates found;
    kernels_.leaf_candidates(seen_a, seen_b, placed_.view(Side::a), found);
    if (found.count != simd::width * simd::width) drop();
    if (found.count == 0) return;
    // The nearest first: it may rule the others out.
    std::uint32_t nearest = 0;
    for (std::uint32_t i = 1; i < found.count; ++i) {
      if (found.pairs[i].bound_sq < found.pairs[nearest].bound_sq) nearest = i;
    }
    std::swap(found.pairs[0], found.pairs[nearest]);
    PlacedLeaf a(placed_, Side::a, placed_.tree(Side::a).leaves[child_of(Side::a, leaf_of(Side::a, pair))]);
    PlacedLeaf b(placed_, Side::b, placed_.tree(Side::b).leaves[child_of(Side::b, leaf_of(Side::b, pair))]);
    for (std::uint32_t i = 0; i < found.count && !goal_.finished(); ++i) {
      const double reach = goal_.cut() * found.scale + static_cast<double>(found.error);
      const auto bound_sq = static_cast<double>(found.pairs[i].bound_sq);
      if (bound_sq >= reach * reach * (1 + 0x1p-20)) {
        drop();
        continue;
      }
      const double tight = reach - placed_.slack() * found.scale;
      if (placed_.slack() > 0 && bound_sq >= tight * tight) due_to_slack_ += 1;
      const std::uint32_t lane_a = found.pairs[i].lane_a, lane_b = found.pairs[i].lane_b;
      if (goal_.is_apart(a, lane_a, b, lane_b)) {
        drop();
        continue;
      }
      ++stats_.triangle_tests;
      goal_.compare(a.at(lane_a), b.at(lane_b));
    }
  }

  static constexpr float ball_share = 0.01F;

  PlacedPair& placed_;
  Goal& goal_;
  QueryStats& stats_;
  const simd::Kernels& kernels_;
  double limits_for_ = -1;
  float limit_sq_[2] = {0, 0};                         // of what matters, in squared units of either tree
  float to_a_sq_[2] = {1, 1};                          // squared units of either tree in those of a
  float least_sq_ = 0, focus_sq_ = Pending::no_bound;  // what pending_ was told to focus on
  float tight_sq_ = 0;  // what is nearer would be looked at without slack too, in squared units of a
  double due_to_slack_ = 0;
  bool dropped_ = false;
  Front* front_ = nullptr;
  bool is_recording_ = false;     // whether front_ will account for everything
  std::size_t records_left_ = 0;  // of front_, still to be looked at
  Pending pending_;
};

}  // namespace limber::query
