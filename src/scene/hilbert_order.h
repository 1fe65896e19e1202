// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "limber/math.h"

namespace limber::scene {

/// Orders points so that those which follow each other are near each other: along a Hilbert curve through the cells of
/// a grid.
///
/// Based on  [Hamilton2008] for the curve.
/// Differs   Where more points are in one cell than a node has children, the cell gets a grid of its own, about the
///           points in it. So a grid need not be fine, and a point far away does not spoil the order of all others.
class HilbertOrder {
 public:
  /// The indices of `centers`, in order. Depends on the points alone; equal points are in the order of their indices.
  /// Valid until the next call.
  ///
  /// Cost     O(n) for points that are spread out, O(n log n) for others; allocates where there are more points than
  ///          ever.
  std::span<const std::uint32_t> sort(std::span<const Vec3> centers);

 private:
  using Entry = std::uint64_t;  // the place of the cell on the curve, then the index

  void sort_range(std::span<const Vec3> centers, std::size_t begin, std::size_t end);
  void sort_entries(std::size_t begin, std::size_t end);

  std::vector<Entry> entries_, other_entries_;
  std::vector<std::uint32_t> order_;
};

}  // namespace limber::scene
