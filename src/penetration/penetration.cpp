// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries: each checks its arguments, and searches.
#include "limber/penetration.h"

#include <algorithm>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "penetration/deepest_vertex.h"
#include "penetration/shortest_translation.h"
#include "penetration/sweep.h"
#include "penetration/way_out.h"

namespace limber {

DeepestVertices deepest_vertices(const PlacedSurface& a, const PlacedSurface& b,
                                 const DeepestVerticesOptions& options) {
  const base::DefaultFloatEnvironment environment;
  const point::PlacedModel placed_a(Access::placed(a)), placed_b(Access::placed(b));
  pair::Meter meter(options.budget);
  const DeepestPair found = penetration::find_deepest(placed_a, placed_b, meter);
  return {found, meter.stopped_by(), meter.stats};
}

SeparatingTranslation separating_translation(const PlacedSurface& a, const PlacedSurface& b, const Vec3& direction,
                                             const SeparatingTranslationOptions& options) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(is_finite(direction) && max_abs(direction) > 0,
                 "limber::separating_translation: the direction must be finite, and not 0");
  const point::PlacedModel placed_a(Access::placed(a)), placed_b(Access::placed(b));
  pair::Meter meter(options.budget);
  penetration::Sweep sweep(placed_a, placed_b);
  SeparatingTranslation result;
  result.direction = penetration::unit(direction * (max_abs(direction) > 1 ? 0x1p-100 : 1));
  const penetration::SweepResult found = sweep.along(result.direction, meter);
  result.lower = found.lower, result.upper = found.upper, result.witness = found.witness;
  result.stopped_by = meter.stopped_by(), result.stats = meter.stats;
  return result;
}

SolidDistance signed_distance(const PlacedSurface& a, const PlacedSurface& b, const SolidDistanceOptions& options) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(base::is_finite_and_not_negative(options.relative_error),
                 "limber::signed_distance: relative_error must be finite and at least 0");
  const Placed placed_a = Access::placed(a), placed_b = Access::placed(b);
  pair::Meter meter(options.budget);
  SolidDistance result;
  const DistanceResult apart = distance(placed_a, placed_b, {.budget = options.budget});
  result.deepest = penetration::find_deepest(point::PlacedModel(placed_a), point::PlacedModel(placed_b), meter);
  const bool has_vertex_inside = result.deepest.of_a || result.deepest.of_b;
  if (!has_vertex_inside && apart.lower > 0 && meter.stopped_by() == StoppedBy::nothing) {
    result.lower = apart.lower, result.upper = apart.upper, result.witness = apart.witness;
    result.stopped_by = apart.stopped_by;
  } else {
    penetration::ShortestTranslation translation(placed_a, placed_b, options.relative_error, meter);
    const bool have_common_point = has_vertex_inside || apart.upper == 0;
    if (have_common_point) translation.run(result.deepest);
    result.translation = translation.translation();
    result.lower = -translation.upper();
    result.upper = have_common_point ? 0 - translation.lower() : apart.upper;
    result.stopped_by = meter.stopped_by() == StoppedBy::nothing ? apart.stopped_by : meter.stopped_by();
  }
  result.stats = meter.stats;
  result.stats += apart.stats;
  return result;
}

}  // namespace limber
