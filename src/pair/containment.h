// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "limber/distance.h"
#include "limber/model.h"
#include "pair/budget_meter.h"

namespace limber::pair {

/// Whether a part of one body's core lies inside of the other's, which is a solid.
struct Containment {
  Answer answer = Answer::no;
  /// If it does: a vertex that is inside, twice, a triangle that has it, and triangle 0 of the solid's surface.
  std::optional<Witness> witness;
};

inline bool has_solid(const Placed& a, const Placed& b) { return a.body().is_solid() || b.body().is_solid(); }

/// Looks for a part of either core inside of the other's surface. `steps` is how many the query has made so far; each
/// volume and each triangle that may be inside is one more, and takes as long as a closest point at most.
///
/// A core that is known to be in one piece is inside if its first vertex is. The tree of any other core is descended
/// where the sphere of a volume meets the surface, or is at least as large as the solid. Any other sphere is inside or
/// outside as a whole, as its center is; one that is off the box around the solid is outside, which is no step.
/// Triangles do not meet the surface, so each is inside if its first corner is.
///
/// Pre      The triangles of the two models do not meet. Both are committed, and both poses are rigid.
/// Cost     In practice some closest points, where the surfaces are not close to each other all over. O(n log m) at
///          worst. Allocates nothing.
Containment find_containment(const Placed& a, const Placed& b, std::uint64_t steps, BudgetMeter& meter,
                             QueryStats& stats);

}  // namespace limber::pair
