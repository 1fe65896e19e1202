// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/slack_tuner.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace limber {
namespace {

double mixed(double old, double now, double share) { return old + share * (now - old); }

}  // namespace

double SlackTuner::slack() const {
  if (step_ == 0) return most_;
  return choice_ == 0 ? 0 : std::ldexp(step_, choice_ - 1);
}

bool SlackTuner::is_due(int choice) {
  return choice >= 1 && choice < choices && trial(choice).due <= trial_count_ && std::ldexp(step_, choice - 1) <= most_;
}

void SlackTuner::start_over() {
  const double tight = trial(0).cost;
  trials_ = {};
  trial(0).cost = tight;  // until it is known anew
  tight_is_old_ = true;
  step_ = recent_step_;
  trial_count_ = 0;
  choice_ = is_due(1) ? 1 : 0, best_ = 0;
  cost_ = repair_cost_ = 0;
  commits_ = repairs_ = 0;
  all_absorbed_ = true;
}

void SlackTuner::set_most(double most) {
  LIMBER_ASSERT(most >= 0);
  most_ = most;
  if (step_ > 0 && slack() > most_) start_over();
}

void SlackTuner::add(const Costs& costs) {
  LIMBER_ASSERT(costs.step >= 0 && costs.repairs >= 0 && costs.tight_repairs.value_or(0) >= 0 && costs.queries >= 0);
  if (costs.step > 0) recent_step_ = recent_step_ == 0 ? costs.step : mixed(recent_step_, costs.step, 0.25);
  // The first step, another kind of motion, or motion that has become slow enough.
  const bool is_slow_enough = step_ > most_ && recent_step_ <= most_;
  if (recent_step_ > 8 * step_ || 64 * recent_step_ < step_ || is_slow_enough) start_over();
  if (costs.tight_repairs) {
    trial(0).cost = tight_is_old_ ? *costs.tight_repairs : mixed(trial(0).cost, *costs.tight_repairs, 0.1);
    tight_is_old_ = false;
  }
  LIMBER_ASSERT(trial(0).cost >= 0);
  cost_ += costs.repairs + costs.queries;
  repair_cost_ += costs.repairs;
  ++commits_;
  repairs_ += costs.repairs > 0 ? 1 : 0;
  all_absorbed_ = all_absorbed_ && costs.all_absorbed;
  if (is_over()) finish_trial();
}

bool SlackTuner::is_over() {
  const bool is_hopeless = choice_ != best_ && cost_ > trial(best_).cost * (commits_ + 1);
  // Costs come in waves from one repair to the next; a trial needs whole ones, and slack takes time to be used up.
  const bool is_used_up = commits_ * recent_step_ >= 2 * slack();
  const bool is_whole = commits_ >= shortest_trial && is_used_up && (repairs_ >= 3 || all_absorbed_);
  return is_hopeless || is_whole || commits_ >= longest_trial;
}

void SlackTuner::finish_trial() {
  const double cost = cost_ / commits_;
  Trial& tried = trial(choice_);
  ++trial_count_;
  if (choice_ == best_) {
    // When the best has become another, all that is known of the others is old.
    if (tried.cost >= 0 && (cost > 2 * tried.cost || 2 * cost < tried.cost)) {
      for (int k = 1; k < choices; ++k) trial(k) = {};
    }
    if (choice_ != 0) tried.cost = tried.cost < 0 ? cost : mixed(tried.cost, cost, 0.5);
  } else {
    tried.cost = cost;
    if (cost < trial(best_).cost) {
      best_ = choice_;
      for (Trial& t : trials_) t.wait = first_wait, t.due = trial_count_;
    } else {
      tried.wait = std::min((cost > 2 * trial(best_).cost ? 8 : 2) * tried.wait, longest_wait);
      tried.due = trial_count_ + tried.wait;
    }
  }
  if (trial(0).cost < trial(best_).cost) best_ = 0;
  choice_ = next_choice();
  cost_ = repair_cost_ = 0;
  commits_ = repairs_ = 0;
  all_absorbed_ = true;
}

int SlackTuner::next_choice() {
  if (choice_ != best_) return best_;
  // More slack saves repairs at best, less what queries pay.
  const bool may_gain = best_ == 0 || 3 * repair_cost_ > cost_;
  if (may_gain) {
    // A plateau hides what lies behind it: one slack that absorbs little costs as much as another.
    int up = best_ + 1;
    while (up < choices && !is_due(up) && trial(up).cost < 1.1 * trial(best_).cost) ++up;
    if (is_due(up)) return up;
  }
  if (3 * repair_cost_ < 2 * cost_ && is_due(best_ - 1)) return best_ - 1;
  return best_;
}

}  // namespace limber
