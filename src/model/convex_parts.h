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

  std::uint32_t count() const { return static_cast<std::uint32_t>(positions_.size()); }
  const Vec3& position(std::uint32_t corner) const { return positions_[corner]; }
  /// The middle of the corners.
  const Vec3& center() const { return center_; }
  /// Whether the model is as it was.
  bool is_of(const Model& model) const;

  /// Whether support() looks at every corner.
  bool is_scanned() const { return count() <= most_scanned; }
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
  static constexpr std::uint32_t most_scanned = 40;  // measured: from there on it takes longer than to climb

  struct UsedVertices;
  ConvexParts(const Model& model, const UsedVertices& used);
  Support climb(const Vec3& direction, std::uint32_t start) const;
  bool has_corners(TriangleId t, std::span<const std::uint32_t> corners) const;

  std::uint32_t surface_id_;
  std::uint64_t moved_vertices_;
  std::vector<Vec3> positions_;
  Vec3 center_;
  std::vector<Corners> triangles_;  // by corner
  mesh::VertexLists<std::uint32_t> neighbors_;
  mesh::VertexLists<TriangleId> triangles_of_;
};

}  // namespace limber::model
