// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command/output.h"
#include "limber/io.h"
#include "limber/model.h"
#include "limber/path.h"
#include "limber/points.h"
#include "limber/solids.h"

namespace CLI {
class App;
}

/// Models as the command line names them, and queries between two that do not deform.
namespace limber::program {

/// The help about an argument that names a model.
inline constexpr const char* model_argument_help = "mesh file (.obj .ply .stl .off .gltf .glb) or scene:NAME";

/// The box of the triangles; vertices without a triangle do not count. Pre: there is a triangle.
Box box_of(MeshView mesh);

/// Whether the argument names a scene instead of a file.
bool is_scene(const std::string& argument);

/// Reads a mesh file or makes a scene; each triangle of a scene is a face of its own.
///
/// Errors   BadInput naming the argument.
MeshFile load_mesh_argument(const std::string& argument);

/// A model that does not deform.
class RigidModel {
 public:
  explicit RigidModel(MeshFile file);
  RigidModel(const RigidModel&) = delete;  // surface() points into it
  RigidModel& operator=(const RigidModel&) = delete;

  const Mesh& mesh() const { return model_.mesh(); }
  const Model& model() const { return model_; }
  std::uint32_t face_of(TriangleId triangle) const { return file_.face_of_triangle[triangle]; }
  std::size_t face_count() const { return file_.face_count; }
  /// The name of the part that a triangle belongs to; null where the file has one part alone.
  const std::string* part_of(TriangleId triangle) const {
    return file_.parts.size() > 1 ? &file_.parts[file_.part_of_triangle[triangle]] : nullptr;
  }
  double build_us() const { return build_us_; }  ///< time for the tree
  const Box& box() const { return box_; }        ///< of the triangles, in the model's frame
  /// The surface as that of a solid, or what it lacks; looked at when it is first asked for.
  const Result<ClosedSurface>& surface() const;

 private:
  MeshFile file_;  // without the mesh, which the model has
  Box box_;
  double build_us_ = 0;
  Model model_;
  mutable std::optional<Result<ClosedSurface>> surface_;
};

/// A model and where it stands. The model must outlive it.
struct PlacedModel {
  const RigidModel& model;
  Transform pose;  ///< world_from_model

  operator Placed() const { return {model.model(), pose}; }  // NOLINT(google-explicit-constructor)
};

/// How the volumes of two models lie to each other; nothing unless RigidModel::surface() of both is closed.
std::optional<SolidRelationResult> solids_of(const PlacedModel& a, const PlacedModel& b);

/// Whether one of two models lies wholly inside the other, whose RigidModel::surface() is closed. Queries take models
/// for surfaces, so to them such a pair is apart.
enum class Nesting { none, a_inside_b, b_inside_a };

/// How two models are nested whose volumes lie like that.
Nesting nesting_of(const SolidRelationResult& solids);

/// How two models are nested. The answer means nothing if they meet.
///
/// Cost     O(1) where a vertex of each lies outside the other's box; otherwise O(n log n) for n triangles, or more:
///          that of solid_relation().
Nesting nesting_of(const PlacedModel& a, const PlacedModel& b);

/// The help text about path files, for every verb that reads them.
inline constexpr const char* path_help = R"(
A path file has a pose per row, tx,ty,tz,qw,qx,qy,qz, with a header or without, as limber track reads them. The model
is at the first pose at time 0, at the second at time 1, and so on: 1.25 is a quarter of the way from the second to the
third. On the way the model's origin moves straight, and the model turns about one axis, the shorter way round, both at
constant speed. Paths of both models have as many poses.
)";

/// Two rigid models, and where they stand or go.
struct PlacedArguments {
  std::string a, b;
  Transform pose_a, pose_b;    // world_from_model
  std::string path_a, path_b;  // files of poses; empty: the model stands still
};

/// How two models go along their poses, one step after the other.
class Path {
 public:
  /// Pre      One of the two has a path.
  /// Errors   BadInput of read_poses(); where there are fewer than two poses, or not as many for both models.
  explicit Path(const PlacedArguments& arguments);

  const Transform& start_a() const { return steps_.front().a.start(); }
  const Transform& start_b() const { return steps_.front().b.start(); }

  /// As time_of_impact() and min_distance() of limber/path.h, but times are those of the path.
  PathImpact first_impact(const Model& a, const Model& b, double separation) const;
  PathDistance min_distance(const Model& a, const Model& b, std::optional<double> distance_error) const;

 private:
  struct Step {
    RigidMotion a, b;
  };

  std::vector<Step> steps_;
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

/// Adds the options of PlacedArguments, `--path-a`, `--path-b`, `--json`, and `--exit-code` with what it
/// tells, such as "the models collide".
void add_pair_arguments(CLI::App& command, PairArguments& arguments, const std::string& told);

/// The two models that the arguments name, at the start of their path if they have one.
class Pair {
 public:
  /// Errors   BadInput of load_mesh_argument() and Path.
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
