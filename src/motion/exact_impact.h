// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/moving_elements.h"

/// Continuous collision of two elements without any rounding: what time_of_impact() falls back on where its filter
/// cannot decide. docs/algorithms/impact.md proves it.
namespace limber::motion {

/// The first contact, as time_of_impact() promises it for min_separation 0.
///
/// Pre: the coordinates and options are in range.
ElementImpact exact_impact(const MovingElements& elements, const ElementImpactOptions& options);

/// Narrows [lower, upper] around the one time between them at which the elements are in one plane, to the width that
/// time_of_impact() promises.
///
/// Pre: lower < upper; the coplanarity polynomial has opposite signs at both, and one root between them.
void narrow_exactly(const MovingElements& elements, double time_error, double& lower, double& upper);

}  // namespace limber::motion
