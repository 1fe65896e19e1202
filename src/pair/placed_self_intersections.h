// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/contacts.h"

namespace limber::pair {

/// visit_self_intersections() for a model under a pose, whose vertices rounding may have moved a little: all pairs of
/// its placed triangles that meet elsewhere than in what they share by their vertex ids. Returns which limit of the
/// budget has left some out.
StoppedBy visit_placed_self_intersections(const Placed& model, TrianglePairVisitor visit, const QueryBudget& budget,
                                          QueryStats& stats);

}  // namespace limber::pair
