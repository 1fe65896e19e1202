// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/soup.h"
#include "limber/io.h"

namespace limber::io {

/// Which vertices of a file become one, as ReadOptions has it, in one frame or in several.
class Welding {
 public:
  Welding(const Soup& first_frame, const ReadOptions& options);

  /// Whether any two vertices are one.
  bool joins_any() const;

  /// Parts the vertices that are apart in a further frame. Pre: it has as many vertices as the first one.
  void part(std::span<const Vec3> frame);

  /// Welded vertices are numbered in order of first appearance.
  Weld result() const;

 private:
  /// Joins the firsts of `equal_to_` that are within the tolerance of each other.
  void join_near(std::span<const Vec3> positions, std::span<const std::uint32_t> part_of_vertex);

  // For each vertex the first one, itself or an earlier one, ...
  std::vector<VertexId> equal_to_;   // that is at an equal position in every frame
  std::vector<VertexId> joined_to_;  // that it is joined to, within the tolerance in every frame; empty without one
  double tolerance_;
};

/// Whether vertices at these positions may be one.
bool are_together(const Vec3& p, const Vec3& q, double tolerance);

}  // namespace limber::io
