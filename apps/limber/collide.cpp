// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <memory>

#include "mesh_argument.h"
#include "number_text.h"
#include "options.h"
#include "output.h"
#include "pair_arguments.h"
#include "verb.h"

namespace limber::program {
namespace {

Json as_json(const std::optional<Witness>& witness, const MeshFile& a, const MeshFile& b) {
  if (!witness) return nullptr;
  return {
      {"point", to_json(witness->point_a)},
      {"triangle_a", witness->triangle_a},
      {"triangle_b", witness->triangle_b},
      {"face_a", a.face_of_triangle[witness->triangle_a]},
      {"face_b", b.face_of_triangle[witness->triangle_b]},
  };
}

Json as_json(const TimedAnswer<CollideResult>& timed, const MeshFile& a, const MeshFile& b) {
  return {
      {"query", "collide"},
      {"collision", timed.answer.collision ? "yes" : "no"},
      {"witness", as_json(timed.answer.witness, a, b)},
      {"build_us", timed.build_us},
      {"elapsed_us", timed.elapsed_us},
      {"stats", to_json(timed.answer.stats)},
  };
}

void write_lines(const TimedAnswer<CollideResult>& timed, const MeshFile& a, const MeshFile& b) {
  const CollideResult& result = timed.answer;
  write_line("collision {}", result.collision ? "yes" : "no");
  if (const auto& witness = result.witness) {
    write_line("point     {}", to_text(witness->point_a, " "));
    write_line("on a      triangle {}, face {}", witness->triangle_a, a.face_of_triangle[witness->triangle_a]);
    write_line("on b      triangle {}, face {}", witness->triangle_b, b.face_of_triangle[witness->triangle_b]);
  }
  write_line("tests     {} of nodes, {} of triangles", result.stats.node_tests, result.stats.triangle_tests);
  write_line("time      build {:.3f} us, query {:.3f} us", timed.build_us, timed.elapsed_us);
}

void run(const PairArguments& arguments) {
  const MeshFile a = load_mesh_argument(arguments.a);
  const MeshFile b = load_mesh_argument(arguments.b);
  const auto timed =
      ask(arguments, a, b, [](const auto& placed_a, const auto& placed_b) { return collide(placed_a, placed_b); });
  if (arguments.json) {
    write(to_line(as_json(timed, a, b)));
  } else {
    write_lines(timed, a, b);
  }
}

}  // namespace

Verb add_collide(CLI::App& app) {
  const auto arguments = std::make_shared<PairArguments>();
  CLI::App& command = *app.add_subcommand("collide", "Whether two models meet, and where");
  add_pair_arguments(command, *arguments);
  command.footer(
      "Touching is meeting, and models are surfaces: one wholly inside the other does not meet it. The witness is a\n"
      "point in the world frame, in the meshes' length unit, with the triangles and file faces it lies on, all "
      "counted\n"
      "from 0. Times are in microseconds.");
  return {&command, [arguments] { run(*arguments); }};
}

}  // namespace limber::program
