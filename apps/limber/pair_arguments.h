// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "models.h"

namespace CLI {
class App;
}

namespace limber::program {

/// The arguments that the verbs about two rigid models share.
struct PairArguments {
  std::string a, b;
  Transform pose_a, pose_b;  // world_from_model
  Engine engine = Engine::fast;
  bool json = false;
  bool exit_code = false;
};

/// `A`, `B`, `--pose-a`, `--pose-b`, `--engine`, `--json`, and `--exit-code` with what it tells: "the models collide".
void add_pair_arguments(CLI::App& command, PairArguments& arguments, const std::string& told);

/// The two models that the arguments name.
class Pair {
 public:
  explicit Pair(const PairArguments& arguments);

  PlacedModel a() const { return {a_, arguments_.pose_a}; }
  PlacedModel b() const { return {b_, arguments_.pose_b}; }
  double build_us() const;  ///< of the trees of both

 private:
  PairArguments arguments_;
  RigidModel a_, b_;
};

}  // namespace limber::program
