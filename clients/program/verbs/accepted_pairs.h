// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "verbs/answers.h"

/// `--accept`: pairs of parts that may touch, or even overlap.
namespace limber::program {

/// The help about the file.
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

class AcceptedPairs {
 public:
  /// Accepts nothing if the path is empty. Errors: BadInput of read_csv(), and where a word is neither.
  explicit AcceptedPairs(std::string path);

  /// The first line that accepts the answer to a pair of names, counted from 1.
  std::optional<std::size_t> accept(const std::string& name_a, const std::string& name_b, const DistanceAnswer& answer);

  /// Warns of each line that has accepted nothing.
  void warn_about_unused() const;

 private:
  struct Rule {
    std::string a, b;  ///< patterns
    bool allows_all = false, is_used = false;
    std::size_t line = 0;
  };

  std::string path_;
  std::vector<Rule> rules_;
};

}  // namespace limber::program
