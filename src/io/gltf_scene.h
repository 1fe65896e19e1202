// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "io/gltf_json.h"
#include "limber/math.h"

namespace limber::io {

/// An affine map; unlike Transform it may scale, shear and mirror.
struct AffineMap {
  Mat3 linear;
  Vec3 translation;
  int orientation = 1;  ///< the sign of the determinant: -1 for a map that mirrors

  Vec3 operator()(const Vec3& p) const { return linear * p + translation; }
};

/// The orientation is the product of theirs, which rounding cannot change.
AffineMap operator*(const AffineMap& a_from_b, const AffineMap& b_from_c);

/// The map of a 4 x 4 matrix by columns. `user` is what has the matrix, for messages.
AffineMap map_of_matrix(std::span<const double> matrix, const JsonItem& user);

/// Scales by s along the axes, turns by q, a quaternion x, y, z, w of any length but zero, then shifts by t.
AffineMap map_of_parts(std::span<const double> t, std::span<const double> q, std::span<const double> s,
                       const JsonItem& user);

/// A mesh as one node shows it.
struct MeshInstance {
  std::uint64_t mesh = 0;
  AffineMap world_from_mesh;
  JsonItem node;
};

/// The default scene of a file, or the first where none is named.
struct GltfScene {
  std::vector<MeshInstance> instances;                    ///< nodes before their children, and these in order
  std::vector<std::optional<AffineMap>> world_from_node;  ///< none for nodes of other scenes; empty without skins
};

/// Nodes that `KHR_node_visibility` hides show no mesh, nor do their children.
///
/// Errors   `malformed_file` unless the nodes are trees and the scene lists roots, each once;
///          `empty_mesh` when there is no scene.
/// Cost     O(number of nodes), without recursion.
GltfScene read_scene(const JsonItem& description);

}  // namespace limber::io
