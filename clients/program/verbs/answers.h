// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "command/output.h"
#include "command/verb.h"
#include "limber/distance.h"
#include "verbs/clashes.h"
#include "verbs/models.h"

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
/// What csv_line() makes of it.
inline constexpr const char* witness_columns =
    "point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,triangle_a,triangle_b,face_a,face_b";

/// Status, lower and upper of a distance, and the witness; upper is null where nothing was found.
void append_distance(Json& json, const DistanceResult& result, const std::optional<FoundWitness>& witness);
void write_distance_lines(const DistanceResult& result, const std::optional<FoundWitness>& witness);
/// What csv_line() makes of them before the witness.
inline constexpr const char* distance_columns = "status,lower,upper";

/// "a_inside_b" or "b_inside_a", or null.
Json to_json(Nesting nesting);
/// Warns on standard error where one model lies inside the other.
void warn_about(Nesting nesting, const std::string& verb);

/// The last fields, and the last lines, of an answer: about one of many pairs, or about one pair.
void append_work(Json& json, const QueryStats& stats, double query_us);
void append_work(Json& json, const QueryStats& stats, double build_us, double query_us);
void write_work_lines(const QueryStats& stats, double build_us, double query_us);

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
