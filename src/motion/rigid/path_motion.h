// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/path.h"

/// Functions that queries of two moving bodies share with the sweep of one body through a scene.
namespace limber::motion {

/// Throws   std::invalid_argument, naming the function, unless the options are what their comments say.
void check_path_options(const PathOptions& options, const char* function);
void check_speed(double speed, const char* function);

/// How fast the points of a body's core move at most. A ball around a point of the core moves as that point does.
double speed_of(const Body& body, const RigidMotion& motion);

/// time_of_impact() of a body on a path and one that stands still, of which it is known that they do not touch before
/// a time.
///
/// Pre      The options and the speed are what they have to be, and `begin` is at most options.max_time. The motion is
///          null, or that of the path.
PathImpact first_impact(const Body& body, const RigidPath& path, const RigidMotion* motion, const Placed& standing,
                        double begin, const PathOptions& options);

}  // namespace limber::motion
