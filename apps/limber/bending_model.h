// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "limber/classic.h"
#include "limber/model.h"

/// Models that bend, of the engine the user has chosen.
namespace limber::program {

enum class BendingEngine { fast, classic };

struct BendingOptions {
  BendingEngine engine = BendingEngine::fast;
  ModelOptions fast;
  classic::ModelOptions classic;
};

/// `--engine`, `--slack`, `--mode`, `--stale-ratio`: what follows moving vertices, and how.
void add_bending(CLI::App& command, BendingOptions& target);

const char* to_text(BendingEngine engine);
/// What was said of slack and modes, in words.
std::string words_of(const BendingOptions& options);

/// Work done on trees.
struct BendingWork {
  std::uint64_t moved_vertices = 0;
  std::uint64_t refits = 0;    ///< blocks of eight nodes, or spheres of the classic engine
  std::uint64_t absorbed = 0;  ///< vertices, or spheres, that slack left as they were

  BendingWork& operator+=(const BendingWork& other);
  BendingWork operator-(const BendingWork& earlier) const;
};

class BendingModel {
 public:
  BendingModel(Mesh mesh, const BendingOptions& options);

  Result<void> move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions);
  Result<void> move_all(std::span<const Vec3> positions);
  void commit();
  const Mesh& mesh() const;
  BendingWork work() const;

  /// Pre: both are of the same engine.
  static DistanceResult distance(const BendingModel& a, const Transform& pose_a, const BendingModel& b,
                                 const Transform& pose_b, const DistanceOptions& options);

 private:
  std::variant<Model, classic::Model> model_;
};

}  // namespace limber::program
