// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "command/output.h"
#include "limber/distance.h"
#include "verbs/models.h"

/// The parts of answers that several verbs write: in JSON, as lines of text, and as cells of CSV.
namespace limber::program {

/// A witness, and the faces of the files that its triangles come from.
struct FoundWitness {
  Witness witness;
  std::uint32_t face_a = 0, face_b = 0;
};

/// Adds the faces; `a` and `b` have `face_of(triangle)`.
template <typename Faces>
std::optional<FoundWitness> with_faces(const std::optional<Witness>& witness, const Faces& a, const Faces& b) {
  if (!witness) return std::nullopt;
  return FoundWitness{*witness, a.face_of(witness->triangle_a), b.face_of(witness->triangle_b)};
}

/// One object, or null where there is no witness.
Json to_json(const std::optional<FoundWitness>& witness);
/// Nothing where there is no witness.
void write_lines(const std::optional<FoundWitness>& witness);
/// The cells under `witness_columns`, empty where there is no witness.
std::string csv_cells(const std::optional<FoundWitness>& witness);
inline constexpr const char* witness_columns =
    "point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,triangle_a,triangle_b,face_a,face_b";

/// Status, lower and upper of a distance, and the witness; upper is null, or an empty cell, where nothing was found.
void append_distance(Json& json, const DistanceResult& result, const std::optional<FoundWitness>& witness);
void write_distance_lines(const DistanceResult& result, const std::optional<FoundWitness>& witness);
/// The cells under `distance_columns` and then `witness_columns`.
std::string csv_cells(const DistanceResult& result, const std::optional<FoundWitness>& witness);
inline constexpr const char* distance_columns = "status,lower,upper";

/// "a_in_b" or "b_in_a", or null.
Json to_json(Nesting nesting);
/// Warns on standard error where one model lies inside the other.
void warn_about(Nesting nesting, const std::string& verb);

/// The last fields, and the last lines, of an answer: about one of many pairs, or about one pair.
void append_work(Json& json, const QueryStats& stats, double query_us);
void append_work(Json& json, const QueryStats& stats, double build_us, double query_us);
void write_work_lines(const QueryStats& stats, double build_us, double query_us);

}  // namespace limber::program
