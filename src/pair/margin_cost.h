// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pair/placed_pair.h"

namespace limber::pair {

/// Steps of a traversal that tight bounds would have made unnecessary, as far as can be told; a fraction stands for a
/// chance. Without a motion margin there are none.
class MarginCost {
 public:
  explicit MarginCost(const PlacedPair& placed) : slack_(placed.slack()) {}

  /// Counts a pair of nodes that is not pruned. `tight_sq` is what the limit would be without the margin.
  ///
  /// If the limit exceeds the margin, the pair would have been pruned without it. Otherwise bounds do not tell; the
  /// chance is taken to be margin / (margin + split_priority of both nodes).
  template <typename Trees>
  void count_nodes(const Trees& trees, const NodePair& pair, float tight_sq) {
    if (slack_ == 0 || pair.bound_sq < tight_sq) return;
    cost_ += tight_sq > 0
                 ? 1
                 : slack_ / (slack_ + trees.split_priority(Side::a, pair) + trees.split_priority(Side::b, pair));
  }
  /// Counts two triangles that are compared. `limit` and the root of `bound_sq` are lengths times `scale`.
  void count_triangles(double limit, double bound_sq, double scale) {
    if (slack_ == 0) return;
    const double tight = limit - slack_ * scale;
    if (bound_sq >= tight * tight) cost_ += 1;
  }

  /// Adds the cost to what the models count.
  void note(const PlacedPair& placed) const {
    if (slack_ > 0) placed.add_margin_cost(cost_);
  }

 private:
  double slack_;
  double cost_ = 0;
};

}  // namespace limber::pair
