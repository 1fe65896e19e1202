// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/check.h"
#include "bvh/tree.h"

namespace limber::pair {

/// What becomes of a pair that is not two leaves.
enum class Next {
  opened,  ///< the children of one of its nodes are to be compared with the other node
  raised,  ///< it has got a better bound, and may wait for its turn anew
  pruned
};

/// Nodes of one model whose children are still to be compared with each other: those from `first` up to `end`, the
/// last one first.
struct NodeRange {
  std::uint32_t first = 0, end = 0;
};

/// Watches a walk, and remembers nothing. FrontRecorder says what it may hear.
struct NoObserver {
  static constexpr bool is_recording() { return false; }
  static constexpr bool is_record(const auto&) { return false; }
  static constexpr bool reopens(auto&, const auto&) { return false; }
  static constexpr float* bounds_of_children() { return nullptr; }
  static constexpr void added(auto&) {}
  static constexpr void pruned(const auto&, double) {}
  static constexpr void compared(const auto&, double) {}
  static constexpr void pruned_children(const auto&) {}
};

/// The walk over pairs of nodes of two trees, or of one: the loop of every query. It takes a pair, prunes it, compares
/// it if it is two leaves, or opens one of its nodes, whose children it bounds and adds; until no pair is left, or the
/// visitor has to end. It can be run again, and then goes on where it was.
///
///   Order     which pair comes next: StackOrder, BucketOrder, HeapOrder
///   Bounds    what is known of the distance of two nodes, or of the time at which they meet: NodeBounds, MovingBounds,
///             and those of the sweep. All rules by which pairs of nodes are pruned are there.
///   Visitor   compares two leaves, for a collector, and says when to end: AllOfLeaves, BestOfLeaves, ImpactsOfLeaves
///   Observer  hears what is added, pruned and compared: FrontRecorder, or none
///
/// Pairs come from one of these: a pair that the caller adds to the order; siblings of one model (run_siblings());
/// records of a front (FrontRecorder::add_records()); what an interrupted walk has left.
///
/// Based on  [Larsen1999]: pairs of nodes of two trees; [Quinlan1994]: pairs that cannot improve the answer are pruned.
/// Differs   One node of a pair is opened at a time. Its eight children are compared with the other node at once.
template <typename Order, typename Bounds, typename Visitor, typename Observer = NoObserver>
class PairWalk {
 public:
  using Pair = typename Bounds::Pair;
  using Expansion = typename Bounds::Expansion;

  /// Refers to all of them.
  PairWalk(Order& order, Bounds& bounds, Visitor& visitor, Observer& observer)
      : order_(order), bounds_(bounds), visitor_(visitor), observer_(observer) {}

  void run() {
    while (!order_.empty() && !visitor_.has_to_end()) {
      Expansion e;
      e.pair = order_.take();
      if (visitor_.prepare_visit(e.pair)) order_.follow_cutoff();
      visit(e);
    }
  }

  /// Runs, and then compares the children of each of some nodes of one model with each other. Takes from the range what
  /// is done.
  ///
  /// Every pair is visited once: two triangles of one leaf are compared with that leaf; any two others have one lowest
  /// common ancestor.
  void run_siblings(NodeRange& nodes) {
    run();
    while (nodes.end > nodes.first && !visitor_.has_to_end()) {
      add_siblings(--nodes.end);
      run();
    }
  }

  /// Adds the children of a node of one model with each other, and with themselves.
  void add_siblings(std::uint32_t node) {
    visitor_.count_step();
    order_.follow_cutoff();
    const std::uint32_t count = bounds_.child_count(node);
    for (std::uint32_t k = 0; k < count; ++k) {
      const bvh::SlotId slot = node * bvh::width + k;
      if (bounds_.is_compared_with_itself(slot)) order_.add_itself(Pair::itself(slot));
      if (k + 1 == count) break;
      Expansion e;
      e.start_siblings(slot, count);
      bound_children(e);
      order_.add(e, bounds_);
    }
  }

