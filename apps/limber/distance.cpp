// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <limits>
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

/// A field of the answer, or null where nothing was found.
template <typename T>
Json found(const DistanceResult& result, const T& value) {
  return result.status == Status::beyond_limit ? Json(nullptr) : Json(value);
}

Json as_json(const TimedAnswer<DistanceResult>& timed, const MeshFile& a, const MeshFile& b) {
  const DistanceResult& result = timed.answer;
  const Witness witness = result.witness.value_or(Witness{});
  Json json = {
      {"query", "distance"},
      {"lower", result.lower},
      {"upper", found(result, result.upper)},
      {"status", to_text(result.status)},
      {"point_a", found(result, to_json(witness.point_a))},
      {"point_b", found(result, to_json(witness.point_b))},
      {"triangle_a", found(result, witness.triangle_a)},
      {"triangle_b", found(result, witness.triangle_b)},
      {"face_a", nullptr},
      {"face_b", nullptr},
      {"build_us", timed.build_us},
      {"elapsed_us", timed.elapsed_us},
      {"stats", to_json(result.stats)},
  };
  if (result.status == Status::beyond_limit) return json;
  json["face_a"] = a.face_of_triangle[witness.triangle_a];
  json["face_b"] = b.face_of_triangle[witness.triangle_b];
  return json;
}

void write_lines(const TimedAnswer<DistanceResult>& timed, const MeshFile& a, const MeshFile& b) {
  const DistanceResult& result = timed.answer;
  const Witness witness = result.witness.value_or(Witness{});
  write_line("status    {}", to_text(result.status));
  write_line("lower     {}", to_text(result.lower));
  if (result.status != Status::beyond_limit) {
    write_line("upper     {}", to_text(result.upper));
    write_line("point a   {}", to_text(witness.point_a, " "));
    write_line("point b   {}", to_text(witness.point_b, " "));
    write_line("on a      triangle {}, face {}", witness.triangle_a, a.face_of_triangle[witness.triangle_a]);
    write_line("on b      triangle {}, face {}", witness.triangle_b, b.face_of_triangle[witness.triangle_b]);
  }
  write_line("tests     {} of nodes, {} of triangles", result.stats.node_tests, result.stats.triangle_tests);
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
  constexpr double largest = std::numeric_limits<double>::max();
  add_number(command, "--absolute-error", arguments->options.absolute_error, {0, largest, "a finite number >= 0"},
             "the answer may exceed the true distance by this length; either error will do");
  add_number(command, "--max-distance", arguments->options.max_distance,
             {0, std::numeric_limits<double>::infinity(), "a number >= 0"},
             "stop with beyond_limit when the models are farther apart than this");
  command.footer(
      "Lengths are in the meshes' unit, points in the world frame, times in microseconds. lower <= true distance <=\n"
      "upper; status is exact (lower = upper), within_error, collision (both 0), or beyond_limit (nothing as close as\n"
      "--max-distance: no upper, no points). Triangles count from 0 in the file's order after splitting larger faces "
      "into fans; faces are the file's own, counted from 0.");
  return {&command, [arguments] { run(*arguments); }};
}

}  // namespace limber::program
