// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "limber/distance.h"
#include "pair/budget_meter.h"
#include "pair/placed_pair.h"
#include "point/placed_model.h"
#include "point/ray_crossings.h"
#include "solid/probe.h"

namespace limber::solid {

/// Kinds of cells, into which two surfaces divide space: as bits of a set.
enum Cell : unsigned { in_neither = 0, in_a_alone = 1, in_b_alone = 2, in_both = 3 };

/// Of both surfaces, around a point.
using WindingNumbers = std::array<int, 2>;

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
    std::size_t count = 0;
    point::visit_crossed(model, *ray, meter.stats, [&](const Triangle& t) {
      number += winding_along(probe, t);
      return !meter.is_spent_at(4 * ++count);
    });
    return number;
  }

  Placed placed_[2];
  point::PlacedModel a_, b_;
  unsigned found_ = 0, missing_ = 0;
};

}  // namespace limber::solid