  /// Goes straight down from a pair to two leaves, always to the first child, and compares them. Only if that does not
  /// end the query, as it often does where models intersect, are the other children on the way added.
  void descend(const Pair& from) {
    constexpr std::uint32_t longest = 23;  // expansions of two trees of at most 11 levels each, and the pair of leaves
    Pair pair = from;
    Expansion way[longest];
    std::uint32_t length = 0;
    for (;; ++length) {
      LIMBER_ASSERT(length < longest);
      Expansion& e = way[length];
      e.pair = pair;
      if (!opens(e)) break;
      bound_children(e);
      if (e.kept.all == 0) break;
      const std::uint32_t child = e.first_child();
      pair = bounds_.child_pair(e, child);
      e.kept.all &= ~(1U << child), e.kept.overlapping &= ~(1U << child);
    }
    if (visitor_.is_done()) return;
    for (std::uint32_t i = 0; i < length; ++i) order_.add(way[i], bounds_, false);  // the lowest ends on top
  }

  /// Splits pairs, given in the order in which they are taken, into at least `count` where there is so much work, some
  /// thousand at most. Visited in this order, they offer a collector what the walk offers from the given ones, in its
  /// order. Pre: the order is empty.
  std::vector<Pair> split(std::vector<Pair> pairs, std::size_t count) {
    std::vector<Pair> next;
    for (bool goes_on = true; goes_on && pairs.size() < count; pairs.swap(next)) {
      goes_on = false, next.clear();
      for (const Pair& pair : pairs) {
        if (bounds_.are_leaves(pair)) {
          next.push_back(pair);
          continue;
        }
        Expansion e;
        e.pair = pair;
        visit(e);
        goes_on = goes_on || !order_.empty();
        order_.move_to(next, pair);
      }
    }
    return pairs;
  }

 private:
  [[gnu::always_inline]] void visit(Expansion& e) {
    if (!opens(e)) return;
    bound_children(e);
    order_.add(e, bounds_);
  }

  /// Prunes a pair, compares it, or opens one of its nodes: then the result is true.
  [[gnu::always_inline]] bool opens(Expansion& e) {
    if (observer_.is_record(e.pair)) return observer_.reopens(e, bounds_);
    double apart = 0;
    if (bounds_.prunes(e.pair, apart)) {
      observer_.pruned(e.pair, apart);
      if (!observer_.is_recording()) order_.drop_pruned();
      return false;
    }
    visitor_.count_step();
    if (bounds_.are_leaves(e.pair)) {
      compare_leaves(e.pair);
      return false;
    }
    if constexpr (requires { bounds_.opens_itself(e.pair); }) {
      if (bounds_.opens_itself(e.pair)) {
        add_siblings(bounds_.opened_by_itself(e.pair));
        return false;
      }
    }
    const Next next = bounds_.template open<Order::raises>(e, apart);
    if (next == Next::pruned) {
      observer_.pruned(e.pair, apart);
      return false;
    }
    if (next == Next::raised && order_.takes_raised(e.pair)) return false;
    observer_.added(e);
    return true;
  }

  [[gnu::always_inline]] void compare_leaves(const Pair& pair) {
    double apart = 0;
    if (visitor_.compare(pair, observer_.is_recording(), apart)) {
      observer_.compared(pair, apart);
    } else {
      order_.add_first(pair);  // the query has ended before all of the two leaves was compared
    }
  }

  void bound_children(Expansion& e) {
    bounds_.bound_children(e, observer_.bounds_of_children());
    observer_.pruned_children(e);
  }

  Order& order_;
  Bounds& bounds_;
  Visitor& visitor_;
  Observer& observer_;
};

/// The order of PairWalk that goes depth first, with a stack: for queries that need every pair. Of pairs that are added
/// together the last is taken first; or, if pairs have an order, comes_before(), the first of that order, and nodes
/// with themselves come after all others.
template <typename Pair, std::uint32_t capacity>
class StackOrder {
 public:
  static constexpr bool raises = false;  // a better bound of a pair changes nothing

