// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include "limber/geometry.h"
#include "pair/placed_pair.h"
#include "solid/cells.h"
#include "solid/exact_point.h"

namespace limber::solid {

/// Whether two triangles have the same corners: 1 if they look the same way too, -1 if not; 0 otherwise.
int is_copy(const Triangle& y, const Triangle& t);

/// The segment in which two triangles, t and x, cross, and what else crosses it: there the cells around it change.
///
/// Four wedges are next to the segment: either side of t, and of x. In each of them a line leads along it, off the
/// plane of x by an infinitesimal amount and off that of t by a much smaller one. Winding numbers are counted where the
/// line begins. They change where it pierces a triangle, so no other place needs a ray.
class Cut {
 public:
  /// Of triangles of the surfaces `of_t` and `of_x`. Pre: both have an area and are not in parallel planes.
  Cut(const Triangle& t, pair::Side of_t, const Triangle& x, pair::Side of_x);
  Cut(const Cut&) = delete;
  Cut& operator=(const Cut&) = delete;

  /// Whether the triangles have more than a point in common.
  bool is_segment() const { return !ends_.empty(); }
  /// Takes another triangle, of the surface s, that meets both. Pre: it has an area, and is_segment().
  void add(const Triangle& y, pair::Side s);
  /// Whether one that was added may contain a part of the segment, and is no copy of t or x: then more than these keep
  /// wedges apart.
  bool is_shared() const { return is_shared_; }

  /// Looks into the cells on one side of t, the front (1) or the back (-1).
  void look(Cells& cells, int side_of_t);
  /// Looks into the cells of all wedges. Pre: each triangle has corners on both sides of the other, and the cut is not
  /// shared.
  void look_everywhere(Cells& cells);

 private:
  /// A triangle that crosses the segment between its ends.
  struct Crosser {
    Triangle triangle;
    pair::Side surface{};
    int step = 0;  // what piercing it adds to the winding number of its surface
    // On which side lines pass its edges: the one of the segment; where that meets the edge, one off the front of x;
    // where that does too, one off the front of t.
    std::array<std::array<int, 3>, 3> passes{};
    Estimate place{};                           // as a part of the segment
    mutable std::optional<ExactPoint> point{};  // once it is needed

    bool is_pierced(int side_of_t, int side_of_x) const;
  };

  /// Which of two is crossed first: -1 for x, 0 if both are crossed in one point.
  int compare(const Crosser& x, const Crosser& y) const;
  struct Before {
    const Cut& cut;
    bool operator()(const Crosser& x, const Crosser& y) const { return cut.compare(x, y) < 0; }
  };
  const ExactPoint& point_of(const Crosser& x) const;
  WindingNumbers begin(Cells& cells, int side_of_t, int side_of_x) const;
  void follow(Cells& cells, WindingNumbers numbers, int side_of_t, int side_of_x) const;

  Triangle t_, x_;
  std::vector<ExactPoint> ends_;            // two, or none
  IntegerVec along_;                        // from the first to the last
  std::size_t axis_ = 0;                    // along which they differ
  WindingNumbers behind_t_{}, behind_x_{};  // what numbers behind them, and behind copies of them, have more
  std::multiset<Crosser, Before> crossers_{Before{*this}};
  bool is_shared_ = false;
};

}  // namespace limber::solid
