// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "haptics/haptic_report.h"

namespace limber::program {

/// A self-contained page: histograms of the times, the slowest ticks over time, and the summary.
///
/// Pre      The run is not empty.
std::string haptic_page(const HapticRun& run, const HapticSummary& summary);

}  // namespace limber::program
