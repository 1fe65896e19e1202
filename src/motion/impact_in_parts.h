// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/motion.h"
#include "motion/impact_collectors.h"
#include "motion/moving_pair.h"

namespace limber::motion {

/// What a search for the first impact has found.
struct FoundImpact {
  FirstImpact collector;
  double first_open_time;  ///< as ImpactSearch has it at its end
  StoppedBy stopped_by = StoppedBy::nothing;
  QueryStats stats{};
};

/// The first impact on the threads of the calling arena, without limits, with the bits that one thread gives. `stats`
/// count the split and the parts whose answers count, so they do not depend on threads, but are a little more than
/// those of one thread.
FoundImpact find_first_in_parts(const MovingPair& models, const ImpactOptions& options);

}  // namespace limber::motion
