// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "command/output.h"
#include "verbs/answers.h"
#include "verbs/models.h"

/// The page of `limber distance --pairs --report` and `limber distance --parts --report`.
namespace limber::program {

/// A model where it stands. The model must outlive it.
struct StudyPart {
  std::string name;  ///< as the page shows it
  std::string file;  ///< as on the command line
  const RigidModel* model = nullptr;
  Transform pose;  ///< world_from_model

  PlacedModel placed() const { return {*model, pose}; }
};

/// Two of the parts, by their numbers.
using PartPair = std::array<std::size_t, 2>;

/// Whose pairs a study is about.
enum class StudyKind {
  pairs,  ///< those of a list, such as one pair of models in many poses
  parts,  ///< all pairs of parts that stand together
};

/// Gathers the answers to many pairs. The page has each model once, and of each answer all digits.
class Study {
 public:
  static constexpr std::size_t most_rows = 20'000;  ///< that a page has room for

  /// Errors   BadInput unless there are at most `most_rows` pairs.
  Study(StudyKind kind, const DistanceQuestion& question, std::vector<StudyPart> parts, std::size_t pair_count);

  /// Adds the answer to a pair. Of surfaces that meet it also finds which triangles do, unless these are too many for
  /// the page.
  void add(const PartPair& pair, const DistanceAnswer& answer);

  /// The data of the page.
  Json to_json() const;

 private:
  Json intersecting_triangles(const PartPair& pair);

  StudyKind kind_;
  DistanceQuestion question_;
  std::vector<StudyPart> parts_;
  Json rows_;
  std::size_t triangle_bytes_ = 0;  // of the triangles that intersect
};

}  // namespace limber::program
