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

/// The segment that two triangles, t and x, have in common, and the other triangles that cross it.
///
/// The planes of t and x divide the surroundings of the segment into four wedges: each is on one side of t, and on one
/// of x. Along each wedge leads a line that is infinitesimally close to the segment: off the plane of x by some
/// distance, and off that of t by a much smaller one. A ray counts the winding numbers where the line begins. From
/// there on they change only where the line pierces a triangle, so no other point of it needs a ray.
class Cut {
 public:
  /// The cut of t, a triangle of the surface `of_t`, and x, one of the surface `of_x`. Pre: both have an area, their
  /// planes are not parallel, and what they have in common is more than a point.
  Cut(const Triangle& t, pair::Side of_t, const Triangle& x, pair::Side of_x);
  Cut(const Cut&) = delete;
  Cut& operator=(const Cut&) = delete;

  /// Adds another triangle, of the surface s, that meets both. Pre: it has an area.
  void add(const Triangle& y, pair::Side s);
  /// Whether an added triangle that is no copy of t or x may contain a part of the segment. It may then divide a wedge,
  /// or keep two of them apart, so that the numbers of one do not follow from those of another.
  bool is_shared() const { return is_shared_; }

  /// Looks into all cells beside the segment on one side of t, the front (1) or the back (-1).
  void look(Cells& cells, int side_of_t);
  /// Looks into the cells of all wedges, with one ray. Pre: each triangle has corners on both sides of the other, and
  /// the cut is not shared.
  void look_everywhere(Cells& cells);

 private:
  /// A triangle that crosses the segment between its ends.
  struct Crosser {
    Triangle triangle;
    pair::Side surface{};
    int step = 0;  // what piercing it adds to the winding number of its surface
    // passes[k][i] tells on which side of edge i a line passes: for k = 0 that of the segment. Where it is 0, that line
    // meets the edge, and is moved off: to the front of x for k = 1, and where that is 0 too, to that of t for k = 2.
    std::array<std::array<int, 3>, 3> passes{};
    Estimate place{};                           // of the crossing, as a part of the segment
    mutable std::optional<ExactPoint> point{};  // the crossing, once it is needed
    mutable bool is_with_last = false;          // whether one before it is crossed in the same point

    /// Whether the line in a wedge pierces it: it passes all three edges on the same side.
    bool is_pierced(int side_of_t, int side_of_x) const;
  };

  /// Which of two the segment crosses first: -1 for x, 0 if both are crossed in one point.
  int compare(const Crosser& x, const Crosser& y) const;
  struct Before {
    const Cut& cut;
    bool operator()(const Crosser& x, const Crosser& y) const { return cut.compare(x, y) < 0; }
  };
  const ExactPoint& point_of(const Crosser& x) const;
  /// The winding numbers where the line in a wedge begins, by a ray.
  WindingNumbers begin(Cells& cells, int side_of_t, int side_of_x) const;
  /// Notes the cells along the line in a wedge, given the numbers where it begins.
  void follow(Cells& cells, WindingNumbers numbers, int side_of_t, int side_of_x) const;

  Triangle t_, x_;
  std::vector<ExactPoint> ends_;  // two
  IntegerVec along_;              // from the first to the last
  std::size_t axis_ = 0;          // along which they differ
  // By how much winding numbers behind t are larger than in front of it, copies of it included; and so for x.
  WindingNumbers behind_t_{}, behind_x_{};
  std::multiset<Crosser, Before> crossers_{Before{*this}};
  bool is_shared_ = false;
};

}  // namespace limber::solid
