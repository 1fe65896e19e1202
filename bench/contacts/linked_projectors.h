// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
#include <string>

#include "limber/mesh.h"

/// Libraries about closest points that are linked into this program. Each is one file, and takes part if it was found
/// when the build was configured.
namespace limber::bench {

/// A mesh of one library, ready for queries.
struct LinkedProjector {
  std::string library, setting;
  bool is_float = false;
  /// Writes the distance of each point, on the calling thread. Pre: there are as many distances as points.
  std::function<void(std::span<const Vec3> points, std::span<double> distances)> ask;
};

LinkedProjector embree_projector(const Mesh& mesh);
LinkedProjector cgal_projector(const Mesh& mesh);

}  // namespace limber::bench
