// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <bitset>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/check.h"
#include "bvh/tree.h"
#include "limber/distance.h"
#include "motion/element_impact.h"
#include "motion/moving_pair.h"
#include "pair/budget_meter.h"
#include "pair/pair_walk.h"
#include "simd/kernels.h"

/// The search of two moving models, or of one with itself, for elements that touch: PairWalk depth first, with
///   SlotPair, MovingExpansion   its pairs: slots of both trees, and the time in which their boxes meet;
///   MovingBounds                which children of a node may meet another node, and when;
///   ImpactsOfLeaves             which elements of two leaves may touch;
///   ImpactSearch                which puts them together, and is what callers use.
namespace limber::motion {

/// A collector says what is looked for, and is offered, by compare(), what may touch. If its constant `at_any_pace` is
/// true, it is offered pairs that may be near if each vertex is anywhere on its way, whatever others do. It then has a
/// function stays(side, leaf) as well, and pairs of leaves that both stay are left out.
template <typename Collector>
concept CollectsImpacts = requires(Collector& collector, const Collector& asked, const ElementPair& pair,
                                   const MovingElements& elements) {
  { asked.max_time() } -> std::same_as<double>;  // what touches later does not matter; it may fall during the search
  { asked.is_done() } -> std::same_as<bool>;     // nothing else matters
  { asked.wants_contacts_only() } -> std::same_as<bool>;  // leave out what certainly stays apart; separation 0 only
  collector.compare(pair, elements);
};

/// Slots of two moving trees, or of one.
struct SlotPair {
  bvh::SlotId slot[2];
  double first_time, last_time;  ///< bounds of the times at which the boxes of both meet
  /// Of a part of a walk: no pair that comes after this part touches before this time.
  double first_later_time = std::numeric_limits<double>::infinity();

  static SlotPair of(bvh::SlotId a, bvh::SlotId b) { return {{a, b}, 0, 1}; }
  static SlotPair roots() { return of(bvh::root_slot, bvh::root_slot); }
  static SlotPair itself(bvh::SlotId slot) { return of(slot, slot); }

  /// Those that may meet first are taken before the others.
  bool comes_before(const SlotPair& other) const { return first_time < other.first_time; }
  /// `pairs` are what `from` was split into; the last is searched first. Gives each a lower bound of the times at which
  /// the parts touch that are searched after it.
  static void note_later(std::span<SlotPair> pairs, const SlotPair& from) {
    double first = from.first_later_time;
    for (SlotPair& pair : pairs) {
      pair.first_later_time = first;
      first = std::min(first, pair.first_time);
    }
  }
};

/// The children of one node of a pair, compared with the other node.
struct MovingExpansion {
  SlotPair pair;
  Side side;
  std::uint32_t node;
  unsigned children;  ///< to be compared, a bit mask
  struct {
    unsigned all;
  } kept;  ///< those that may meet the other node while the parents do, a bit mask; PairWalk knows it as kept.all
  simd::MeetingTimes times;

  /// For one model: pairs a slot with each later child slot of the same node, which has `count` children.
  void start_siblings(bvh::SlotId slot, std::uint32_t count) {
    pair = SlotPair::of(slot, bvh::root_slot);  // the second slot is replaced by each child
    side = Side::b, node = bvh::node_of(slot);
    children = (1U << count) - (2U << bvh::slot_of(slot));
  }
};

/// The bounds of PairWalk for moving models: boxes at both ends of the motion, at any pace boxes of the whole way.
template <CollectsImpacts Collector>
class MovingBounds {
 public:
  using Pair = SlotPair;
  using Expansion = MovingExpansion;
  static constexpr bool at_any_pace = requires { requires Collector::at_any_pace; };

  MovingBounds(const MovingPair& models, double separation, const Collector& collector, QueryStats& stats)
      : models_(models), collector_(collector), kernels_(simd::kernels()), separation_(separation), stats_(stats) {}

  /// What matters of the time in which the boxes of a pair meet. At any pace each model has a time of its own, so all
  /// of it does.
  simd::MotionLimits limits_of(const SlotPair& pair) const {
    return {pair.first_time, std::min(pair.last_time, collector_.max_time()), separation_, at_any_pace};
  }

