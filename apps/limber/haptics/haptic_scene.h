// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>

#include "haptics/haptic_models.h"
#include "haptics/haptic_proxy.h"
#include "haptics/tick_loop.h"
#include "limber/distance.h"
#include "limber/model.h"

/// What a haptic loop computes in each tick.
namespace limber::program {

/// How the tree of the tissue is kept up to date: no commit may take long, so each of them rebuilds a little.
ModelOptions tissue_options();

struct HapticOptions {
  std::uint64_t tissue_triangles = 100'000, tool_triangles = 10'000;  ///< at most
  double rate_hz = 1000;
  double relative_error = 0.25;                   ///< of the distance
  std::chrono::nanoseconds tick_budget{130'000};  ///< for all of its work; the query has what moves and commit leave
  ModelOptions tissue_model = tissue_options();
};

/// A tool is pressed into tissue and drawn along. What is commanded and how the tissue gives way depend on the number
/// of the tick alone, so runs can be compared; how far queries come within their budgets depends on the machine.
///
/// Real time  tick() allocates nothing, takes no lock, and makes no system call but to read the clock.
class HapticScene {
 public:
  explicit HapticScene(const HapticOptions& options);

  /// The work of one tick, with what it notes about it. The query ends with the tick's budget.
  void tick(std::uint64_t number, TickSample& sample);

  /// Runs at most some 500 ticks, spread over one pressing, without waiting: memory and caches have been used before
  /// time counts. Returns the number of the tick after the pressing.
  std::uint64_t warm_up();

  const Model& tissue() const { return model_; }
  const Model& tool() const { return tool_; }
  /// Where the tool is commanded to be in a tick.
  Transform device(std::uint64_t number) const;
  const Proxy& proxy() const { return proxy_; }

 private:
  HapticOptions options_;
  DistanceOptions query_;
  Tissue tissue_;
  Model model_;  // of the tissue
  Model tool_;
  Proxy proxy_;
  QueryCache cache_;
};

/// Node tests of exact distances from fixed poses over the scene's tissue as it is now, over those for the same mesh
/// with a new tree. Takes a while.
double node_tests_over_new_tree(const HapticScene& scene);

}  // namespace limber::program
