// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <vector>

#include "base/check.h"
#include "limber/distance.h"
#include "limber/geometry.h"
#include "pair/budget_meter.h"
#include "pair/placed_pair.h"
#include "point/placed_model.h"
#include "solid/probe.h"

namespace limber::solid {

/// Kinds of cells, into which two surfaces divide space: as bits of a set.
enum Cell : unsigned { in_neither = 0, in_a_alone = 1, in_b_alone = 2, in_both = 3 };

/// Of both surfaces, around a point.
using WindingNumbers = std::array<int, 2>;

/// As how many short steps exact decisions about a triangle or an edge count: a guess; no answer depends on it.
inline constexpr std::size_t steps_of_decisions = 4;

/// Which kinds of cells there are. Each is found by a probe, or shown to be missing.
class Cells {
 public:
  Cells(const Placed& a, const Placed& b, const QueryBudget& wanted = {})
      : meter(wanted), budget(wanted), placed_{a, b}, a_(a), b_(b) {}

  /// Finds the cell that a probe is in, unless the budget is spent before.
  template <typename Probe>
  void look(const Probe& probe) {
    const WindingNumbers numbers = winding_numbers(probe);
    if (!is_stopped()) note_found(numbers);
  }
  /// Around a probe. They mean nothing if the budget was spent before they were known.
  template <typename Probe>
  WindingNumbers winding_numbers(const Probe& probe) {
    return {winding_number(a_, probe), winding_number(b_, probe)};
  }
  void note_found(const WindingNumbers& numbers) {
    found_ |= bit((numbers[0] != 0 ? in_a_alone : in_neither) | (numbers[1] != 0 ? in_b_alone : in_neither));
  }
  /// Finds the cells on both sides of a triangle, next to a corner.
  void look_beside(const Triangle& t, std::size_t corner) {
    for (const int side : {1, -1}) {
      if (const auto off = direction_off(t, side)) look(CornerProbe(t, corner, *off));
    }
  }

  void note_missing(unsigned cell) { missing_ |= bit(cell); }
  /// Whether there is no kind of cell left to look for.
  bool are_all_known() const { return ((found_ | missing_) & bits_of_solids) == bits_of_solids; }
  bool has(unsigned cell) const { return (found_ & bit(cell)) != 0; }

  const Placed& placed(pair::Side s) const { return placed_[pair::index(s)]; }
  const point::PlacedModel& model(pair::Side s) const { return s == pair::Side::a ? a_ : b_; }

  /// Whether the budget has ended the search, so that what is not known stays so.
  bool is_stopped() const { return meter.stopped_by() != StoppedBy::nothing; }

  pair::Meter meter;
  const QueryBudget budget;

 private:
  static unsigned bit(unsigned cell) { return 1U << cell; }
  static constexpr unsigned bits_of_solids = 1U << in_a_alone | 1U << in_b_alone | 1U << in_both;

  template <typename Probe>
  int winding_number(const point::PlacedModel& model, const Probe& probe) {
    ++meter.stats.node_tests;
    const AxisDirection& off = probe.off();
    const auto ray = model.ray_along(probe.position(), probe.rounding(), off.axis, off.is_upward);
    int number = 0;
    if (!ray || meter.is_spent()) return number;
    std::size_t hits = 0;
    point::visit_crossed(model, *ray, meter.stats, [&](const Triangle& t) {
      number += winding_along(probe, t);
      return !meter.is_spent_at(steps_of_decisions * ++hits);
    });
    return number;
  }

  Placed placed_[2];
  point::PlacedModel a_, b_;
  unsigned found_ = 0, missing_ = 0;
};

/// Of a copy of t, which has the same corners: 1 if it looks the same way as t, -1 if the other way. 0 if y is no copy.
int orientation_of_copy(const Triangle& y, const Triangle& t);

/// The segment that two triangles, t and x, have in common, and the other triangles that cross it.
///
/// The planes of t and x divide the surroundings of the segment into four wedges: each is on one side of t, and on one
/// of x. Along each wedge leads a line that is infinitesimally close to the segment: off the plane of x by some e, and
/// off that of t by e^2. A ray counts the winding numbers where the line begins. From there on they change only where
/// the line pierces a crosser, a triangle that crosses the segment, so no other point of it needs a ray.
///
/// A line pierces a triangle if it passes the three edges on one side. Let h_t(p) and h_x(p) be the heights of a point
/// over the planes of t and x. The line in which both planes meet passes the edge p q on the side that is the sign of
///     det(p, q) = h_t(p) h_x(q) - h_t(q) h_x(p).
/// Where it is 0, the line meets that of the edge. Moving the line to the front of x lowers h_x by e, so det grows by
/// e (h_t(q) - h_t(p)). If that is 0 too, moving to the front of t decides: h_x(p) - h_x(q). A back changes the sign.
/// This is symbolic perturbation [EdelsbrunnerMuecke1990], of a line, and with a meaning: it leads into a wedge.
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

