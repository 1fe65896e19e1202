// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "verbs/distance_answer.h"

namespace limber::program {

/// A file of pairs, and where the answers go.
struct PairsArguments {
  std::string pairs;      ///< see read_pairs()
  std::string out = "-";  ///< a file, or "-" for standard output
  Engine engine = Engine::fast;
  bool json = false;
};

/// Answers the same question for every pair of a file, and writes a row for each. Every model is loaded once.
///
/// Errors   BadInput naming the file, line and column. All rows are read, and all models loaded, before anything is
///          written.
ExitCode answer_pairs(const PairsArguments& arguments, const DistanceQuestion& question);

/// The columns of the answer.
std::string pairs_answer_columns();

}  // namespace limber::program
