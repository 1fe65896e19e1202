// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scenes/scenes.h"

/// Deforming meshes, frame by frame; as reproducible as the scenes.
namespace limber::scenes {

/// A mesh and the positions of its vertices in any frame, between frames too. Frame 0 is the mesh; frames are >= 0.
struct Motion {
  std::string name;
  Mesh mesh;
  std::function<std::vector<Vec3>(double frame)> positions;
};

/// wave_sheet(nx, ny, frame).
Motion waving_sheet(std::uint32_t nx, std::uint32_t ny);

/// The surface of a bar of 1 by 1 by 8, of squares with edge 1 / per_side, without its ends. The center is turned
/// against the ends, by two whole turns after 250 frames, and back.
Motion twisting_bar(std::uint32_t per_side);

/// A sheet of n * n squares that is drawn together to a third of its width in 250 frames, folding ever more, and then
/// smoothed out again.
Motion crumpling_cloth(std::uint32_t n);

/// Confetti whose pieces all change places within 500 frames, every piece along its own straight line.
Motion shuffled_soup(std::uint32_t triangles);

}  // namespace limber::scenes
