// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion/moving_elements.h"

namespace limber::motion {

/// What a filter in float64 knows about the first contact.
struct FilterResult {
  enum class Verdict {
    clear,    ///< the elements do not touch until the largest time
    contact,  ///< they touch first in [lower, upper]; they come to be in one plane once between these times
    unknown,  ///< the filter cannot tell
  };
  Verdict verdict = Verdict::unknown;
  double lower = 0, upper = 0;
};

/// Decides most pairs in float64 with bounds on all rounding: by axes along which the elements are apart, by signs of
/// the coplanarity polynomial, and by signs of the parameters of the point in which the elements would meet.
///
/// Pre: those of time_of_impact().
/// Source   docs/algorithms/impact.md.
FilterResult filter_impact(const MovingElements& elements, const ElementImpactOptions& options);

}  // namespace limber::motion
