// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <type_traits>
#include <utility>

#include "limber/distance.h"
#include "limber/model.h"
#include "reference/classic/classic.h"
#include "reference/reference.h"

/// The three engines behind one interface, for tests that hold for all of them.
namespace limber::testing {

struct FastEngine {
  using Model = limber::Model;
  static auto placed(const Model& model, const Transform& pose) { return limber::Placed{model, pose}; }
};

struct ClassicEngine {
  using Model = classic::Model;
  static auto placed(const Model& model, const Transform& pose) { return classic::Placed{model, pose}; }
};

struct ReferenceEngine {
  class Model {
   public:
    explicit Model(Mesh mesh) : mesh_(std::move(mesh)) {}
    const Mesh& mesh() const { return mesh_; }

   private:
    Mesh mesh_;
  };
  static auto placed(const Model& model, const Transform& pose) { return reference::Placed{model.mesh(), pose}; }
};

using Engines = ::testing::Types<FastEngine, ClassicEngine, ReferenceEngine>;

struct EngineNames {
  template <typename Engine>
  static std::string GetName(int) {
    if (std::is_same_v<Engine, FastEngine>) return "fast";
    return std::is_same_v<Engine, ClassicEngine> ? "classic" : "reference";
  }
};

/// Queries of one engine on its models.
template <typename Engine>
struct Asking {
  using Model = typename Engine::Model;

  static DistanceResult distance(const Model& a, const Model& b, const Transform& pose_b = {},
                                 const DistanceOptions& options = {}, const Transform& pose_a = {}) {
    using limber::distance;
    return distance(Engine::placed(a, pose_a), Engine::placed(b, pose_b), options);
  }
  static CollideResult collide(const Model& a, const Model& b, const Transform& pose_b = {},
                               const Transform& pose_a = {}) {
    using limber::collide;
    return collide(Engine::placed(a, pose_a), Engine::placed(b, pose_b));
  }
  static CollideResult within(const Model& a, const Model& b, double max_distance, const Transform& pose_b = {},
                              const Transform& pose_a = {}) {
    using limber::within;
    return within(Engine::placed(a, pose_a), Engine::placed(b, pose_b), max_distance);
  }
};

}  // namespace limber::testing
