// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>

#include "limber/contacts.h"
#include "limber/solids.h"
#include "solid/cut.h"
#include "solid/shells.h"

namespace limber::testing {

/// The relation of two placed closed surfaces by shells alone: without a look at the first contacts or at components,
/// which would often find all kinds of cells before.
inline SolidRelation relation_by_shells(const Placed& a, const Placed& b) {
  std::deque<TrianglePair> contacts;
  visit_intersections(a, b, [&](const TrianglePair& pair) { return contacts.push_back(pair), true; });
  solid::Cells cells(a, b);
  solid::Shells(cells, contacts).look();
  if (!cells.has(solid::in_both)) return contacts.empty() ? SolidRelation::apart : SolidRelation::touching;
  const bool is_a_out = cells.has(solid::in_a_alone), is_b_out = cells.has(solid::in_b_alone);
  if (is_a_out) return is_b_out ? SolidRelation::overlapping : SolidRelation::b_inside_a;
  return is_b_out ? SolidRelation::a_inside_b : SolidRelation::equal;
}

}  // namespace limber::testing
