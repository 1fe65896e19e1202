// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/float_environment.h"
#include "limber/convex.h"
#include "model/check_convex.h"
#include "model/convex_parts.h"

namespace limber {

Result<ConvexSurface> ConvexSurface::create(const Model& model) {
  const base::DefaultFloatEnvironment environment;
  if (auto convex = model::check_convex(model.mesh()); !convex) return convex.error();
  return ConvexSurface(model);
}

ConvexSurface::ConvexSurface(const Model& model)
    : model_(&model), parts_(std::make_shared<const model::ConvexParts>(model)) {}

}  // namespace limber