  // The distance is for observers, of which this walk has none.
  bool prunes(const SlotPair& pair, double&) const { return pair.first_time > collector_.max_time(); }
  bool are_leaves(const SlotPair& pair) const { return is_leaf(Side::a, pair) && is_leaf(Side::b, pair); }
  std::uint32_t child_count(std::uint32_t node) const { return models_.tree(Side::a).nodes[node].child_count; }

  // One model is compared with itself from the root down: a node with itself becomes its children with each other, and
  // then each of them with itself.
  static constexpr bool is_compared_with_itself(bvh::SlotId) { return true; }
  bool opens_itself(const SlotPair& pair) const { return models_.is_self() && pair.slot[0] == pair.slot[1]; }
  std::uint32_t opened_by_itself(const SlotPair& pair) const {
    return bvh::child_of(models_.tree(Side::a), pair.slot[0]);
  }

  /// Opens the node of larger size, if it can be opened.
  template <bool raises>
  pair::Next open(MovingExpansion& e, double&) const {
    const bool is_a_larger = models_.size_of(Side::a, e.pair.slot[0]) >= models_.size_of(Side::b, e.pair.slot[1]);
    e.side = is_leaf(Side::b, e.pair) || (!is_leaf(Side::a, e.pair) && is_a_larger) ? Side::a : Side::b;
    e.node = bvh::child_of(models_.tree(e.side), e.pair.slot[index(e.side)]);
    e.children = (1U << models_.tree(e.side).nodes[e.node].child_count) - 1;
    return pair::Next::opened;
  }
  void bound_children(MovingExpansion& e, float*) {
    const Side other = pair::other(e.side);
    stats_.node_tests += models_.tree(e.side).nodes[e.node].child_count;
    e.kept.all =
        e.children & kernels_.find_meeting_children(models_.node(e.side, e.node), box(other, e.pair.slot[index(other)]),
                                                    limits_of(e.pair), e.times);
  }
  SlotPair child_pair(const MovingExpansion& e, std::uint32_t child) const {
    SlotPair pair = e.pair;
    pair.slot[index(e.side)] = e.node * bvh::width + child;
    if constexpr (!at_any_pace) pair.first_time = e.times.first[child], pair.last_time = e.times.last[child];
    return pair;
  }

 private:
  bool is_leaf(Side s, const SlotPair& pair) const { return bvh::has_leaf(models_.tree(s), pair.slot[index(s)]); }

  /// The box of a slot; at any pace the one around those of both ends, at both.
  bvh::MovingBox box(Side s, bvh::SlotId slot) const {
    bvh::MovingBox box = models_.box(s, slot);
    if constexpr (!at_any_pace) return box;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      box.low[0][axis] = box.low[1][axis] = std::min(box.low[0][axis], box.low[1][axis]);
      box.high[0][axis] = box.high[1][axis] = std::max(box.high[0][axis], box.high[1][axis]);
    }
    return box;
  }

  const MovingPair& models_;
  const Collector& collector_;
  const simd::Kernels& kernels_;
  double separation_;
  QueryStats& stats_;
};

/// The visitor of PairWalk that offers a collector the pairs of elements of two leaves that may touch.
template <CollectsImpacts Collector>
class ImpactsOfLeaves {
 public:
  ImpactsOfLeaves(const MovingPair& models, const MovingBounds<Collector>& bounds, Collector& collector,
                  pair::BudgetMeter& meter, QueryStats& stats)
      : models_(models), bounds_(bounds), collector_(collector), meter_(meter), stats_(stats) {}

  /// To be asked before every pair: each is a step, also one that is pruned. So it counts here, not in count_step().
  bool has_to_end() {
    if (collector_.is_done() || meter_.is_spent(steps_)) return true;
    ++steps_;
    return false;
  }
  static constexpr void count_step() {}
  static constexpr bool prepare_visit(const SlotPair&) { return false; }

  /// Where a search has ended early: a time before which none of the pairs touches that are left of the leaves that
  /// were compared last. It is not better than that of the leaves. Infinite if nothing is left.
  double first_left_time() const { return first_left_time_; }

