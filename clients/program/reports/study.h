// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "answers/answers.h"
#include "answers/models.h"
#include "answers/parts.h"
#include "command/output.h"

/// The page of `limber distance --report`, `--pairs --report` and `--parts --report`.
namespace limber::program {

/// Gathers the answers to many pairs. The page has each model once, and of each answer all digits. It has room for the
/// worst `most_rows` answers, and says how many there were of each kind.
class Study {
 public:
  static constexpr std::size_t most_rows = 20'000;

  Study(StudyKind kind, const DistanceQuestion& question, std::vector<StudyPart> parts);

  /// Adds the answer to a pair, and its number in the table. Of surfaces that meet it also finds which triangles do,
  /// unless these are too many for the page. `accepted` is the line that accepts it.
  void add(std::size_t number, const PartPair& pair, const DistanceAnswer& answer,
           const std::optional<std::size_t>& accepted);

  /// The data of the page.
  Json to_json();

 private:
  /// What is smaller is worse: the kind; minus how deep a clash is; both bounds; the number in the table.
  using Badness = std::array<double, 5>;
  using Row = std::pair<Badness, Json>;

  void keep_worst();
  Json intersecting_triangles(const PartPair& pair);

  StudyKind kind_;
  DistanceQuestion question_;
  std::vector<StudyPart> parts_;
  std::vector<Row> rows_;
  Json counts_ = Json::object();              // of each kind that is not accepted
  std::size_t accepted_ = 0, too_close_ = 0;  // the latter without accepted ones
  std::size_t triangle_bytes_ = 0;            // of the triangles that intersect
};

/// All that the page about one pair shows: the answer, both meshes, and the triangles that intersect.
Json distance_report(const PlacedArguments& arguments, const Pair& pair, const DistanceQuestion& question,
                     const DistanceAnswer& answer);

}  // namespace limber::program
