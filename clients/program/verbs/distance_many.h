// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "command/verb.h"
#include "reports/page_template.h"
#include "verbs/answers.h"
#include "verbs/models.h"

/// `limber distance --pairs` and `limber distance --parts`: the same question about many pairs.
namespace limber::program {

struct ManyPairsArguments {
  std::string pairs, parts;  ///< files of pairs and of parts; one of them is given
  std::string accept;        ///< a file of AcceptedPairs, or empty
  std::string out = "-";
  bool json = false;
  Engine engine = Engine::fast;
  ReportArguments report;
};

/// Answers for every pair of a file of pairs, or for all pairs of the parts of a file that are not beyond the largest
/// distance, and writes a row for each. All rows are read, and each model is loaded once, before anything is written.
ExitCode answer_pairs(const ManyPairsArguments& arguments, const DistanceQuestion& question);

/// The columns of the answer to a file of pairs.
std::string pairs_answer_columns();

}  // namespace limber::program
