// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "limber/distance.h"
#include "pair/placed_pair.h"
#include "point/placed_model.h"
#include "point/ray_crossings.h"
#include "solid/probe.h"

namespace limber::solid {

/// Kinds of cells, into which two surfaces divide space: as bits of a set.
enum Cell : unsigned { in_neither = 0, in_a_alone = 1, in_b_alone = 2, in_both = 3 };

/// Which kinds of cells there are. Each is found by a probe, or shown to be missing.
class Cells {
 public:
  Cells(const Placed& a, const Placed& b) : placed_{a, b}, a_(a), b_(b) {}

  /// Finds the cell that a probe is in.
  template <typename Probe>
  void look(const Probe& probe) {
    const bool is_in_a = winding_number(a_, probe) != 0, is_in_b = winding_number(b_, probe) != 0;
    found_ |= bit((is_in_a ? in_a_alone : in_neither) | (is_in_b ? in_b_alone : in_neither));
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

  QueryStats stats{};

 private:
  static unsigned bit(unsigned cell) { return 1U << cell; }
  static constexpr unsigned bits_of_solids = 1U << in_a_alone | 1U << in_b_alone | 1U << in_both;

  template <typename Probe>
  int winding_number(const point::PlacedModel& model, const Probe& probe) {
    ++stats.node_tests;
    const AxisDirection& off = probe.off();
    const auto ray = model.ray_along(probe.position(), probe.rounding(), off.axis, off.is_upward);
    int number = 0;
    if (!ray) return number;
    point::visit_crossed(model, *ray, stats, [&](const Triangle& t) {
      number += winding_along(probe, t);
      return true;
    });
    return number;
  }

  Placed placed_[2];
  point::PlacedModel a_, b_;
  unsigned found_ = 0, missing_ = 0;
};

}  // namespace limber::solid
