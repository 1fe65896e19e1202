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
is known, clash is surfaces_meet or surfaces_apart. A hard clash is below any clearance.

depth is proven for closed models that overlap: no translation shorter than that, in any direction, takes one out of the
other. A pipe through a wall is as deep as both are thick, and a sheet across a sheet as deep as a sheet: where parts
are thin, the way out may be much longer. The time for it is not in query_us.
)";

inline constexpr const char* tolerances_help = R"(
--tolerance is for parts that fit tightly: closed models whose depth is at most that are touching, not a hard clash. It
has to be small next to the walls of the parts.

--mesh-error is for meshes that stand for curved parts: the surface of each part and that of its mesh are at most that
apart. The two errors of a pair are taken from lower and from depth and added to upper, which then hold for the parts;
status, solids and the witness are of the meshes. touching is what meets or may meet, but is not deeper than
--tolerance. Where the errors leave open whether there is a hard clash, or whether --min-clearance is kept, clash is
cannot_tell, and where nothing worse is found, the exit code is 4 in place of 3.
)";

/// How two models lie to each other, besides their distance.
struct Relation {
  std::optional<SolidRelation> solids;  ///< empty unless both models are closed
  Nesting nesting = Nesting::none;

  /// Whether the volumes have a point in common.
  bool overlaps() const;
};
Relation relation_of(const PlacedModel& a, const PlacedModel& b, bool surfaces_meet);

/// What the verdict about a pair allows for.
struct Tolerances {
  double overlap = 0;     ///< closed models that are no deeper in each other only touch
  double mesh_error = 0;  ///< how far the surface of a part is from that of its mesh at most, and the other way round

  double of_pair() const { return 2 * mesh_error; }
};

/// The worst first.
enum class Clash { hard_clash, cannot_tell, surfaces_meet, touching, clearance, clear, surfaces_apart };

struct Verdict {
  Clash clash = Clash::clear;
  bool may_clash = false;         ///< whether cannot_tell may be a hard clash
  std::optional<bool> too_close;  ///< whether the models are closer than a required clearance; empty where that is open
};

/// The verdict about a pair of meshes that are `gap` apart, or overlap by the proven `depth`. `is_below` tells whether
/// the surfaces of the parts are closer than a required clearance, and is empty where the meshes do not tell.
Verdict verdict_of(const Relation& relation, double gap, double depth, const Tolerances& tolerances,
                   std::optional<bool> is_below);

/// A length that no translation which takes the bodies apart is shorter than; 0 where they do not overlap.
double proven_depth(const PlacedSurface& a, const PlacedSurface& b);
/// The proven depth of two closed models that overlap; empty for other pairs.
std::optional<double> proven_depth(const PlacedModel& a, const PlacedModel& b, const Relation& relation);

const char* to_text(Clash clash);
const char* to_text(SolidRelation relation);
/// "hard clash: B is enclosed in A"
std::string clash_line(Clash clash, const Relation& relation);

}  // namespace limber::program
