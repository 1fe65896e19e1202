// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "limber/mesh.h"

/// The tissue of the haptic loop, and its tool: an ellipsoid, and where it is commanded to be. Lengths are in mm, z is
/// up.
namespace limber::program {

/// How high the upper face of the tissue at rest is above (x, y).
double resting_height(double x, double y);

/// A thick square sheet with a wavy upper face, which gives way to a tool and comes back slowly. Vertices of the upper
/// face move up and down; no other does.
class Tissue {
 public:
  /// `tick_s` is the time between two calls of press(). Pre: at_most >= 96.
  Tissue(std::uint64_t at_most, double tick_s);

  /// At rest: a closed mesh of as many triangles as such a sheet can have, at most `at_most`.
  Mesh mesh() const;

  /// Vertices that move, and their new positions, valid until the next call.
  struct Moves {
    std::span<const VertexId> ids;
    std::span<const Vec3> positions;
  };

  /// What moves in one tick while the lowest point of a tool is commanded to be at `tip`: what was dented before comes
  /// back a little, and what is above the tip gives way, at the deepest point to two thirds of its depth. The dent is
  /// a paraboloid, wider than the tool, as tissue is drawn down around what presses into it. The sheet at rest is a
  /// grid, so the vertices near the tip are known by their indices. A vertex that has moved by less than 0.005 mm,
  /// which cannot be felt, is left for later.
  ///
  /// Cost     O(vertices near the tip + vertices that are dented). Allocates nothing.
  Moves press(const Vec3& tip);

 private:
  /// Calls f(vertex, depth) for the vertices that a paraboloid with its lowest point at the tip reaches below their
  /// resting height, by `depth`.
  template <typename Function>
  void for_each_above(const Vec3& tip, const Function& f) const;
  void relax();
  void dent(const Vec3& tip);
  void list_moves();

  std::uint32_t n_;  // squares along a side
  double spacing_, kept_a_tick_;
  std::vector<double> resting_z_, depth_;  // of the upper face's vertices; how far each is below its resting height
  std::vector<double> handed_over_;        // the depth that press() has last reported of each
  std::vector<VertexId> dented_;           // those with a depth > 0; as much room as there are vertices, here and below
  std::vector<VertexId> moved_ids_;
  std::vector<Vec3> moved_positions_;
};

inline constexpr Vec3 tool_semi_axes{8, 8, 16};

/// The tool's mesh around the origin, its long axis along z.
///
/// Pre      at_most >= 24.
/// Returns  As many triangles as two poles and rows of squares between them can have, at most `at_most`.
Mesh tool_mesh(std::uint64_t at_most);

/// The lowest point of the tool, as a shape rather than as a mesh, at a pose.
Vec3 tip_at(const Transform& pose);

/// Where the device is after `seconds`: the pose that the tool would have if there were no tissue. Every two seconds it
/// comes down, presses up to 3 mm into the resting tissue and is lifted again, while it wanders over the whole tissue.
Transform device_pose(double seconds);

/// How far the device moves in a second, at most.
inline constexpr double fastest_mm_per_s = 60;

/// How long one approach, pressing and lifting takes.
inline constexpr double press_period_s = 2;

}  // namespace limber::program
