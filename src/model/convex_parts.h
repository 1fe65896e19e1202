// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "limber/base.h"
#include "limber/math.h"
#include "limber/model.h"
#include "mesh/adjacency.h"

namespace limber::model {

/// What queries need of the core of a convex body: its corners, the vertices that triangles use, and what is next to
/// each. They are copies, which hold until a vertex of the model moves.
///
/// Queries ask bodies for supports alone, so this is where round cores would have theirs.
class ConvexParts {
 public:
  /// A corner, and its height along a direction.
  struct Support {
    std::uint32_t corner;
    double height;
  };

  explicit ConvexParts(const Model& model);

  std::uint32_t count() const { return count_; }
  Vec3 position(std::uint32_t corner) const {
    const double* const p = blocks_.data() + corner / lanes * block_size + corner % lanes;
    return {p[0], p[lanes], p[2 * lanes]};
  }
  /// The middle of the corners.
  const Vec3& center() const { return center_; }
  /// Whether the model is as it was.
  bool is_of(const Model& model) const;

  /// Whether support() looks at every corner.
  bool is_scanned() const { return count_ <= most_scanned; }
  /// The highest corner along a direction, or one that climbing from `start` takes for it: along edges, always upward.
  /// That ends at the highest corner, but for rounding.
  ///
  /// Source   [Cameron1997].
  Support support(const Vec3& direction, std::uint32_t start) const {
    return is_scanned() ? scan(direction) : climb(direction, start);
  }
  /// The highest of all corners.
  Support scan(const Vec3& direction) const;

  /// A triangle that has a point, which lies between up to three corners.
  TriangleId triangle_at(std::span<const std::uint32_t> corners, const Vec3& point) const;

 private:
  static constexpr std::size_t lanes = 4, block_size = 3 * lanes;
  static constexpr std::uint32_t most_scanned = 48;  // measured: from there on it takes longer than to climb

  struct UsedVertices;
  ConvexParts(const Model& model, const UsedVertices& used);
  Support climb(const Vec3& direction, std::uint32_t start) const;
  bool has_corners(TriangleId t, std::span<const std::uint32_t> corners) const;

  std::uint32_t count_;
  std::uint32_t surface_id_;
  std::uint64_t moved_vertices_;
  std::vector<double> blocks_;  // for four corners each: x, y and z; the last corner fills up
  Vec3 center_;
  std::vector<Corners> triangles_;  // by corner
  mesh::VertexLists<std::uint32_t> neighbors_;
  mesh::VertexLists<TriangleId> triangles_of_;
};

}  // namespace limber::model
