// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/moving_elements.h"

namespace limber::motion {

/// time_of_impact() of two elements. Pre: the coordinates and options are in range.
ElementImpact impact_of(const MovingElements& elements, const ElementImpactOptions& options);

}  // namespace limber::motion
