// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "verbs/models.h"

namespace CLI {
class App;
}

namespace limber::program {

/// Two rigid models, and where they stand.
struct PlacedArguments {
  std::string a, b;
  Transform pose_a, pose_b;  // world_from_model
  Engine engine = Engine::fast;
};

/// An option that says where a model stands: "A".
void add_pose(CLI::App& command, const std::string& name, Transform& target, const std::string& model);

/// `A`, `B`, `--pose-a`, `--pose-b`.
void add_placed_arguments(CLI::App& command, PlacedArguments& arguments);

/// The arguments that the verbs about the closest or any pair of points of two rigid models share.
struct PairArguments : PlacedArguments {
  bool json = false;
  bool exit_code = false;
};

/// Those above, `--engine`, `--json`, and `--exit-code` with what it tells: "the models collide".
void add_pair_arguments(CLI::App& command, PairArguments& arguments, const std::string& told);

/// The two models that the arguments name.
class Pair {
 public:
  explicit Pair(const PlacedArguments& arguments);

  PlacedModel a() const { return {a_, arguments_.pose_a}; }
  PlacedModel b() const { return {b_, arguments_.pose_b}; }
  double build_us() const;  ///< of the trees of both

 private:
  PlacedArguments arguments_;
  RigidModel a_, b_;
};

}  // namespace limber::program
