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

/// Many models that stand somewhere, and pairs of them, as files of pairs and of parts say it.
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
  std::map<std::string, std::unique_ptr<RigidModel>> models;
};

/// The pairs of a file of pairs. Errors: BadInput naming the place.
AskedPairs pairs_of_file(const std::string& path);

/// The pairs of the parts that a table or one mesh file has: those that may be so near, or one inside the other, in
/// their order. Errors: BadInput naming the place.
AskedPairs pairs_of_parts(const std::string& path, double max_distance);

/// A name of a model as pages show it: without its folders.
std::string shown_name(const std::string& argument);

}  // namespace limber::program
