// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "limber/solids.h"
#include "verbs/models.h"

/// What kind of clash a pair of models is, in the words of those who check building models.
namespace limber::program {

/// The help about the words.
inline constexpr const char* clash_help = R"(
clash is hard_clash (the volumes overlap, or one model is enclosed in the other), touching (the surfaces meet, but the
volumes do not overlap), clearance (apart, but closer than --min-clearance) or clear. It is decided exactly where both
models are closed: every edge belongs to two triangles, which run through it in opposite directions. Then solids is how
the volumes lie: apart, touching, overlapping, a_inside_b, b_inside_a or equal. Where a model is not closed and no more
is known, clash is surfaces_meet or surfaces_apart. A hard clash is below any clearance. For a hard clash of closed
models, max_depth is how far the deepest vertex of one model, inside of the other, is from the other's surface; 0 where
no vertex is inside. Its time is not in query_us.
)";

/// How two models lie to each other, besides their distance.
struct Relation {
  std::optional<SolidRelation> solids;  ///< empty unless both models are closed
  Nesting nesting = Nesting::none;
  bool surfaces_meet = false;

  bool is_hard_clash() const;
};
Relation relation_of(const PlacedModel& a, const PlacedModel& b, bool surfaces_meet);

enum class Clash { hard_clash, touching, clearance, clear, surfaces_meet, surfaces_apart };

/// What kind of clash it is, if `too_close` says whether the models are closer than a clearance that is required.
Clash clash_of(const Relation& relation, bool too_close);

/// How deep the deepest vertex of either model is in the other; nothing unless both are closed.
std::optional<double> max_depth_of(const PlacedModel& a, const PlacedModel& b);

const char* to_text(Clash clash);
const char* to_text(SolidRelation relation);
/// "hard clash: B is enclosed in A"
std::string clash_line(Clash clash, const Relation& relation);

}  // namespace limber::program
