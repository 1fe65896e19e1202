// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/contacts.h"
#include "pair/collectors/pairs.h"
#include "pair/placed_pair.h"

namespace limber::pair {

// visit_intersections() and visit_contacts() on the threads of the calling arena. The visitor is called afterwards, by
// the calling thread, with the pairs that one thread would find, in its order. In a source of their own, so that the
// compiler inlines the loop of one thread as if there were no other.
PairCount visit_intersections_in_parts(const PlacedPair& placed, const PairsOfTwo& pairs, TrianglePairVisitor visit);
PairCount visit_intersections_in_parts(const PlacedPair& placed, const PairsOfOne& pairs, TrianglePairVisitor visit);
PairCount visit_contacts_in_parts(const PlacedPair& placed, const PairsOfTwo& pairs, double margin,
                                  ContactVisitor visit);
PairCount visit_contacts_in_parts(const PlacedPair& placed, const PairsOfOne& pairs, double margin,
                                  ContactVisitor visit);

/// Whether any triangles of two models, or of one with itself, intersect, on the threads of the calling arena. Pre: no
/// body has a radius or is solid. `stats` mean something if none do: otherwise threads have ended sooner or later.
bool intersect_in_parts(const Placed& a, const Placed& b, bool is_self, QueryStats& stats);

}  // namespace limber::pair
