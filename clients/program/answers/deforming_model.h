// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "limber/classic.h"
#include "limber/distance.h"
#include "limber/model.h"

namespace CLI {
class App;
}

/// Deforming models of the engine that the user has chosen.
namespace limber::program {

enum class DeformingEngine { fast, classic };

struct DeformingOptions {
  DeformingEngine engine = DeformingEngine::fast;
  ModelOptions fast;
  classic::ModelOptions classic;
};

/// `--engine`, `--motion-margin`, `--extra-radius`, `--mode`, `--stale-ratio`: the engine, and how it updates trees.
void add_deforming(CLI::App& command, DeformingOptions& target);

const char* to_text(DeformingEngine engine);
/// The options in words.
std::string words_of(const DeformingOptions& options);

/// Work done on trees.
struct DeformingWork {
  std::uint64_t moved_vertices = 0;
  std::uint64_t refits = 0;    ///< 8-nodes, or spheres of the classic engine
  std::uint64_t absorbed = 0;  ///< moves of vertices, or spheres of the classic engine, that needed no refit

  DeformingWork& operator+=(const DeformingWork& other);
  DeformingWork operator-(const DeformingWork& earlier) const;
};

class DeformingModel {
 public:
  DeformingModel(Mesh mesh, const DeformingOptions& options);

  Result<void> move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions);
  Result<void> move_all(std::span<const Vec3> positions);
  void commit();
  const Mesh& mesh() const;
  /// Pre: the engine is the fast one.
  const Model& fast() const { return std::get<Model>(model_); }
  DeformingWork work() const;

  /// Pre: both are of the same engine.
  static DistanceResult distance(const DeformingModel& a, const Transform& pose_a, const DeformingModel& b,
                                 const Transform& pose_b, const DistanceOptions& options);

 private:
  std::variant<Model, classic::Model> model_;
};

}  // namespace limber::program
