// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "answers/answers.h"
#include "answers/models.h"
#include "command/verb.h"
#include "reports/page_template.h"

/// `limber distance --pairs` and `limber distance --parts`: the same question about many pairs.
namespace limber::program {

/// The help about a file for `--accept`.
inline constexpr const char* accept_help = R"(
A file for --accept has the columns name_a and name_b, where you want it allowed, and no others. Names are patterns of
the names in the answer, in either order: * stands for any characters, ? for one. What is allowed is touching, which is
meant where nothing is said, or all: hard clashes too. The column accepted of the answer tells the first line that
accepts a pair, which otherwise would be touching or worse. Accepted pairs keep their clash, but do not change the exit
code. Lines that accept nothing are warned of.

  name_a,name_b,allowed
  bolt_*,plate_*,touching
  bolt_*,nut_*,all
)";

struct ManyPairsArguments {
  std::string pairs, parts;  ///< files of pairs and of parts; one of them is given
  std::string accept;        ///< a file of AcceptedPairs, or empty
  std::string out = "-";
  bool json = false;
  ReportArguments report;
};

/// Answers for every pair of a file of pairs, or for all pairs of the parts of a file that are not beyond the largest
/// distance, and writes a row for each. All rows are read, and each model is loaded once, before anything is written.
ExitCode answer_pairs(const ManyPairsArguments& arguments, const DistanceQuestion& question);

/// The columns of the answer to a file of pairs, as help names them.
std::string pairs_answer_columns();

}  // namespace limber::program
