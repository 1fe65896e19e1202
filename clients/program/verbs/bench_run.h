// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "limber/model.h"

/// Measures how long queries and updates of two models take, at random poses.
namespace limber::program {

struct BenchOptions {
  std::uint64_t seed = 1, poses = 40;
  double seconds = 10;  ///< nothing begins after that, but one pose is drawn, and measured once, in any case
};

/// Times of one question in one situation, in microseconds with three digits: of poses that have the median of rounds.
struct BenchRow {
  std::string question, situation;
  std::size_t poses = 0;
  double least_us = 0, median_us = 0;
};

struct BenchTable {
  double size = 0;  ///< the larger diagonal of the two boxes; gaps are fractions of it
  std::vector<BenchRow> rows;
};

/// Draws poses, compares answers, and measures. `b` may be `a`.
///
/// Errors   BadInput for models without extent.
/// Throws   std::runtime_error naming the pose at which answers disagree.
BenchTable run_bench(const Model& a, const Model& b, const BenchOptions& options);

/// The answers about one pose. Several of them are found in two ways, which must agree.
struct BenchAnswers {
  double distance = 0, rough_lower = 0, rough_upper = 0;  ///< rough: with a relative error of 0.01
  bool collides = false, is_within = false;
  std::size_t contacts = 0;             ///< within the same limit
  double witness_distance = 0;          ///< of the witness on b from the closest point of a
  double refitted = 0, built_anew = 0;  ///< distances after all vertices of a have moved
};

/// Which answers contradict each other; empty if none do.
inline std::string disagreement(const BenchAnswers& answers, double limit, double tolerance) {
  const double d = answers.distance, low = answers.rough_lower, high = answers.rough_upper;
  const auto differ = [=](double x, double y) { return !(std::abs(x - y) <= tolerance); };
  const bool is_near = d <= limit, may_be_either = !differ(d, limit);
  std::string text;
  if (answers.collides != (d == 0)) text += fmt::format(", collide {}", answers.collides);
  if (low > d + tolerance || high < d - tolerance || high > 1.01 * d + tolerance) {
    text += fmt::format(", within 1 % {} to {}", low, high);
  }
  if (answers.is_within != is_near && !may_be_either) text += fmt::format(", within {} {}", limit, answers.is_within);
  if ((answers.contacts > 0) != is_near && !may_be_either) {
    text += fmt::format(", contacts within {} {}", limit, answers.contacts);
  }
  if (differ(answers.witness_distance, d)) text += fmt::format(", closest point {}", answers.witness_distance);
  if (differ(answers.refitted, answers.built_anew)) {
    text += fmt::format(", of a refitted tree {}, of a new one {}", answers.refitted, answers.built_anew);
  }
  return text.empty() ? text : fmt::format("distance {}", d) + text;
}

}  // namespace limber::program
