// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/models.h"

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <numeric>
#include <string_view>

#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"
#include "formats/csv.h"
#include "formats/scenes.h"

namespace limber::program {
namespace {

constexpr std::string_view scene_prefix = "scene:";

/// The model, after setting `elapsed_us` to the time that making it took.
Model timed_made(Mesh mesh, double& elapsed_us) {
  const Stopwatch building;
  Model model(std::move(mesh));
  elapsed_us = building.microseconds();
  return model;
}

/// Whether all triangles of a model lie in the box of another, up to rounding. Stops at the first that does not.
bool is_in_box(const PlacedModel& inner, const PlacedModel& outer) {
  const MeshView mesh = inner.model.mesh();
  const Transform outer_from_inner = inverse(outer.pose) * inner.pose;
  const Box& box = outer.model.box();
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Corners& corners) {
    return std::all_of(corners.begin(), corners.end(), [&](VertexId v) {
      const Vec3 p = outer_from_inner(mesh.positions[v]);
      return min(box.low, p) == box.low && max(box.high, p) == box.high;
    });
  });
}

/// Whether the outer model is closed and has a corner of each triangle inside, decided exactly for corners rounded to
/// float64. Pre: the models do not meet, and the inner one is in the box of the outer one.
bool is_inside(const PlacedModel& inner, const PlacedModel& outer) {
  const Result<ClosedSurface>& surface = outer.model.surface();
  if (!surface) return false;
  const Mesh& mesh = inner.model.mesh();
  const Transform outer_from_inner = inverse(outer.pose) * inner.pose;
  return std::all_of(mesh.triangles().begin(), mesh.triangles().end(), [&](const Corners& corners) {
    return surface->contains(outer_from_inner(mesh.positions()[corners[0]]));
  });
}

}  // namespace

Box box_of(MeshView mesh) {
  const Vec3& first = mesh.positions[mesh.triangles.front()[0]];
  Box box{first, first};
  for (const Corners& corners : mesh.triangles) {
    for (const VertexId v : corners) {
      box.low = min(box.low, mesh.positions[v]);
      box.high = max(box.high, mesh.positions[v]);
    }
  }
  return box;
}

bool is_scene(const std::string& argument) { return argument.starts_with(scene_prefix); }

MeshFile load_mesh_argument(const std::string& argument) {
  if (!is_scene(argument)) {
    MeshFile file = value_or_bad_input(read_mesh_file(argument));
    for (const std::filesystem::path& path : file.files) add_input(path);
    return file;
  }
  Mesh mesh = value_or_bad_input(scenes::by_name(argument.substr(scene_prefix.size())), argument + ": ");
  const std::size_t face_count = mesh.triangles().size();
  MeshFile file{std::move(mesh), std::vector<std::uint32_t>(face_count), face_count, {}, {std::string()}, {}, {}};
  std::iota(file.face_of_triangle.begin(), file.face_of_triangle.end(), 0U);
  file.part_of_triangle.resize(face_count);
  return file;
}

RigidModel::RigidModel(MeshFile file)
    : file_(std::move(file)), box_(box_of(file_.mesh)), model_(timed_made(std::move(file_.mesh), build_us_)) {}

const Result<ClosedSurface>& RigidModel::surface() const {
  if (!surface_) surface_ = ClosedSurface::create(model_);
  return *surface_;
}

std::optional<SolidRelationResult> solids_of(const PlacedModel& a, const PlacedModel& b) {
  const Result<ClosedSurface>&surface_a = a.model.surface(), &surface_b = b.model.surface();
  if (!surface_a || !surface_b) return std::nullopt;
  return solid_relation({surface_a.value(), a.pose}, {surface_b.value(), b.pose});
}

Nesting nesting_of(const SolidRelationResult& solids) {
  if (solids.witness) return Nesting::none;
  if (solids.relation == SolidRelation::b_inside_a) return Nesting::b_inside_a;
  return solids.relation == SolidRelation::a_inside_b ? Nesting::a_inside_b : Nesting::none;
}

Nesting nesting_of(const PlacedModel& a, const PlacedModel& b) {
  const bool b_may_be = is_in_box(b, a), a_may_be = is_in_box(a, b);
  if (!a_may_be && !b_may_be) return Nesting::none;
  if (const auto solids = solids_of(a, b)) return nesting_of(*solids);
  if (b_may_be && is_inside(b, a)) return Nesting::b_inside_a;
  return a_may_be && is_inside(a, b) ? Nesting::a_inside_b : Nesting::none;
}

