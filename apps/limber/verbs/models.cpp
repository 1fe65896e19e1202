// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/models.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <string_view>

#include "command/options.h"
#include "command/text.h"
#include "formats/csv.h"
#include "scenes/scenes.h"

namespace limber::program {
namespace {

constexpr std::string_view scene_prefix = "scene:";

using AnyModel = std::variant<Model, classic::Model, Mesh>;

AnyModel made(Mesh mesh, Engine engine) {
  if (engine == Engine::fast) return AnyModel(std::in_place_type<Model>, std::move(mesh));
  if (engine == Engine::classic) return AnyModel(std::in_place_type<classic::Model>, std::move(mesh));
  return AnyModel(std::in_place_type<Mesh>, std::move(mesh));
}

/// The model, after setting `elapsed_us` to the time that making it took.
AnyModel timed_made(Mesh mesh, Engine engine, double& elapsed_us) {
  const Stopwatch building;
  AnyModel model = made(std::move(mesh), engine);
  elapsed_us = building.microseconds();
  return model;
}

bool is_inside(const PlacedModel& inner, const PlacedModel& outer) {
  return is_in_box(inner.model.mesh(), inverse(outer.pose) * inner.pose, outer.model.box()) &&
         outer.model.is_closed() && lies_inside(inner.model.mesh(), inner.pose, outer.model.mesh(), outer.pose);
}

}  // namespace

bool is_scene(const std::string& argument) { return argument.starts_with(scene_prefix); }

MeshFile load_mesh_argument(const std::string& argument) {
  if (!is_scene(argument)) return value_or_bad_input(read_mesh_file(argument));
  Mesh mesh = value_or_bad_input(scenes::by_name(argument.substr(scene_prefix.size())), argument + ": ");
  std::vector<std::uint32_t> face_of_triangle(mesh.triangles().size());
  std::iota(face_of_triangle.begin(), face_of_triangle.end(), 0U);
  const std::size_t face_count = face_of_triangle.size();
  return {std::move(mesh), std::move(face_of_triangle), face_count};
}

RigidModel::RigidModel(MeshFile file, Engine engine)
    : box_(box_of(file.mesh)),
      model_(timed_made(std::move(file.mesh), engine, build_us_)),
      face_of_triangle_(std::move(file.face_of_triangle)),
      face_count_(file.face_count) {}

const Mesh& RigidModel::mesh() const {
  if (const auto* const mesh = std::get_if<Mesh>(&model_)) return *mesh;
  if (const auto* const fast = std::get_if<Model>(&model_)) return fast->mesh();
  return std::get<classic::Model>(model_).mesh();
}

bool RigidModel::is_closed() const {
  if (!is_closed_) is_closed_ = count_edges(mesh()).are_closed();
  return *is_closed_;
}

Nesting nesting_of(const PlacedModel& a, const PlacedModel& b) {
  if (is_inside(b, a)) return Nesting::b_in_a;
  return is_inside(a, b) ? Nesting::a_in_b : Nesting::none;
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
  add_choice(command, "--engine", arguments.engine,
             {{"fast", Engine::fast}, {"classic", Engine::classic}, {"reference", Engine::reference}},
             "8-wide trees, binary sphere trees, or every triangle against every other");
  add_json(command, arguments.json, "answer with one JSON object");
  add_exit_code(command, arguments.exit_code, told);
}

Pair::Pair(const PlacedArguments& arguments)
    : arguments_(arguments),
      a_(load_mesh_argument(arguments.a), arguments.engine),
      b_(load_mesh_argument(arguments.b), arguments.engine) {}

double Pair::build_us() const { return rounded_us(a_.build_us() + b_.build_us()); }

}  // namespace limber::program
