// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "command/output.h"
#include "limber/classic.h"
#include "limber/io.h"
#include "limber/model.h"
#include "limber/points.h"
#include "limber/solids.h"
#include "reference/reference.h"
#include "verbs/paths.h"

namespace CLI {
class App;
}

/// Models as the command line names them, and queries between two that do not deform.
namespace limber::program {

/// The help about an argument that names a model.
inline constexpr const char* model_argument_help = "mesh file (.obj .ply .stl .off .gltf .glb) or scene:NAME";

/// An edge has two distinct ends. A triangle uses an edge once, even where two of its corners coincide.
struct EdgeCounts {
  std::size_t open = 0;          ///< used by one triangle
  std::size_t closed = 0;        ///< used by two
  std::size_t non_manifold = 0;  ///< used by more

  /// Whether every edge has two triangles, so that the mesh has an inside.
  bool are_closed() const { return closed > 0 && open == 0 && non_manifold == 0; }
};
EdgeCounts count_edges(MeshView mesh);

/// The box of the triangles; vertices without a triangle do not count. Pre: there is a triangle.
Box box_of(MeshView mesh);

/// Whether the argument names a scene instead of a file.
bool is_scene(const std::string& argument);

/// Reads a mesh file or makes a scene; each triangle of a scene is a face of its own.
///
/// Errors   BadInput naming the argument.
MeshFile load_mesh_argument(const std::string& argument);

enum class Engine { fast, classic, reference };

struct PlacedModel;

/// A model that does not deform, ready for queries of one engine.
class RigidModel {
 public:
  RigidModel(MeshFile file, Engine engine);
  RigidModel(const RigidModel&) = delete;  // surface() points into it
  RigidModel& operator=(const RigidModel&) = delete;

  const Mesh& mesh() const;
  /// Pre: the engine is the fast one.
  const Model& fast() const { return std::get<Model>(model_); }
  /// The model in the fast engine, whichever it is of; made when it is first asked for.
  const Model& in_fast_engine() const;
  std::uint32_t face_of(TriangleId triangle) const { return face_of_triangle_[triangle]; }
  std::size_t face_count() const { return face_count_; }  ///< of the file
  /// The name of the part that a triangle belongs to; null where the file has one part alone.
  const std::string* part_of(TriangleId triangle) const {
    return parts_.size() > 1 ? &parts_[part_of_triangle_[triangle]] : nullptr;
  }
  double build_us() const { return build_us_; }  ///< time for the tree
  const Box& box() const { return box_; }        ///< of the triangles, in the model's frame
  bool is_closed() const;                        ///< counted when it is first asked for
  /// The surface as that of a solid, or what it lacks; looked at when it is first asked for.
  const Result<ClosedSurface>& surface() const;

 private:
  template <typename Query>
  friend auto ask(const PlacedModel& a, const PlacedModel& b, Query query);

  Box box_;
  double build_us_ = 0;
  std::variant<Model, classic::Model, Mesh> model_;
  std::vector<std::uint32_t> face_of_triangle_;
  std::size_t face_count_ = 0;
  std::vector<std::string> parts_;
  std::vector<std::uint32_t> part_of_triangle_;
  mutable std::optional<bool> is_closed_;
  mutable std::optional<Model> in_fast_engine_;  // where the engine is another one
  mutable std::optional<Result<ClosedSurface>> surface_;
};

/// A model and where it stands. The model must outlive it.
struct PlacedModel {
  const RigidModel& model;
  Transform pose;  ///< world_from_model
};

template <typename Answer>
struct TimedAnswer {
  Answer answer;
  double elapsed_us = 0;  ///< of the query alone
};

inline Placed placed(const Model& model, const Transform& pose) { return {model, pose}; }
inline classic::Placed placed(const classic::Model& model, const Transform& pose) { return {model, pose}; }
inline reference::Placed placed(const Mesh& mesh, const Transform& pose) { return {mesh, pose}; }

/// Puts a query to the engine of two models; `query` takes two placed models or meshes of any engine.
///
/// Pre      Both models are of one engine.
template <typename Query>
auto ask(const PlacedModel& a, const PlacedModel& b, Query query) {
  const auto ask_engine = [&](const auto& model_a) {
    const auto& model_b = std::get<std::decay_t<decltype(model_a)>>(b.model.model_);
    const Stopwatch asking;
    auto answer = query(placed(model_a, a.pose), placed(model_b, b.pose));
    return TimedAnswer<decltype(answer)>{std::move(answer), asking.microseconds()};
  };
  return std::visit(ask_engine, a.model.model_);
}

/// How the volumes of two models lie to each other; nothing unless RigidModel::surface() of both is closed.
std::optional<SolidRelationResult> solids_of(const PlacedModel& a, const PlacedModel& b);

/// Whether one of two models lies wholly inside the other, which is closed. Queries take models for surfaces, so to
/// them such a pair is apart.
enum class Nesting { none, a_inside_b, b_inside_a };

/// How two models are nested whose volumes lie like that.
Nesting nesting_of(const SolidRelationResult& solids);

/// How two models are nested. The answer means nothing if they meet.
///
/// Cost     O(1) where a vertex of each lies outside the other's box; otherwise O(n) for n triangles, O(n log n) the
///          first time, or more: that of solid_relation().
Nesting nesting_of(const PlacedModel& a, const PlacedModel& b);

/// Two rigid models, and where they stand or go.
struct PlacedArguments {
  std::string a, b;
  Transform pose_a, pose_b;    // world_from_model
  std::string path_a, path_b;  // files of poses; empty: the model stands still
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

/// Adds the options of PlacedArguments, `--path-a`, `--path-b`, `--engine`, `--json`, and `--exit-code` with what it
/// tells, such as "the models collide".
void add_pair_arguments(CLI::App& command, PairArguments& arguments, const std::string& told);

/// The two models that the arguments name, at the start of their path if they have one.
class Pair {
 public:
  /// Errors   BadInput of load_mesh_argument() and Path; with a path, unless the engine is the fast one.
  explicit Pair(const PlacedArguments& arguments);

  PlacedModel a() const { return {a_, arguments_.pose_a}; }
  PlacedModel b() const { return {b_, arguments_.pose_b}; }
  const std::optional<Path>& path() const { return path_; }
  double build_us() const;  ///< of the trees of both

 private:
  PlacedArguments arguments_;
  std::optional<Path> path_;
  RigidModel a_, b_;
};

}  // namespace limber::program
