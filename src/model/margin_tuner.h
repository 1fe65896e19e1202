// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace limber::model {

/// Finds the motion margin at which refits and what queries lose by the margin cost least together.
///
/// Hill climbing over the margins unit * 2^k, with exponential back-off: the cost of some commits at one margin is
/// compared with the cost at twice and at half of it, and with what refits would have cost without a margin. Margins
/// that lose are tried ever more rarely. The unit, which is the smallest margin, is the running mean of the longest
/// displacement of a vertex in one batch when the search last started over: less would absorb little. Counts decide,
/// not clocks, so the same calls give the same margin on every machine.
///
/// States   Each choice of a margin is untried, known, or due to be tried again. One choice is being tried; one, the
///          best, is returned to after each trial of another. A sudden change of the motion makes all choices untried.
/// Source   The experiment that fixed the constants is bench/develop/motion_margin.cpp; docs/design/deforming.md.
class MarginTuner {
 public:
  /// No margin above `largest` is ever tried.
  explicit MarginTuner(double largest) : largest_(largest) {}
  void set_largest(double largest);

  /// The margin to be used until the next commit; before the first commit the largest.
  double margin() const;

  /// What one commit and the queries since the one before it have cost, in any one unit of time.
  struct Costs {
    double refits;
    std::optional<double> refits_without_margin;  ///< what they would have cost without a margin, where that is known
    double queries;                               ///< of queries, because of the margin
    double displacement;                          ///< the longest of a vertex, a length
    bool all_absorbed;                            ///< whether the margin made all refits unnecessary
  };
  void add(const Costs& costs);

 private:
  // Choice 0 is no margin; choice k is 2^(k - 1) displacements.
  static constexpr int choices = 14;
  static constexpr int shortest_trial = 6, longest_trial = 128;     // commits
  static constexpr std::int64_t first_wait = 1, longest_wait = 64;  // trials of any choice, until the next try

  struct Trial {
    double cost = -1;                         // a commit; negative when not known
    std::int64_t wait = first_wait, due = 0;  // number of the trial at which it may be tried again
  };

  Trial& trial(int choice) { return trials_[static_cast<std::size_t>(choice)]; }
  bool is_due(int choice);
  bool is_over();
  void finish_trial();
  int next_choice();
  void start_over();

  std::array<Trial, choices> trials_{};
  bool is_unmargined_cost_old_ = true;  // that is the cost of choice 0
  double largest_;
  double unit_ = 0;  // the displacement that the choices are multiples of
  double recent_displacement_ = 0;
  int choice_ = 1, best_ = 0;
  std::int64_t trial_count_ = 0;
  // Of the trial that is under way.
  double cost_ = 0, refit_cost_ = 0;
  int commits_ = 0, refits_ = 0;
  bool all_absorbed_ = true;
};

}  // namespace limber::model
