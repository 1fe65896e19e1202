// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace limber::base {

/// Time for work that is done in small steps. Time is estimated from counts, so the same calls do the same steps on
/// every machine.
class WorkBudget {
 public:
  explicit WorkBudget(double ns) : left_ns_(ns) {}
  static WorkBudget unlimited() { return WorkBudget(std::numeric_limits<double>::infinity()); }

  void add(double ns) { left_ns_ += ns; }

  /// To be asked before every step.
  bool is_spent() const { return left_ns_ <= 0; }
  /// Takes off what a step has cost. The last step may take more than is left.
  void spend(double ns) { left_ns_ -= ns, spent_ns_ += ns; }

  double left_ns() const { return left_ns_; }
  double spent_ns() const { return spent_ns_; }

 private:
  double left_ns_;
  double spent_ns_ = 0;
};

}  // namespace limber::base
