// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "base/check.h"
#include "limber/contacts.h"
#include "mesh/adjacency.h"
#include "pair/budget_meter.h"
#include "solid/cut.h"

namespace limber::solid {

/// Disjoint sets of the numbers below some count: union-find with path halving. A set is named by its representative.
class DisjointSets {
 public:
  /// They are incomplete, and must not be used, if the meter is spent before they are made.
  DisjointSets(std::size_t count, pair::Meter& meter) {
    parent_.reserve(count);
    while (parent_.size() < count && !meter.is_spent_at(parent_.size())) parent_.push_back(parent_.size());
  }

  /// The representative of a number's set, the least of its members.
  std::size_t find(std::size_t i) {
    LIMBER_ASSERT(i < parent_.size());
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::size_t i, std::size_t j) {
    const auto [low, high] = std::minmax({find(i), find(j)});
    parent_[high] = low;
  }

 private:
  std::vector<std::size_t> parent_;
};

/// A triangle of either surface: those of a are numbered first. Each of its two sides is a half-facet.
using FacetId = VertexId;

/// Where another facet lies, seen from one facet, as bits.
using Sides = std::uint8_t;
inline constexpr Sides in_front = 1, behind = 2;  // some part of the other is strictly on that side of the one's plane
inline constexpr Sides across = 4;                // the other crosses the interior of the one in a segment

/// Says of one facet that it meets another one: elsewhere than in what they share by vertex ids, or as its copy, which
/// has the same corners.
struct Meeting {
  FacetId other;
  Sides sides;  // where the other one lies

  /// Whether the other facet crosses this one from side to side.
  bool is_through() const { return sides == (in_front | behind | across); }
  /// The order of the meetings of a facet.
  static bool comes_before(const Meeting& m, FacetId other) { return m.other < other; }
};

/// Looks into all cells of two surfaces, the parts into which they divide space, by probes; shells.cpp has the steps.
///
/// A half-facet borders one cell if no other facet crosses it. One that is crossed falls into pieces, each of which
/// borders a cell. A cut, the segment in which two facets cross, is a part of the border of pieces.
class Shells {
 public:
  /// `contacts` are all pairs of triangles of a and b that meet.
  Shells(Cells& cells, const std::deque<TrianglePair>& contacts);

  /// Looks until all kinds of cells are known, or the budget is spent. Those not found do not exist if it is not.
  void look() {
    find_sides();
    if (!cells_.are_all_known() && !cells_.is_stopped()) join_neighbors(pair::Side::a, 0);
    if (!cells_.are_all_known() && !cells_.is_stopped()) join_neighbors(pair::Side::b, count_of_a_);
    look_into_shells();
    look_along_cuts();
  }

 private:
  pair::Side side_of(FacetId f) const { return f < count_of_a_ ? pair::Side::a : pair::Side::b; }
  Triangle triangle(FacetId f) const {
    LIMBER_ASSERT(f < count_);
    const point::PlacedModel& model = cells_.model(side_of(f));
    return model.triangle(model.mesh().triangles[f < count_of_a_ ? f : f - count_of_a_]);
  }
  /// Its number among all half-facets: those of f come one after the other, first its front.
  static std::size_t half_facet(FacetId f, Sides half) { return std::size_t{2} * f + (half == in_front ? 0 : 1); }
  /// Where `other` lies, seen from f; 0 if they do not meet.
  Sides sides_between(FacetId f, FacetId other) const {
    const std::span<const Meeting> meetings = meetings_.of(f);
    const auto found = std::lower_bound(meetings.begin(), meetings.end(), other, Meeting::comes_before);
    return found == meetings.end() || found->other != other ? Sides{0} : found->sides;
  }

  void find_sides();
  /// Joins half-facets of neighbors of the surface s, whose facets are numbered from `first` on.
  void join_neighbors(pair::Side s, FacetId first);
  /// Whether a facet may be in the wedge between the half-facets of two neighbors, next to the edge between these
  /// points. A wrong yes costs a probe, no more: so it is the answer if the budget is spent.
  bool may_be_between(FacetId f, FacetId neighbor, Sides half, bool is_convex, const Segment& edge) const;
  void look_into_shells();
  void look_along_cuts();
  /// Whether x comes before f in the order in which cuts are looked into, of *Where to look*, 5, in solids.md: those
  /// crossed from side to side first.
  bool is_looked_into_before(FacetId x, FacetId f) const {
    return is_crossed_through_[x] != is_crossed_through_[f] ? is_crossed_through_[x] : x < f;
  }
  /// Looks into the cells beside the cut of two facets on each side of f where the cutter lies, unless 5 leaves it out.
  void look_along_cut(FacetId f, const Meeting& cutter);
  /// Adds to the cut of two facets all others that meet both.
  void add_crossers(Cut& cut, FacetId f, FacetId other) const;

  Cells& cells_;
  FacetId count_of_a_, count_;
  mesh::VertexLists<Meeting> meetings_;  // of each facet, in the order of the others
  // Of each facet: whether it has no area; whether one with the same corners comes before it; whether another one
  // crosses it from side to side; and its half-facets that others cross, in_front and behind.
  std::vector<bool> is_degenerate_ = std::vector<bool>(count_), is_copy_ = is_degenerate_,
                    is_crossed_through_ = is_degenerate_;
  std::vector<Sides> cut_halves_ = std::vector<Sides>(count_);
  DisjointSets shells_;  // of half-facets
};

}  // namespace limber::solid
