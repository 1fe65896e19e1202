// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace limber {

/// Finds the slack at which repairs and what queries pay for the slack cost least together.
///
/// The costs of a few commits at one slack are compared with those at twice and at half of it, and the best is kept;
/// ever more rarely the others are tried again. The smallest slack but none is the largest step of a vertex in one
/// commit: below that, slack absorbs nothing. Counts decide, not clocks, so the same calls give the same slack on every
/// machine.
class SlackTuner {
 public:
  /// What vertices may be away from their anchors.
  double slack() const { return slack_of(choice_); }

  /// Tells what the time from one commit to the next has cost, in any one unit: for repairs, and for what queries did
  /// because of the slack. `step` is the longest way of a vertex, `all_absorbed` whether there was nothing to repair.
  void add(double repairs, double queries, double step, bool all_absorbed);

 private:
  // Choice 0 is no slack; choice k is 2^(k - 1) steps.
  static constexpr int choices = 14;
  static constexpr int shortest_trial = 6, longest_trial = 48;      // commits
  static constexpr std::int64_t first_wait = 1, longest_wait = 16;  // trials of the best between others

  struct Trial {
    double cost = -1;                         // a commit; negative when not known
    std::int64_t wait = first_wait, due = 0;  // number of the trial at which it may be tried again
  };

  double slack_of(int choice) const;
  void finish_trial(double cost, bool all_absorbed);
  int next_choice(bool all_absorbed);
  void start_over();

  std::array<Trial, choices> trials_{};
  double step_ = 0;  // length that the choices are multiples of
  double recent_step_ = 0;
  int choice_ = 0, best_ = 0;
  std::int64_t trial_ = 0;
  double cost_ = 0;
  int commits_ = 0, repairs_ = 0;
  bool all_absorbed_ = true;
};

}  // namespace limber