  bool empty() const { return size_ == 0; }
  Pair take() {
    --size_;
    if constexpr (is_sorted) group_ = size_;
    return pairs_[size_];
  }

  void push(const Pair& pair) {
    LIMBER_ASSERT(size_ < capacity);
    std::uint32_t at = size_++;
    if constexpr (is_sorted) {
      for (; at > group_ && pairs_[at - 1].comes_before(pair); --at) pairs_[at] = pairs_[at - 1];
    }
    pairs_[at] = pair;
  }
  void add_first(const Pair& pair) { push(pair); }
  void add_itself(const Pair& pair) {
    if constexpr (is_sorted) {
      LIMBER_ASSERT(size_ < capacity);
      std::copy_backward(pairs_ + group_, pairs_ + size_, pairs_ + size_ + 1);
      pairs_[group_++] = pair, ++size_;
    } else {
      push(pair);
    }
  }
  /// Adds the children that were kept.
  template <typename Expansion, typename Bounds>
  void add(const Expansion& e, const Bounds& bounds) {
    for (unsigned rest = e.kept.all; rest != 0; rest &= rest - 1) {
      push(bounds.child_pair(e, static_cast<std::uint32_t>(std::countr_zero(rest))));
    }
  }
  static constexpr bool takes_raised(const Pair&) { return false; }
  static constexpr void follow_cutoff() {}
  static constexpr void drop_pruned() {}

  /// Appends all pairs, in the order in which they would be taken: what a pair has become.
  void move_to(std::vector<Pair>& pairs, const Pair& from) {
    const auto begin = static_cast<std::ptrdiff_t>(pairs.size());
    pairs.insert(pairs.end(), pairs_, pairs_ + size_);
    if constexpr (is_sorted) Pair::note_later(std::span<Pair>(pairs).subspan(static_cast<std::size_t>(begin)), from);
    std::reverse(pairs.begin() + begin, pairs.end());
    size_ = group_ = 0;
  }
  /// Those that are left, the next one last.
  std::span<const Pair> pairs() const { return {pairs_, size_}; }

 private:
  static constexpr bool is_sorted = requires(const Pair& p) { p.comes_before(p); };

  Pair pairs_[capacity];
  std::uint32_t size_ = 0;
  std::uint32_t group_ = 0;  // where those begin that are added together
};

/// The order of PairWalk, and of searches of one tree, that goes best first: a heap. Of two entries one comes_before()
/// the other: standard libraries differ in how heaps order ties, so there are none.
template <typename Entry>
class HeapOrder {
 public:
  static constexpr bool raises = false;

  bool empty() const { return entries_.empty(); }
  const Entry& next() const { return entries_.front(); }
  Entry take() {
    LIMBER_ASSERT(!empty());
    std::pop_heap(entries_.begin(), entries_.end(), is_later);
    const Entry entry = entries_.back();
    entries_.pop_back();
    return entry;
  }
  void push(const Entry& entry) {
    entries_.push_back(entry);
    std::push_heap(entries_.begin(), entries_.end(), is_later);
  }
  void clear() { entries_.clear(); }

  void add_first(const Entry& entry) { push(entry); }
  template <typename Expansion, typename Bounds>
  void add(const Expansion& e, const Bounds& bounds) {
    for (unsigned rest = e.kept.all; rest != 0; rest &= rest - 1) {
      push(bounds.child_pair(e, static_cast<std::uint32_t>(std::countr_zero(rest))));
    }
  }
  static constexpr bool takes_raised(const Entry&) { return false; }
  static constexpr void follow_cutoff() {}
  static constexpr void drop_pruned() {}

 private:
  static bool is_later(const Entry& p, const Entry& q) { return q.comes_before(p); }

  std::vector<Entry> entries_;
};

}  // namespace limber::pair