namespace {

/// The poses of a path, or that of a model that stands still.
std::vector<Transform> poses_of(const std::string& path, const Transform& pose, const char* option) {
  if (path.empty()) return {pose};
  std::vector<Transform> poses = read_poses(path);
  if (poses.size() > 1) return poses;
  throw BadInput(fmt::format("{}: {} has one pose, and a path two or more", option, path));
}

RigidMotion motion_from(const std::vector<Transform>& poses, std::size_t step) {
  return poses.size() == 1 ? RigidMotion(poses[0]) : RigidMotion(poses[step], poses[step + 1]);
}

void add_work(auto& sum, const auto& found) {
  sum.distance_count += found.distance_count;
  sum.stats.node_tests += found.stats.node_tests;
  sum.stats.primitive_tests += found.stats.primitive_tests;
}

}  // namespace

Path::Path(const PlacedArguments& arguments) {
  const std::vector<Transform> poses_a = poses_of(arguments.path_a, arguments.pose_a, "--path-a"),
                               poses_b = poses_of(arguments.path_b, arguments.pose_b, "--path-b");
  if (poses_a.size() > 1 && poses_b.size() > 1 && poses_a.size() != poses_b.size()) {
    throw BadInput(fmt::format("--path-a has {} poses, but --path-b has {}", poses_a.size(), poses_b.size()));
  }
  const std::size_t pose_count = std::max(poses_a.size(), poses_b.size());
  for (std::size_t s = 0; s + 1 < pose_count; ++s) steps_.push_back({motion_from(poses_a, s), motion_from(poses_b, s)});
}

PathImpact Path::first_impact(const Model& a, const Model& b, double separation) const {
  QueryCache cache;
  const PathOptions options{.min_separation = separation, .cache = &cache};
  PathImpact first;
  first.status = ImpactStatus::clear;
  for (std::size_t s = 0; s < steps_.size() && first.status == ImpactStatus::clear; ++s) {
    const PathImpact found = time_of_impact(a, steps_[s].a, b, steps_[s].b, options);
    first.status = found.status, first.time = static_cast<double>(s) + found.time, first.witness = found.witness;
    add_work(first, found);
  }
  return first;
}

PathDistance Path::min_distance(const Model& a, const Model& b, std::optional<double> distance_error) const {
  QueryCache cache;
  const PathOptions options{.distance_error = distance_error, .cache = &cache};
  PathDistance least;
  least.lower = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    const PathDistance found = limber::min_distance(a, steps_[s].a, b, steps_[s].b, options);
    least.lower = std::min(least.lower, found.lower);
    if (found.upper < least.upper) {
      least.upper = found.upper, least.time = static_cast<double>(s) + found.time, least.witness = found.witness;
    }
    add_work(least, found);
  }
  return least;
}

void add_pose(CLI::App& command, const std::string& name, Transform& target, const std::string& model) {
  const auto read = [&target, name](const std::string& text) {
    const Result<Transform> pose = parsed_pose(text);
    if (!pose) throw CLI::ValidationError(name, pose.error().text);
    target = *pose;
  };
  command
      .add_option_function<std::string>(name, read,
                                        "where " + model + " stands in the world, as " + pose_format +
                                            ": translation in the mesh's length unit, quaternion of any length")
      ->type_name("POSE")
      ->default_str("0,0,0,1,0,0,0");
}

void add_placed_arguments(CLI::App& command, PlacedArguments& arguments) {
  command.add_option("A", arguments.a, model_argument_help)->type_name("MODEL")->required();
  command.add_option("B", arguments.b, "as A, in the same length unit")->type_name("MODEL")->required();
  add_pose(command, "--pose-a", arguments.pose_a, "A");
  add_pose(command, "--pose-b", arguments.pose_b, "B");
}

void add_pair_arguments(CLI::App& command, PairArguments& arguments, const std::string& told) {
  add_placed_arguments(command, arguments);
  for (auto* const path : {&arguments.path_a, &arguments.path_b}) {
    const char* const model = path == &arguments.path_a ? "a" : "b";
    add_file(command, std::string("--path-") + model, *path, "CSV",
             "instead of a pose, where the model goes: two or more poses, one per row")
        ->excludes(std::string("--pose-") + model);
  }
  command.add_flag("--json", arguments.json, "answer with one JSON object");
  add_exit_code(command, arguments.exit_code, told);
}

Pair::Pair(const PlacedArguments& arguments)
    : arguments_(arguments), a_(load_mesh_argument(arguments.a)), b_(load_mesh_argument(arguments.b)) {
  if (arguments.path_a.empty() && arguments.path_b.empty()) return;
  path_.emplace(arguments);
  arguments_.pose_a = path_->start_a();
  arguments_.pose_b = path_->start_b();
}

double Pair::build_us() const { return rounded_us(a_.build_us() + b_.build_us()); }

}  // namespace limber::program
