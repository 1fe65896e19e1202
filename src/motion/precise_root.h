// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "limber/motion.h"
#include "motion/moving_elements.h"

namespace limber::motion {

/// narrow_exactly() with a time_error of 0, by Newton's method in double-double arithmetic: the two neighboring
/// multiples of 2^-53 around the root of the coplanarity polynomial. Nothing if that is not enough to tell them.
///
/// Pre      There is one root from `lower` to `upper`, both in [0, 1].
std::optional<ElementImpact> narrow_precisely(const MovingElements& elements, double lower, double upper);

}  // namespace limber::motion
