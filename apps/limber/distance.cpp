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

struct Arguments {
  PairArguments pair;
  DistanceOptions options;
};

Json as_json(const TimedAnswer<DistanceResult>& timed, const MeshFile& a, const MeshFile& b) {
  const DistanceResult& result = timed.answer;
  const Witness& witness = result.witness;
  return {
      {"query", "distance"},
      {"lower", result.lower},
      {"upper", result.upper},
      {"status", to_text(result.status)},
      {"point_a", to_json(witness.point_a)},
      {"point_b", to_json(witness.point_b)},
      {"triangle_a", witness.triangle_a},
      {"triangle_b", witness.triangle_b},
      {"face_a", a.face_of_triangle[witness.triangle_a]},
      {"face_b", b.face_of_triangle[witness.triangle_b]},
      {"build_us", timed.build_us},
      {"elapsed_us", timed.elapsed_us},
      {"stats", to_json(result.stats)},
  };
}

void write_lines(const TimedAnswer<DistanceResult>& timed, const MeshFile& a, const MeshFile& b) {
  const DistanceResult& result = timed.answer;
  const Witness& witness = result.witness;
  write_line("status    {}", to_text(result.status));
  write_line("lower     {}", to_text(result.lower));
  write_line("upper     {}", to_text(result.upper));
  write_line("point a   {}", to_text(witness.point_a, " "));
  write_line("point b   {}", to_text(witness.point_b, " "));
  write_line("on a      triangle {}, face {}", witness.triangle_a, a.face_of_triangle[witness.triangle_a]);
  write_line("on b      triangle {}, face {}", witness.triangle_b, b.face_of_triangle[witness.triangle_b]);
  write_line("tests     {} of spheres, {} of triangles", result.stats.node_tests, result.stats.triangle_tests);
  write_line("time      build {:.3f} us, query {:.3f} us", timed.build_us, timed.elapsed_us);
}

void run(const Arguments& arguments) {
  const MeshFile a = load_mesh_argument(arguments.pair.a);
  const MeshFile b = load_mesh_argument(arguments.pair.b);
  const auto timed = ask(arguments.pair, a, b, [&](const auto& placed_a, const auto& placed_b) {
    return distance(placed_a, placed_b, arguments.options);
  });
  if (arguments.pair.json) {
    write(to_line(as_json(timed, a, b)));
  } else {
    write_lines(timed, a, b);
  }
}

}  // namespace

Verb add_distance(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = *app.add_subcommand("distance", "Shortest distance of two models and the points that attain it");
  add_pair_arguments(command, arguments->pair);
  add_relative_error(command, arguments->options.relative_error);
  command.footer(
      "Lengths are in the meshes' unit, points in the world frame, times in microseconds. lower <= true distance <=\n"
      "upper; status is exact (lower = upper), within_error, or collision (both 0). Triangles count from 0 in the\n"
      "file's order after splitting larger faces into fans; faces are the file's own, counted from 0.");
  return {&command, [arguments] { run(*arguments); }};
}

}  // namespace limber::program
