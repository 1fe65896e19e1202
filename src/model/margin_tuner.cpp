// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/margin_tuner.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace limber::model {
namespace {

// Motion has changed when a displacement is that much more, or less, than the one the choices are multiples of.
constexpr double much_faster = 8, much_slower = 64;

// How much a new value counts in a running mean.
constexpr double weight_of_displacement = 0.25, weight_of_cost = 0.1, weight_of_trial = 0.5;

// A trial needs that many refits, and commits that together move vertices by this multiple of the margin: costs come in
// waves from one refit to the next.
constexpr int refits_of_trial = 3;
constexpr double margins_of_trial = 2;

// What is known of other choices is old when the cost of the best has changed by this factor.
constexpr double much_changed = 2;

// How much longer a choice waits for its next trial after one that it lost, or lost by a factor of `much_changed`.
constexpr int longer_wait = 2, much_longer_wait = 8;

// A larger margin is tried where refits are more than this part of the cost, a smaller one where they are less than
// that.
constexpr double worth_a_larger_margin = 1.0 / 3, worth_a_smaller_margin = 2.0 / 3;

// A choice that costs less than this times the best may hide a better one behind it.
constexpr double plateau = 1.1;

double mixed(double old, double now, double weight) { return old + weight * (now - old); }

}  // namespace

double MarginTuner::margin() const {
  if (unit_ == 0) return largest_;
  return choice_ == 0 ? 0 : std::ldexp(unit_, choice_ - 1);
}

bool MarginTuner::is_due(int choice) {
  return choice >= 1 && choice < choices && trial(choice).due <= trial_count_ &&
         std::ldexp(unit_, choice - 1) <= largest_;
}

void MarginTuner::start_over() {
  const double cost_without_margin = trial(0).cost;
  trials_ = {};
  trial(0).cost = cost_without_margin;  // until it is known again
  is_unmargined_cost_old_ = true;
  unit_ = recent_displacement_;
  trial_count_ = 0;
  choice_ = is_due(1) ? 1 : 0, best_ = 0;
  cost_ = refit_cost_ = 0;
  commits_ = refits_ = 0;
  all_absorbed_ = true;
}

void MarginTuner::set_largest(double largest) {
  LIMBER_ASSERT(largest >= 0);
  largest_ = largest;
  if (unit_ > 0 && margin() > largest_) start_over();
}

void MarginTuner::add(const Costs& costs) {
  LIMBER_ASSERT(costs.displacement >= 0 && costs.refits >= 0 && costs.refits_without_margin.value_or(0) >= 0 &&
                costs.queries >= 0);
  if (costs.displacement > 0) {
    recent_displacement_ = recent_displacement_ == 0
                               ? costs.displacement
                               : mixed(recent_displacement_, costs.displacement, weight_of_displacement);
  }
  // The first displacement, another kind of motion, or motion that has become slow enough for a margin.
  const bool is_slow_enough = unit_ > largest_ && recent_displacement_ <= largest_;
  const bool is_faster = recent_displacement_ > much_faster * unit_;
  const bool is_slower = much_slower * recent_displacement_ < unit_;
  if (is_faster || is_slower || is_slow_enough) start_over();
  if (costs.refits_without_margin) {
    trial(0).cost = is_unmargined_cost_old_ ? *costs.refits_without_margin
                                            : mixed(trial(0).cost, *costs.refits_without_margin, weight_of_cost);
    is_unmargined_cost_old_ = false;
  }
  LIMBER_ASSERT(trial(0).cost >= 0);
  cost_ += costs.refits + costs.queries;
  refit_cost_ += costs.refits;
  ++commits_;
  refits_ += costs.refits > 0 ? 1 : 0;
  all_absorbed_ = all_absorbed_ && costs.all_absorbed;
  if (is_over()) finish_trial();
}

bool MarginTuner::is_over() {
  const bool is_hopeless = choice_ != best_ && cost_ > trial(best_).cost * (commits_ + 1);
  const bool is_used_up = commits_ * recent_displacement_ >= margins_of_trial * margin();
  const bool is_whole = commits_ >= shortest_trial && is_used_up && (refits_ >= refits_of_trial || all_absorbed_);
  return is_hopeless || is_whole || commits_ >= longest_trial;
}

void MarginTuner::finish_trial() {
  const double cost = cost_ / commits_;
  Trial& tried = trial(choice_);
  ++trial_count_;
  if (choice_ == best_) {
    if (tried.cost >= 0 && (cost > much_changed * tried.cost || much_changed * cost < tried.cost)) {
      for (int k = 1; k < choices; ++k) trial(k) = {};
    }
    if (choice_ != 0) tried.cost = tried.cost < 0 ? cost : mixed(tried.cost, cost, weight_of_trial);
  } else {
    tried.cost = cost;
    if (cost < trial(best_).cost) {
      best_ = choice_;
      for (Trial& t : trials_) t.wait = first_wait, t.due = trial_count_;
    } else {
      const int factor = cost > much_changed * trial(best_).cost ? much_longer_wait : longer_wait;
      tried.wait = std::min(factor * tried.wait, longest_wait);
      tried.due = trial_count_ + tried.wait;
    }
  }
  if (trial(0).cost < trial(best_).cost) best_ = 0;
  choice_ = next_choice();
  cost_ = refit_cost_ = 0;
  commits_ = refits_ = 0;
  all_absorbed_ = true;
}

int MarginTuner::next_choice() {
  if (choice_ != best_) return best_;
  // A larger margin avoids refits at best, a smaller one what queries lose.
  if (best_ == 0 || refit_cost_ > worth_a_larger_margin * cost_) {
    // Two margins that both absorb little cost the same, whatever lies behind them.
    int up = best_ + 1;
    while (up < choices && !is_due(up) && trial(up).cost < plateau * trial(best_).cost) ++up;
    if (is_due(up)) return up;
  }
  if (refit_cost_ < worth_a_smaller_margin * cost_ && is_due(best_ - 1)) return best_ - 1;
  return best_;
}

}  // namespace limber::model
