// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "base/check.h"
#include "base/float_environment.h"
#include "limber/convex.h"
#include "model/check_convex.h"
#include "model/convex_parts.h"

namespace limber {

Result<ConvexSurface> ConvexSurface::create(const Model& model, std::optional<double> max_concavity) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(!max_concavity || (*max_concavity >= 0 && *max_concavity <= std::numeric_limits<double>::max()),
                 "limber::ConvexSurface::create: max_concavity must be finite and at least 0");
  constexpr double rounded = 0x1p-40;  // as a part of the largest coordinate
  double size = 0;
  for (const Vec3& p : model.mesh().positions()) size = std::max(size, max_abs(p));
  const auto is_solid = model::check_convex(model.mesh(), max_concavity.value_or(rounded * size));
  if (!is_solid) return is_solid.error();
  return ConvexSurface(model, is_solid.value());
}

ConvexSurface::ConvexSurface(const Model& model, bool is_solid)
    : model_(&model), parts_(std::make_shared<const model::ConvexParts>(model)), is_solid_(is_solid) {}

}  // namespace limber
