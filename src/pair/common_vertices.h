// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bvh/tree.h"
#include "pair/placed_pair.h"

namespace limber::pair {

/// A query needs one of these to be certain of the triangles below two slots of one model.
enum class Apart {
  triangles,  ///< two triangles have nothing in common but the vertices, and the edge, that all of them share
  elements    ///< also, a vertex and a face, or two edges, that share no vertex are farther apart than a margin
};

/// Whether all triangles below two slots of one model share a vertex or an edge, as in a fan or a book, and those of
/// one slot are certainly apart from those of the other. Bounding volumes cannot tell, since all of them contain what
/// is shared.
///
/// Promise  True only if it is so, whatever rounding does.
/// Pre      Both models of `placed` are one, and placed alike.
/// Cost     O(1) if they share nothing, else O(triangles below both).
bool share_and_are_apart(const PlacedPair& placed, bvh::SlotId a, bvh::SlotId b, Apart what, double margin);

}  // namespace limber::pair
