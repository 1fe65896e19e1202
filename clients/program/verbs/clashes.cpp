// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/clashes.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "limber/penetration.h"

namespace limber::program {

bool Relation::overlaps() const {
  if (!solids) return nesting != Nesting::none;
  return *solids != SolidRelation::apart && *solids != SolidRelation::touching;
}

Relation relation_of(const PlacedModel& a, const PlacedModel& b, bool surfaces_meet) {
  Relation relation;
  if (const auto solids = solids_of(a, b)) {
    relation.solids = solids->relation;
    relation.nesting = nesting_of(*solids);
  } else if (!surfaces_meet) {
    relation.nesting = nesting_of(a, b);
  }
  return relation;
}

Verdict verdict_of(const Relation& relation, double gap, double depth, const Tolerances& tolerances,
                   std::optional<bool> is_below) {
  constexpr double any = std::numeric_limits<double>::infinity();
  const double error = tolerances.of_pair();
  double least = 0, most = error - gap;  // how deep the parts are in each other
  if (relation.solids && relation.overlaps()) {
    least = error == 0 && tolerances.overlap == 0 ? any : depth - error;
    most = depth + error;
  } else if (!relation.solids) {  // of one that is not closed, only whether it is enclosed is known
    least = relation.overlaps() && gap > error ? any : 0;
    most = relation.overlaps() || (error > 0 && gap <= error) ? any : 0;
  }
  if (least > tolerances.overlap) return {Clash::hard_clash, true, true};
  if (most > tolerances.overlap) return {Clash::cannot_tell, true, is_below == true ? is_below : std::nullopt};
  if (!is_below) return {Clash::cannot_tell, false, std::nullopt};
  const bool is_apart = gap > error && !relation.overlaps();
  if (!is_apart) return {relation.solids ? Clash::touching : Clash::surfaces_meet, false, is_below};
  const Clash clear = relation.solids ? Clash::clear : Clash::surfaces_apart;
  return {*is_below ? Clash::clearance : clear, false, is_below};
}

double proven_depth(const PlacedSurface& a, const PlacedSurface& b) {
  // With this error the search ends with the first way out, however long.
  return std::max(0.0, -signed_distance(a, b, {.relative_error = std::numeric_limits<double>::max()}).upper);
}

std::optional<double> proven_depth(const PlacedModel& a, const PlacedModel& b, const Relation& relation) {
  if (!relation.solids || !relation.overlaps()) return std::nullopt;
  return proven_depth({a.model.surface().value(), a.pose}, {b.model.surface().value(), b.pose});
}

const char* to_text(Clash clash) {
  static constexpr const char* words[] = {"hard_clash", "cannot_tell", "surfaces_meet", "touching",
                                          "clearance",  "clear",       "surfaces_apart"};
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