  /// Looks into all cells beside the segment on one side of t, the front (1) or the back (-1). Pre: t has corners on
  /// both sides of x.
  void look(Cells& cells, int side_of_t) const {
    for (const int side_of_x : {1, -1}) follow(cells, begin(cells, side_of_t, side_of_x), side_of_t, side_of_x);
  }
  /// Looks into the cells of all wedges, with one ray. Pre: each triangle has corners on both sides of the other, and
  /// the cut is not shared.
  void look_everywhere(Cells& cells) const;

 private:
  /// A triangle that crosses the segment between its ends.
  struct Crosser {
    Triangle triangle;
    pair::Side surface{};
    int step = 0;  // what piercing it adds to the winding number of its surface
    // For each edge the sign of det(p, q). Where it is 0, also the signs of what it grows by if the line is moved to
    // the front of x, and to the front of t.
    std::array<int, 3> of_line{}, of_move_off_x{}, of_move_off_t{};
    Estimate place{};                           // of the crossing, as a part of the segment
    mutable std::optional<ExactPoint> point{};  // the crossing, once it is needed
    mutable bool is_with_previous = false;      // whether the crosser before it is crossed in the same point

    /// Whether the line in a wedge pierces it: it passes all three edges on one side.
    bool is_pierced(int side_of_t, int side_of_x) const {
      int common_side = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const int off_x = side_of_x * of_move_off_x[i], off_t = side_of_t * of_move_off_t[i];
        const int side = of_line[i] != 0 ? of_line[i] : off_x != 0 ? off_x : off_t;
        LIMBER_ASSERT(side != 0);
        if (side == -common_side) return false;
        common_side = side;
      }
      return true;
    }
  };

  /// Which of two crossers the segment meets first: -1 for `c`, 1 for `other`, 0 if it meets both in one point.
  int compare(const Crosser& c, const Crosser& other) const {
    const double ahead = other.place.value - c.place.value, error = c.place.error + other.place.error;
    if (std::abs(ahead) > error) return ahead > 0 ? -1 : 1;
    return orientation_of_copy(c.triangle, other.triangle) != 0 ? 0 : point_of(c).compare(point_of(other), axis_);
  }
  struct Before {
    const Cut& cut;
    bool operator()(const Crosser& c, const Crosser& other) const { return cut.compare(c, other) < 0; }
  };
  const ExactPoint& point_of(const Crosser& c) const {
    if (!c.point) c.point = crossing(ends_[0], ends_[1], c.triangle);
    return *c.point;
  }
  /// The winding numbers where the line in a wedge begins, by a ray. Pre: t has a corner on that side of x.
  WindingNumbers begin(Cells& cells, int side_of_t, int side_of_x) const;
  /// Notes the cells along the line in a wedge, given the numbers where it begins.
  void follow(Cells& cells, WindingNumbers numbers, int side_of_t, int side_of_x) const {
    std::size_t steps = 0;
    for (const Crosser& c : crossers_) {
      if (cells.meter.is_spent_at(++steps)) return;
      if (!c.is_with_previous) cells.note_found(numbers);
      if (c.is_pierced(side_of_t, side_of_x)) numbers[pair::index(c.surface)] += c.step;
    }
    if (!cells.is_stopped()) cells.note_found(numbers);
  }

  Triangle t_, x_;
  std::vector<ExactPoint> ends_;  // of the segment: two
  IntegerVec along_;              // from the first to the last
  std::size_t axis_ = 0;          // along which they differ
  // By how much winding numbers behind t are larger than in front of it, copies of it included; and so for x.
  WindingNumbers behind_t_{}, behind_x_{};
  std::multiset<Crosser, Before> crossers_{Before{*this}};
  bool is_shared_ = false;
};

}  // namespace limber::solid
