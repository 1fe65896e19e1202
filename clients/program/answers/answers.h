// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "answers/models.h"
#include "command/output.h"
#include "command/verb.h"
#include "limber/distance.h"
#include "limber/solids.h"

/// The parts of answers that several verbs write: in JSON, from which CSV is made, and as lines of text.
namespace limber::program {

/// A witness, and the faces and parts of the files that its triangles come from.
struct FoundWitness {
  Witness witness;
  std::uint32_t face_a = 0, face_b = 0;
  const std::string *part_a = nullptr, *part_b = nullptr;  ///< names, which the models own; null: not told
};

/// The name of a triangle's part, where models have names.
template <typename Faces>
const std::string* part_of(const Faces& model, TriangleId triangle) {
  if constexpr (requires { model.part_of(triangle); }) return model.part_of(triangle);
  return nullptr;
}

/// Adds `part_a` and `part_b`, where one of them is told.
void append_parts(Json& json, const std::string* a, const std::string* b);

/// Adds the faces and parts; `a` and `b` have `face_of(triangle)`.
template <typename Faces>
std::optional<FoundWitness> with_faces(const std::optional<Witness>& witness, const Faces& a, const Faces& b) {
  if (!witness) return std::nullopt;
  const TriangleId of_a = witness->triangle_a, of_b = witness->triangle_b;
  return FoundWitness{*witness, a.face_of(of_a), b.face_of(of_b), part_of(a, of_a), part_of(b, of_b)};
}

/// One object, or null where there is no witness.
Json to_json(const std::optional<FoundWitness>& witness);
/// Nothing where there is no witness.
void write_lines(const std::optional<FoundWitness>& witness);
/// Status, lower and upper of a distance, and the witness; upper is null where nothing was found.
void append_distance(Json& json, const DistanceResult& result, const std::optional<FoundWitness>& witness);
void write_distance_lines(const DistanceResult& result, const std::optional<FoundWitness>& witness);
/// "a_inside_b" or "b_inside_a", or null.
Json to_json(Nesting nesting);
/// Warns on standard error where one model lies inside the other.
void warn_about(Nesting nesting, const std::string& verb);

/// The last fields, and the last lines, of an answer: about one of many pairs, or about one pair.
void append_work(Json& json, const QueryStats& stats, double query_us);
void append_work(Json& json, const QueryStats& stats, double build_us, double query_us);
void write_work_lines(const QueryStats& stats, double build_us, double query_us);

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

/// What the verdict about a pair allows for.
struct Tolerances {
  double overlap = 0;     ///< closed models that are no deeper in each other only touch
  double mesh_error = 0;  ///< how far the surface of a part is from that of its mesh at most, and the other way round

  double of_pair() const { return 2 * mesh_error; }
};

/// The worst first.
enum class Clash { hard_clash, cannot_tell, surfaces_meet, touching, clearance, clear, surfaces_apart };

/// A length that no translation which takes the bodies apart is shorter than; 0 where they do not overlap.
double proven_depth(const PlacedSurface& a, const PlacedSurface& b);

const char* to_text(Clash clash);
const char* to_text(SolidRelation relation);
/// "hard clash: B is enclosed in A"
std::string clash_line(Clash clash, const Relation& relation);

struct DistanceQuestion {
  DistanceOptions options;
  std::optional<double> min_clearance;  ///< at most `options.max_distance`
  Tolerances tolerances;
  bool exit_code = false;
};

struct DistanceAnswer {
  DistanceResult result;  ///< of the parts: wider than that of the meshes by the tolerances' mesh error of the pair
  std::optional<FoundWitness> witness;
  std::optional<bool> too_close;    ///< whether the models are closer than `min_clearance`; empty without one
  Relation relation;                ///< of the meshes; on a path: at the start, and only the nesting
  std::optional<Clash> clash;       ///< empty on a path
  bool may_clash = false;           ///< whether there is, or may be, a hard clash
  std::optional<double> depth;      ///< that is proven of the parts, where closed meshes overlap
  std::optional<double> path_time;  ///< on a path: when the models are so near
  double elapsed_us = 0;
};

/// The answer of `ask`, which takes the options of a distance and gives it. Where a clearance, more or less `error`,
/// lies in the interval that the errors allow, it is asked once more without them, so that whether the models are
/// closer is as true as an exact distance says.
template <typename Ask>
DistanceResult decided_distance(const DistanceOptions& options, const std::optional<double>& clearance, Ask ask,
                                double error = 0) {
  const DistanceResult result = ask(options);
  const auto decides = [&](double limit) { return result.upper < limit || result.lower >= limit; };
  const bool is_decided = !clearance || (decides(*clearance - error) && decides(*clearance + error));
  return is_decided ? result : ask({.max_distance = options.max_distance});
}

/// Asks, as decided_distance() does.
DistanceAnswer answer_to(const DistanceQuestion& question, const PlacedModel& a, const PlacedModel& b);

/// What one answer is to the exit code: pairs that are too close, or, without `min_clearance`, those not beyond
/// `max_distance`, are found; so are hard clashes. Where meshes do not tell, it is undecided.
ExitCode exit_code_of(const DistanceQuestion& question, const DistanceAnswer& answer);
/// The exit code of a run with two pairs, from the exit codes of both.
ExitCode worse_of(ExitCode a, ExitCode b);

/// Status, lower, upper, witness, too_close, inside, clash, solids and depth.
void append_answer(Json& json, const DistanceAnswer& answer);

}  // namespace limber::program
