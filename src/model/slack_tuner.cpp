// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/slack_tuner.h"

#include <algorithm>
#include <cmath>

namespace limber {

double SlackTuner::slack_of(int choice) const { return choice == 0 ? 0 : std::ldexp(step_, choice - 1); }

void SlackTuner::start_over() {
  trials_ = {};
  step_ = recent_step_;
  choice_ = best_ = 0;
  trial_ = 0;
  cost_ = 0;
  commits_ = repairs_ = 0;
  all_absorbed_ = true;
}

void SlackTuner::add(double repairs, double queries, double step, bool all_absorbed) {
  if (step > 0) recent_step_ = recent_step_ == 0 ? step : 0.75 * recent_step_ + 0.25 * step;
  // The motion has become another one.
  if (recent_step_ > 8 * step_ || 64 * recent_step_ < step_) return start_over();
  cost_ += repairs + queries;
  ++commits_;
  repairs_ += repairs > 0 ? 1 : 0;
  all_absorbed_ = all_absorbed_ && all_absorbed;
  const double best = trials_[static_cast<std::size_t>(best_)].cost;
  const bool is_hopeless = choice_ != best_ && best >= 0 && cost_ > 2 * best * shortest_trial;
  // Costs come in waves from one repair to the next; a trial needs whole ones.
  const bool is_whole = commits_ >= shortest_trial && (repairs_ >= 3 || all_absorbed_);
  if (is_hopeless || is_whole || commits_ >= longest_trial) finish_trial(cost_ / commits_, all_absorbed_);
}

void SlackTuner::finish_trial(double cost, bool all_absorbed) {
  Trial& tried = trials_[static_cast<std::size_t>(choice_)];
  Trial& best = trials_[static_cast<std::size_t>(best_)];
  // What has changed by itself makes all that is known of the others old.
  if (choice_ == best_ && best.cost >= 0 && (cost > 2 * best.cost || 2 * cost < best.cost)) {
    for (Trial& trial : trials_) trial = {};
  }
  tried.cost = choice_ == best_ && tried.cost >= 0 ? 0.5 * (tried.cost + cost) : cost;
  ++trial_;
  if (choice_ != best_) {
    if (cost < best.cost) {
      best_ = choice_;
      for (Trial& trial : trials_) trial.wait = first_wait, trial.due = trial_;
    } else {
      tried.wait = std::min(2 * tried.wait, longest_wait);
      tried.due = trial_ + tried.wait;
    }
  }
  choice_ = next_choice(all_absorbed);
  cost_ = 0;
  commits_ = repairs_ = 0;
  all_absorbed_ = true;
}

int SlackTuner::next_choice(bool all_absorbed) {
  if (choice_ != best_) return best_;
  // More slack gains nothing where all is absorbed.
  const int up = best_ + 1, down = best_ - 1;
  if (!all_absorbed && up < choices && trials_[static_cast<std::size_t>(up)].due <= trial_) return up;
  if (down >= 0 && trials_[static_cast<std::size_t>(down)].due <= trial_) return down;
  // A plateau hides what lies behind it: one slack that absorbs nothing costs as much as another.
  const int beyond = best_ + 2;
  if (!all_absorbed && beyond < choices && trials_[static_cast<std::size_t>(beyond)].due <= trial_) return beyond;
  return best_;
}

}  // namespace limber
