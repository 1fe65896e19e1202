// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/moving_elements.h"

namespace limber::motion {

/// Throws std::invalid_argument, naming `function`, unless the options are what their comments say.
void check(const ElementImpactOptions& options, const char* function);

/// time_of_impact() of two elements. Pre: the coordinates and options are in range.
ElementImpact impact_of(const MovingElements& elements, const ElementImpactOptions& options);

}  // namespace limber::motion
