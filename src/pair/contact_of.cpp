// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/check.h"
#include "base/float_environment.h"
#include "geometry/primitives.h"
#include "limber/gradients.h"
#include "pair/placed_pair.h"
#include "pair/radii.h"

namespace limber {

TriangleContact contact_of(const Placed& a, const Placed& b, const Witness& witness) {
  using pair::Side;
  const base::DefaultFloatEnvironment environment;
  const pair::PlacedPair placed(a, b);
  LIMBER_REQUIRE(placed.has_triangle(Side::a, witness.triangle_a), "limber::contact_of: a has no such triangle");
  LIMBER_REQUIRE(placed.has_triangle(Side::b, witness.triangle_b), "limber::contact_of: b has no such triangle");
  const TriangleContact contact = geometry::contact(placed.triangle(Side::a, witness.triangle_a),
                                                    placed.triangle(Side::b, witness.triangle_b), OrientedFaces::none);
  return environment.computed_before_restore(pair::Radii(a, b).contact(contact));
}

}  // namespace limber