  /// Offers all, unless the collector or the budget ends that early: first_left_time() then says what is left.
  bool compare(const SlotPair& pair, bool, double&) {
    const MovingLeafOf a = models_.leaf(Side::a, pair.slot[0]), b = models_.leaf(Side::b, pair.slot[1]);
    if constexpr (at_any_pace) {
      if (collector_.stays(Side::a, a.leaf) && collector_.stays(Side::b, b.leaf)) return true;
    }
    const simd::SelfPair self{a.leaf, b.leaf};
    const simd::MotionLimits limits = bounds_.limits_of(pair);
    const auto find = [&](const simd::MotionLimits& piece, simd::ElementCandidates& found) {
      kernels_.find_impact_candidates(a.moving, b.moving, piece, a.owned, b.owned, models_.is_self() ? &self : nullptr,
                                      found);
      return found.vertex_face.count + found.face_vertex.count + found.edge_edge.count;
    };
    simd::ElementCandidates found, later;
    later.vertex_face.count = later.face_vertex.count = later.edge_edge.count = 0;
    const std::uint32_t count = find(limits, found);
    // Directions that keep elements apart at both ends of the time seldom do so where leaves turn far or pass each
    // other. Those of its middle more often do.
    if (!at_any_pace && count >= many_candidates && turn_or_pass(a.moving, b.moving, limits)) {
      const double middle = 0.5 * (limits.begin + limits.end);
      find({limits.begin, middle, limits.separation}, found);
      find({middle, limits.end, limits.separation}, later);
      keep_new(found.vertex_face, later.vertex_face);
      keep_new(found.face_vertex, later.face_vertex);
      keep_new(found.edge_edge, later.edge_edge);
    }
    const auto of_vertex_face = [&](simd::ElementCandidate c) { return models_.vertex_face(Side::a, a, c.a, b, c.b); };
    const auto of_face_vertex = [&](simd::ElementCandidate c) { return models_.vertex_face(Side::b, b, c.b, a, c.a); };
    const auto of_edges = [&](simd::ElementCandidate c) { return models_.edge_edge(a, c.a, b, c.b); };
    const auto offer_all = [&](const simd::ElementCandidates& some) {
      return offer(some.vertex_face, pair, of_vertex_face) && offer(some.face_vertex, pair, of_face_vertex) &&
             offer(some.edge_edge, pair, of_edges);
    };
    if (offer_all(found)) offer_all(later);
    return true;
  }

 private:
  static constexpr bool at_any_pace = MovingBounds<Collector>::at_any_pace;
  // So many pairs of elements take longer to compare than it takes to find those of both halves of the time.
  static constexpr std::uint32_t many_candidates = 16;

