// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/moving_elements.h"

namespace limber::motion {

/// The answer of filter_impact().
struct FilterResult {
  enum class Verdict {
    clear,    ///< the elements do not touch up to the largest time
    contact,  ///< the first contact, not at the start, is in [lower, upper]; between these times the coplanarity
              ///< polynomial has one root, and opposite signs at both
    unknown,  ///< the filter cannot tell
  };
  Verdict verdict = Verdict::unknown;
  double lower = 0, upper = 0;  ///< mean something for `contact` only
};

/// Decides most pairs in float64 with bounds on all rounding: by axes along which the elements are apart, by signs of
/// the coplanarity polynomial, and by signs of the parameters of the point in which the elements would meet.
///
/// Pre: those of time_of_impact().
/// Source   docs/algorithms/impact.md.
FilterResult filter_impact(const MovingElements& elements, const ElementImpactOptions& options);

}  // namespace limber::motion
