// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "limber/contacts.h"
#include "solid/cells.h"
#include "solid/disjoint_sets.h"

namespace limber::solid {

/// A triangle of either surface: those of a are numbered first.
using FacetId = std::size_t;

/// A facet, and another one that it meets elsewhere than in what they share by vertex ids.
struct Meeting {
  FacetId facet, other;
  friend bool operator==(const Meeting&, const Meeting&) = default;
  friend bool operator<(const Meeting& x, const Meeting& y) {
    return std::tie(x.facet, x.other) < std::tie(y.facet, y.other);
  }
};

/// Looks into all cells of two surfaces, by probes on both sides of all triangles.
///
/// One side of a triangle is a half-facet. It lies in one cell if no other triangle crosses it. Two of them lie in the
/// same cell if they are neighbors across an edge and nothing is between them there. Half-facets that are joined that
/// way are a shell, and one probe looks for all of them. A half-facet that others cross falls into pieces; each has a
/// part of a cut as border, and is looked into from there.
class Shells {
 public:
  /// `contacts` are all pairs of triangles of a and b that meet.
  Shells(Cells& cells, std::span<const TrianglePair> contacts);

  /// Looks until all kinds of cells are known; those not found then do not exist.
  void look();

 private:
  /// How a facet lies to another one, as bits.
  using Reach = std::uint8_t;
  static constexpr Reach in_front = 1, behind = 2;  // some part of it is strictly on that side of the other one's plane
  static constexpr Reach across = 4;                // it may cross the interior of the other one in a segment

  pair::Side side_of(FacetId f) const { return f < count_of_a_ ? pair::Side::a : pair::Side::b; }
  Triangle triangle(FacetId f) const;
  std::span<const Meeting> meetings_of(FacetId f) const;
  /// How `other` lies to `f`; 0 if they do not meet.
  Reach reach(FacetId f, FacetId other) const;
  Reach reach_of(const Triangle& other, const Triangle& t) const;

  void find_meetings(pair::Side s, FacetId first);
  void find_reaches();
  void join_neighbors(pair::Side s, FacetId first);
  /// Whether a facet is between the half-facets of two neighbors, next to the edge between these points.
  bool is_between(FacetId f, FacetId neighbor, Reach half, bool is_convex, const Segment& edge) const;
  void look_into_pieces(FacetId f, Reach half);
  void look_beside_cut(const Triangle& t, FacetId cutter, std::span<const FacetId> cutters, const AxisDirection& off);

  Cells& cells_;
  FacetId count_of_a_, count_;
  std::vector<Meeting> meetings_;    // sorted
  std::vector<std::size_t> begin_;   // of the meetings of each facet, and the end
  std::vector<Reach> reaches_;       // of the other facet of each meeting
  std::vector<bool> is_degenerate_;  // for each facet
  std::vector<Reach> cut_halves_;    // for each facet: its half-facets that others cross
  DisjointSets shells_;              // of half-facets: 2 f, and 2 f + 1 for the back
};

}  // namespace limber::solid
