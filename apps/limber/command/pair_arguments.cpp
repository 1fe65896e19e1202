// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/pair_arguments.h"

#include "command/options.h"
#include "command/verb.h"
#include "formats/pose_text.h"

namespace limber::program {

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
