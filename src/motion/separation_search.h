// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/moving_elements.h"

namespace limber::motion {

/// The first time at which two elements are within a distance of each other, as time_of_impact() promises it.
///
/// Pre: those of time_of_impact(), and options.min_separation > 0.
/// Source   docs/algorithms/impact.md, "With a separation".
ElementImpact separation_impact(const MovingElements& elements, const ElementImpactOptions& options);

/// Whether the same bounds show, with little effort, that two elements do not touch up to a time. Never true where they
/// do.
///
/// Pre: those of time_of_impact().
bool are_certainly_apart(const MovingElements& elements, double max_time);

}  // namespace limber::motion
