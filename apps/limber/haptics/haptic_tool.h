// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "limber/mesh.h"

/// The tool of the haptic loop: an ellipsoid, and where it is commanded to be. Lengths are in mm, z is up.
namespace limber::program {

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
