// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "base/check.h"
#include "limber/contacts.h"
#include "mesh/adjacency.h"
#include "pair/budget_meter.h"
#include "solid/cut.h"

namespace limber::solid {

/// Disjoint sets of the numbers below some count: union-find with path halving.
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

/// A triangle of either surface: those of a are numbered first.
using FacetId = VertexId;

/// How a facet lies to another one, as bits.
using Sides = std::uint8_t;
inline constexpr Sides in_front = 1, behind = 2;  // some part of it is strictly on that side of the other one's plane
inline constexpr Sides across = 4;                // it crosses the interior of the other one in a segment

/// Another facet, which one meets elsewhere than in what they share by vertex ids.
struct Meeting {
  FacetId other;
  Sides sides;  // of the one, where the other is
};

/// Looks into all cells of two surfaces, by probes on both sides of all triangles.
///
/// One side of a triangle is a half-facet. It lies in one cell if no other triangle crosses it. Two of them lie in the
/// same cell if they are neighbors across an edge and nothing is between them there. Half-facets that are joined that
/// way are a shell, and one probe looks for all of them. A half-facet that others cross falls into pieces; each has a
/// part of a cut as border, and is looked into from there, unless one that borders the same cell is.
class Shells {
 public:
  /// `contacts` are all pairs of triangles of a and b that meet.
  Shells(Cells& cells, const std::deque<TrianglePair>& contacts);

  /// Looks until all kinds of cells are known, or the budget is spent. Those not found do not exist if it is not.
  void look();

 private:
  pair::Side side_of(FacetId f) const { return f < count_of_a_ ? pair::Side::a : pair::Side::b; }
  Triangle triangle(FacetId f) const;
  /// Its number among all half-facets: those of f come one after the other, first its front.
  static std::size_t half_facet(FacetId f, Sides half) { return std::size_t{2} * f + (half == in_front ? 0 : 1); }
  /// The sides of `f` where `other` is; 0 if they do not meet.
  Sides sides_between(FacetId f, FacetId other) const;

  void find_sides();
  void join_neighbors(pair::Side s, FacetId first);
  /// Whether a facet cuts the wedge between the half-facets of two neighbors, next to the edge between these points.
  bool cuts_wedge(FacetId f, FacetId neighbor, Sides half, bool is_convex, const Segment& edge) const;
  void look_into_pieces(FacetId f);
  /// Whether the cut of both is looked into from x: an order of facets. Those crossed from side to side come first.
  bool is_looked_into_before(FacetId x, FacetId f) const;
  void look_along_cut(FacetId f, const Meeting& cutter);
  /// Adds to the cut of two facets all others that meet both.
  void add_crossers(Cut& cut, FacetId f, FacetId other) const;

  Cells& cells_;
  FacetId count_of_a_, count_;
  mesh::VertexLists<Meeting> meetings_;  // of each facet, in the order of the others
  std::vector<bool> is_degenerate_;      // for each facet
  std::vector<bool> is_copy_;            // for each facet: whether one with the same corners comes before it
  std::vector<Sides>
      cut_halves_;       // for each facet: its half-facets that others cross; and `across` if one is on either side
  DisjointSets shells_;  // of half-facets
};

}  // namespace limber::solid
