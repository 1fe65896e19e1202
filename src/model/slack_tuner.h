// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace limber {

/// Finds the slack at which repairs and what queries pay for the slack cost least together.
///
/// The costs of some commits at one slack are compared with those at twice and at half of it, and with what repairs
/// would have cost without any; the best is kept, and the others are tried ever more rarely. The least slack that is
/// tried is the longest step of a vertex in one commit: less would absorb little. Counts decide, not clocks, so the
/// same calls give the same slack on every machine.
class SlackTuner {
 public:
  /// More than `most` is never tried.
  explicit SlackTuner(double most) : most_(most) {}
  void set_most(double most);

  /// What vertices may be away from their anchors; before the first commit as much as is ever tried.
  double slack() const;

  /// What the time from one commit to the next has cost, in any one unit. The first tells of all.
  struct Costs {
    double repairs;
    std::optional<double> tight_repairs;  ///< what they would have been without slack, where that is known
    double queries;                       ///< what queries did because of the slack
    double step;                          ///< the longest way of a vertex, a length
    bool all_absorbed;                    ///< whether slack made all repairs unnecessary
  };
  void add(const Costs& costs);

 private:
  // Choice 0 is no slack; choice k is 2^(k - 1) steps.
  static constexpr int choices = 14;
  static constexpr int shortest_trial = 6, longest_trial = 128;     // commits
  static constexpr std::int64_t first_wait = 1, longest_wait = 64;  // trials of the best between others

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
  bool tight_is_old_ = true;  // what is known of no slack
  double most_;
  double step_ = 0;  // length that the choices are multiples of
  double recent_step_ = 0;
  int choice_ = 1, best_ = 0;
  std::int64_t trial_count_ = 0;
  // Of the trial that is under way.
  double cost_ = 0, repair_cost_ = 0;
  int commits_ = 0, repairs_ = 0;
  bool all_absorbed_ = true;
};

}  // namespace limber
