// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "answers/models.h"

/// Models that stand somewhere, and the pairs of them that `limber distance` is asked about: pairs_of_file() has those
/// of a table of pairs, pairs_of_parts() those of the parts in a table or in one mesh file.
namespace limber::program {

/// A model where it stands. The model must outlive it.
struct StudyPart {
  std::string name;  ///< as pages show it
  std::string file;  ///< as on the command line
  const RigidModel* model = nullptr;
  Transform pose;  ///< world_from_model

  PlacedModel placed() const { return {*model, pose}; }
};

/// Two of the parts, by their numbers.
using PartPair = std::array<std::size_t, 2>;

/// Whose pairs are asked about.
enum class StudyKind {
  pair,   ///< one pair alone
  pairs,  ///< those of a list, such as one pair of models in many poses
  parts,  ///< all pairs of parts that stand together
};

/// The pairs of a file, and their models: each file is loaded once, in however many ways it is named.
struct AskedPairs {
  StudyKind kind = StudyKind::pairs;
  std::vector<StudyPart> parts;
  std::vector<PartPair> pairs;
  std::map<std::string, std::unique_ptr<RigidModel>> models;  ///< by what tells one file, or part of it, from others
};

/// The pairs of a file of pairs. Errors: BadInput naming the place.
AskedPairs pairs_of_file(const std::string& path);

/// The pairs of the parts that a table or one mesh file has, in the order of their numbers: those whose bounds are at
/// most `max_distance` apart, among them all of which one is inside the other. Errors: BadInput naming the place.
AskedPairs pairs_of_parts(const std::string& path, double max_distance);

/// A name of a model as pages show it: without its folders.
std::string shown_name(const std::string& argument);

}  // namespace limber::program
