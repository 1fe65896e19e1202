// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bodies: what a query takes, a model with a radius, a shape, or a solid.
#include <string>

#include "base/access.h"
#include "base/check.h"
#include "limber/points.h"
#include "limber/shapes.h"
#include "model/model_impl.h"

namespace limber {

Body::Body(const Model& model, double radius) : model_(&model), radius_(radius) {
  LIMBER_REQUIRE(radius >= 0 && radius <= max_coordinate,
                 "limber::Body: the radius must be finite, at least 0 and at most max_coordinate");
}

// Solid shapes are convex.
Body::Body(const Shape& shape)
    : model_(&shape.model()),
      radius_(shape.radius()),
      is_solid_(shape.is_solid()),
      is_in_one_piece_(shape.is_solid()) {}

Body::Body(const ClosedSurface& solid)
    : model_(&Access::placed(PlacedSurface(solid)).model()),
      surface_id_(Access::impl(*model_).surface_id),
      is_solid_(true) {}

void throw_not_ready(const Placed& placed, const char* place, const char* name) {
  const auto text = [&](const char* what) { return std::string(place) + ": " + name + what; };
  LIMBER_REQUIRE(placed.model().is_committed(),
                 text(" is not committed: it has moves without a commit(), or has been moved from").c_str());
  LIMBER_REQUIRE(
      has_its_surface(placed.body()),
      text(" was reset() after it was made a solid, so ClosedSurface::create() must check it again").c_str());
  geometry::throw_not_rigid(placed.pose, std::string(place) + ": the pose of " + name);
}

}  // namespace limber
