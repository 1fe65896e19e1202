// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/clashes.h"

#include <algorithm>
#include <cstddef>

#include "limber/penetration.h"

namespace limber::program {

bool Relation::is_hard_clash() const {
  if (!solids) return nesting != Nesting::none;
  return *solids != SolidRelation::apart && *solids != SolidRelation::touching;
}

Relation relation_of(const PlacedModel& a, const PlacedModel& b, bool surfaces_meet) {
  Relation relation{std::nullopt, Nesting::none, surfaces_meet};
  if (const auto solids = solids_of(a, b)) {
    relation.solids = solids->relation;
    relation.nesting = nesting_of(*solids);
  } else if (!surfaces_meet) {
    relation.nesting = nesting_of(a, b);
  }
  return relation;
}

Clash clash_of(const Relation& relation, bool too_close) {
  if (relation.is_hard_clash()) return Clash::hard_clash;
  if (relation.surfaces_meet) return relation.solids ? Clash::touching : Clash::surfaces_meet;
  if (too_close) return Clash::clearance;
  return relation.solids ? Clash::clear : Clash::surfaces_apart;
}

std::optional<double> max_depth_of(const PlacedModel& a, const PlacedModel& b) {
  const Result<ClosedSurface>&surface_a = a.model.surface(), &surface_b = b.model.surface();
  if (!surface_a || !surface_b) return std::nullopt;
  return deepest_vertices({surface_a.value(), a.pose}, {surface_b.value(), b.pose}).max_depth;
}

const char* to_text(Clash clash) {
  static constexpr const char* words[] = {"hard_clash", "touching",      "clearance",
                                          "clear",      "surfaces_meet", "surfaces_apart"};
  return words[static_cast<std::size_t>(clash)];
}

const char* to_text(SolidRelation relation) {
  static constexpr const char* words[] = {"apart",      "touching", "overlapping", "a_inside_b",
                                          "b_inside_a", "equal",    "undecided"};
  return words[static_cast<std::size_t>(relation)];
}

std::string clash_line(Clash clash, const Relation& relation) {
  std::string line = to_text(clash);
  std::replace(line.begin(), line.end(), '_', ' ');
  if (relation.solids == SolidRelation::equal) return line + ": both volumes are equal";
  if (relation.solids == SolidRelation::a_inside_b || relation.nesting == Nesting::a_inside_b) {
    return line + ": A is enclosed in B";
  }
  if (relation.solids == SolidRelation::b_inside_a || relation.nesting == Nesting::b_inside_a) {
    return line + ": B is enclosed in A";
  }
  return line;
}

}  // namespace limber::program
