// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/moving_elements.h"
#include "motion/moving_pair.h"

namespace limber::motion {

/// The distance of two elements at the start.
double start_distance(const MovingElements& elements);

/// What state_of() promises.
ElementState state_at(const MovingPair& models, const IdentifiedElements& found, double time);

}  // namespace limber::motion
