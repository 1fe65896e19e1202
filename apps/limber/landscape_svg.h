// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "demo_run.h"

/// Pictures of the last frame as inline SVG, seen from above at a slant, without perspective and true to scale.
namespace limber::program {

/// The whole sheet with the path of the ball.
std::string sheet_svg(const DemoRun& run);

/// The ball and the triangles around it, with the witness points, the segment between them and the triangles they lie
/// on.
std::string close_up_svg(const DemoRun& run);

}  // namespace limber::program
