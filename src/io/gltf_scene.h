// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "io/gltf_json.h"
#include "limber/math.h"

namespace limber::io {

/// An affine map; unlike Transform it may scale, shear and mirror.
struct AffineMap {
  Mat3 linear;
  Vec3 translation;

  Vec3 operator()(const Vec3& p) const { return linear * p + translation; }
};

/// A mesh as one node shows it.
struct MeshInstance {
  std::uint64_t mesh = 0;
  AffineMap world_from_mesh;
  JsonItem node;
};

/// All meshes of the default scene (the first, where none is named), nodes before their children and these in order.
///
/// Errors   As in gltf_json.h: `malformed_file` unless the nodes are trees and the scene lists roots, each once;
///          `empty_mesh` when there is no scene.
/// Cost     O(number of nodes), without recursion.
std::vector<MeshInstance> mesh_instances(const JsonItem& description);

}  // namespace limber::io