  /// Whether two leaves turn by more than about a right angle while the limits say, or pass each other by about their
  /// size. A guess; no answer depends on it.
  static bool turn_or_pass(const bvh::MovingLeaf& a, const bvh::MovingLeaf& b, const simd::MotionLimits& limits) {
    const auto at = [](double time, double start, double end) { return (1 - time) * start + time * end; };
    double way_sq = 0, size = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double start = b.center[0][axis] - a.center[0][axis], end = b.center[1][axis] - a.center[1][axis];
      const double way = (limits.end - limits.begin) * (end - start);
      way_sq += way * way;
    }
    for (const bvh::MovingLeaf* leaf : {&a, &b}) {
      double cosine = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto edge = [&](std::size_t end) {
          return leaf->unit[end] * double{leaf->corner[end][3 + axis][0] - leaf->corner[end][axis][0]};
        };
        const double first = edge(0), last = edge(1);
        cosine += at(limits.begin, first, last) * at(limits.end, first, last);
      }
      if (cosine <= 0) return true;
      size += std::max(leaf->unit[0], leaf->unit[1]);
    }
    return way_sq > size * size;
  }

  /// Removes from `list` what is in `known`.
  template <typename Candidates>
  static void keep_new(const Candidates& known, Candidates& list) {
    std::bitset<(3 * bvh::width) * (3 * bvh::width)> is_known;
    const auto place = [](simd::ElementCandidate c) { return c.a * 3 * bvh::width + c.b; };
    for (std::uint32_t i = 0; i < known.count; ++i) is_known.set(place(known.pairs[i]));
    const auto end = std::remove_if(list.pairs, list.pairs + list.count,
                                    [&](simd::ElementCandidate c) { return is_known[place(c)]; });
    list.count = static_cast<std::uint32_t>(end - list.pairs);
  }

  /// Offers candidates of one kind to the collector, without those that certainly do not touch if it asks for that.
  /// Returns whether more may be offered.
  template <typename Candidates, typename ElementsOf>
  bool offer(const Candidates& candidates, const SlotPair& leaves, const ElementsOf& elements_of) {
    constexpr std::uint32_t room = simd::MovingPairs::room;
    static_assert(room < 32);  // bits of a mask
    const bool excludes = collector_.wants_contacts_only();
    for (std::uint32_t i = 0; i < candidates.count && leaves.first_time <= collector_.max_time(); i += room) {
      const std::span<const simd::ElementCandidate> some(candidates.pairs + i, std::min(candidates.count - i, room));
      stats_.primitive_tests += some.size();  // pairs of elements count as pairs of triangles
      unsigned left = (1U << some.size()) - 1;
      if (excludes) left &= ~excluded_mask(some, bounds_.limits_of(leaves), elements_of);
      for (; left != 0; left &= left - 1) {
        // Some pairs take milliseconds.
        if (collector_.is_done() || meter_.cuts_short(steps_)) {
          first_left_time_ = leaves.first_time;
          return false;
        }
        const IdentifiedElements found = elements_of(some[std::countr_zero(left)]);
        collector_.compare(found.pair, found.elements);
      }
    }
    return true;
  }

  /// A bit mask of candidates of one kind that certainly do not touch in time. Pre: the separation is 0.
  template <typename ElementsOf>
  unsigned excluded_mask(std::span<const simd::ElementCandidate> candidates, const simd::MotionLimits& limits,
                         const ElementsOf& elements_of) const {
    LIMBER_ASSERT(!candidates.empty() && candidates.size() <= simd::MovingPairs::room && limits.separation == 0);
    simd::MovingPairs pairs;
    MovingElements::Kind kind{};
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const MovingElements elements = elements_of(candidates[k]).elements;
      kind = elements.kind;
      for (std::size_t end = 0; end < bvh::motion_ends; ++end) {
        const Vectors x = vectors_of(kind, elements.corners[end]);
        pairs.u[end][k] = x.u, pairs.v[end][k] = x.v, pairs.w[end][k] = x.w;
      }
    }
    return kernels_.exclude_impacts(pairs, kind == MovingElements::Kind::vertex_face, limits);
  }

  const MovingPair& models_;
  const MovingBounds<Collector>& bounds_;
  Collector& collector_;
  const simd::Kernels& kernels_ = simd::kernels();
  pair::BudgetMeter& meter_;
  QueryStats& stats_;
  double first_left_time_ = std::numeric_limits<double>::infinity();
  std::uint64_t steps_ = 0;
};

/// The walk that offers a collector the pairs of elements of two moving models, or of one, that may touch: depth first,
/// those that may meet first before the others.
template <CollectsImpacts Collector>
class ImpactSearch {
 public:
  ImpactSearch(const MovingPair& models, double separation, Collector& collector, pair::BudgetMeter& meter)
      : collector_(collector),
        bounds_(models, separation, collector, stats_),
        leaves_(models, bounds_, collector, meter, stats_) {}

  /// Searches all, or a part: one pair and all below.
  void run(const SlotPair& part = SlotPair::roots()) {
    first_later_time_ = part.first_later_time;
    order_.push(part);
    walk_.run();
  }
  /// Splits the search into parts, at least `count` where there is so much work, some thousand at most. The parts in
  /// this order, one after the other, with one collector, offer what run() does, in its order.
  std::vector<SlotPair> split(std::size_t count) { return walk_.split({SlotPair::roots()}, count); }

  /// A time before which none of the pairs that are left touches.
  double first_open_time() const {
    double first = std::min({collector_.max_time(), first_later_time_, leaves_.first_left_time()});
    for (const SlotPair& pair : order_.pairs()) first = std::min(first, pair.first_time);
    return first;
  }
  const QueryStats& stats() const { return stats_; }

 private:
  // Every pair visited adds less than `width` more and goes one level down one of two trees, each of at most 11 levels
  // (2^32 triangles): 2 * 11 * 7 = 154. A node with itself adds at most 8 and 28 pairs, on each of 11 levels.
  using Order = pair::StackOrder<SlotPair, 154 + 11 * 36>;

  Collector& collector_;
  QueryStats stats_{};
  double first_later_time_ = std::numeric_limits<double>::infinity();
  Order order_;
  MovingBounds<Collector> bounds_;
  ImpactsOfLeaves<Collector> leaves_;
  pair::NoObserver none_;
  pair::PairWalk<Order, MovingBounds<Collector>, ImpactsOfLeaves<Collector>> walk_{order_, bounds_, leaves_, none_};
};

}  // namespace limber::motion
