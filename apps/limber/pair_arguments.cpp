// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair_arguments.h"

#include "mesh_argument.h"
#include "options.h"
#include "pose_text.h"

namespace limber::program {
namespace {

void add_pose(CLI::App& command, const std::string& name, Transform& target, const std::string& model) {
  const auto read = [&target, name](const std::string& text) {
    const Result<Transform> pose = parsed_pose(text);
    if (!pose) throw CLI::ValidationError(name, pose.error().text);
    target = *pose;
  };
  command
      .add_option_function<std::string>(name, read,
                                        "where " + model +
                                            " stands in the world: translation in the "
                                            "mesh's length unit, quaternion of any length")
      ->type_name(pose_format)
      ->default_str("0,0,0,1,0,0,0");
}

}  // namespace

void add_pair_arguments(CLI::App& command, PairArguments& arguments) {
  command.add_option("A", arguments.a, model_argument_help)->type_name("MODEL")->required();
  command.add_option("B", arguments.b, "as A, in the same length unit")->type_name("MODEL")->required();
  add_pose(command, "--pose-a", arguments.pose_a, "A");
  add_pose(command, "--pose-b", arguments.pose_b, "B");
  add_choice(command, "--engine", arguments.engine,
             {{"fast", Engine::fast}, {"classic", Engine::classic}, {"reference", Engine::reference}},
             "wide trees, the original binary sphere trees, or every triangle against every other");
  add_json(command, arguments.json, "answer with one JSON object");
}

}  // namespace limber::program
