// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/models.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <numeric>
#include <string_view>

#include "command/options.h"
#include "command/run_files.h"
#include "command/text.h"
#include "formats/csv_inputs.h"
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

/// A mesh of more connected parts is not looked at.
constexpr std::size_t max_parts = 64;

/// One corner of each connected part, of which there may be `max_parts` + 1 or more.
std::vector<VertexId> corners_of_parts(MeshView mesh) {
  // Every vertex points to one of its part, and the last of them to itself.
  std::vector<VertexId> next(mesh.positions.size());
  std::iota(next.begin(), next.end(), VertexId{0});
  const auto last_of = [&](VertexId v) {
    while (next[v] != v) v = next[v] = next[next[v]];
    return v;
  };
  for (const Corners& c : mesh.triangles) {
    next[last_of(c[1])] = last_of(c[0]);
    next[last_of(c[2])] = last_of(c[0]);
  }
  std::vector<VertexId> corners;
  for (const Corners& c : mesh.triangles) {
    if (corners.size() > max_parts) break;
    const VertexId last = last_of(c[0]);
    if (std::find(corners.begin(), corners.end(), last) == corners.end()) corners.push_back(last);
  }
  return corners;
}

/// How often a segment crosses a mesh; empty where it meets the border of a triangle, so that crossings say nothing.
std::optional<std::size_t> count_crossings(const Segment& segment, MeshView mesh) {
  std::size_t count = 0;
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    if (!intersects(segment, triangle)) continue;
    const auto passes_edge = [&](std::size_t i) {
      return orient3d(segment.p0, segment.p1, triangle[i], triangle[(i + 1) % 3]) == 0;
    };
    if (passes_edge(0) || passes_edge(1) || passes_edge(2)) return std::nullopt;
    ++count;
  }
  return count;
}

/// Pre: the point is not on the mesh, and 9 `size` away from it along any axis no triangle is left.
bool is_inside(const Vec3& point, MeshView mesh, double size) {
  constexpr int max_rays = 32;  // a ray at random meets a border once in a long time
  scenes::Rng rng(1);
  for (int i = 0; i < max_rays; ++i) {
    const Vec3 direction{rng.uniform(0.5, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    const auto crossings = count_crossings({point, point + (16 * size) * direction}, mesh);
    if (crossings) return *crossings % 2 == 1;
  }
  return false;
}

/// Whether all triangles of a mesh lie in a box of another frame, up to rounding. Stops at the first that does not.
bool is_in_box(MeshView mesh, const Transform& box_from_mesh, const Box& box) {
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Corners& corners) {
    return std::all_of(corners.begin(), corners.end(), [&](VertexId v) {
      const Vec3 p = box_from_mesh(mesh.positions[v]);
      return min(box.low, p) == box.low && max(box.high, p) == box.high;
    });
  });
}

/// Whether a mesh lies wholly inside a closed mesh: a ray from one vertex of each connected part crosses the closed
/// mesh an odd number of times, decided exactly for the placed vertices rounded to float64. Says no for more than
/// `max_parts` parts.
///
/// Pre      The meshes do not meet, or else the answer means nothing; both poses are world_from_mesh.
/// Cost     O(triangles of both), for each part.
bool lies_inside(MeshView inner, const Transform& inner_pose, MeshView outer, const Transform& outer_pose) {
  const std::vector<VertexId> corners = corners_of_parts(inner);
  if (corners.size() > max_parts) return false;
  std::vector<Vec3> positions(outer.positions.size());
  std::transform(outer.positions.begin(), outer.positions.end(), positions.begin(), outer_pose);
  const MeshView placed{positions, outer.triangles};
  const Box box = box_of(placed);
  const double size = max_abs(box.high - box.low);
  return std::all_of(corners.begin(), corners.end(),
                     [&](VertexId v) { return is_inside(inner_pose(inner.positions[v]), placed, size); });
}

bool is_in_box(const PlacedModel& inner, const PlacedModel& outer) {
  return is_in_box(inner.model.mesh(), inverse(outer.pose) * inner.pose, outer.model.box());
}

/// Pre: the inner model is in the box of the outer one.
bool is_inside(const PlacedModel& inner, const PlacedModel& outer) {
  return outer.model.is_closed() && lies_inside(inner.model.mesh(), inner.pose, outer.model.mesh(), outer.pose);
}

}  // namespace

EdgeCounts count_edges(MeshView mesh) {
  using Edge = std::pair<VertexId, VertexId>;
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Corners& c : mesh.triangles) {
    std::array<Edge, 3> own = {std::minmax(c[0], c[1]), std::minmax(c[1], c[2]), std::minmax(c[2], c[0])};
    std::sort(own.begin(), own.end());
    const auto end = std::unique(own.begin(), own.end());
    std::copy_if(own.begin(), end, std::back_inserter(edges), [](const Edge& e) { return e.first != e.second; });
  }
  std::sort(edges.begin(), edges.end());
  EdgeCounts counts;
  for (auto first = edges.begin(); first != edges.end();) {
    const auto last = std::find_if(first, edges.end(), [first](const Edge& e) { return e != *first; });
    ++(last - first == 1 ? counts.open : last - first == 2 ? counts.closed : counts.non_manifold);
    first = last;
  }
  return counts;
}

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
  std::vector<std::uint32_t> face_of_triangle(mesh.triangles().size());
  std::iota(face_of_triangle.begin(), face_of_triangle.end(), 0U);
  const std::size_t face_count = face_of_triangle.size();
  std::vector<VertexId> vertices(mesh.positions().size());
  std::iota(vertices.begin(), vertices.end(), VertexId{0});
  return {std::move(mesh),
          std::move(face_of_triangle),
          face_count,
          std::move(vertices),
          {std::string()},
          std::vector<std::uint32_t>(face_count),
          {}};
}

RigidModel::RigidModel(MeshFile file)
    : box_(box_of(file.mesh)),
      model_(timed_made(std::move(file.mesh), build_us_)),
      face_of_triangle_(std::move(file.face_of_triangle)),
      face_count_(file.face_count),
      parts_(std::move(file.parts)),
      part_of_triangle_(std::move(file.part_of_triangle)) {}

bool RigidModel::is_closed() const {
  if (!is_closed_) is_closed_ = count_edges(mesh()).are_closed();
  return *is_closed_;
}

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

/// The poses of a path, or one of a model that stands still.
std::vector<Transform> poses_of(const PathArguments& arguments, const char* option) {
  if (arguments.poses.empty()) return {arguments.pose};
  std::vector<Transform> poses = read_poses(arguments.poses);
  if (poses.size() > 1) return poses;
  throw BadInput(fmt::format("{}: {} has one pose, and a path two or more", option, arguments.poses));
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

Path::Path(const PathArguments& a, const PathArguments& b) {
  const std::vector<Transform> poses_a = poses_of(a, "--path-a"), poses_b = poses_of(b, "--path-b");
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
  add_json(command, arguments.json, "answer with one JSON object");
  add_exit_code(command, arguments.exit_code, told);
}

Pair::Pair(const PlacedArguments& arguments)
    : arguments_(arguments), a_(load_mesh_argument(arguments.a)), b_(load_mesh_argument(arguments.b)) {
  if (arguments.path_a.empty() && arguments.path_b.empty()) return;
  path_.emplace(PathArguments{arguments.path_a, arguments.pose_a}, PathArguments{arguments.path_b, arguments.pose_b});
  arguments_.pose_a = path_->start_a();
  arguments_.pose_b = path_->start_b();
}

double Pair::build_us() const { return rounded_us(a_.build_us() + b_.build_us()); }

}  // namespace limber::program
