// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <oneapi/tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include "command/options.h"
#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"
#include "limber/base.h"
#include "verbs/bench_run.h"
#include "verbs/models.h"

namespace limber::program {
namespace {

struct BenchArguments {
  std::string a, b, out;
  BenchOptions options;
  std::uint64_t threads = 1;
  bool json = false;
};

/// The processor's name, family and model. Virtual machines leave the model number out of the name.
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  std::string name, parts, line;
  while (std::getline(file, line) && !line.empty()) {
    const auto fields = fields_of(line, ':');
    if (fields.size() < 2) continue;
    if (fields[0] == "model name") name = fields[1];
    if (fields[0] == "cpu family") parts = fmt::format(", family {}", fields[1]);
    if (fields[0] == "model") parts += fmt::format(", model {}", fields[1]);
  }
  const char* const of_windows = std::getenv("PROCESSOR_IDENTIFIER");
  return !name.empty() ? name + parts : of_windows != nullptr ? of_windows : "unknown";
}

Json json_of(const BenchArguments& arguments, const RigidModel& a, const RigidModel* b, const BenchTable& table) {
  const auto of_model = [](const std::string& name, const RigidModel& model) {
    return Json{{"model", name}, {"triangles", model.mesh().triangles().size()}};
  };
  Json json = {{"query", "bench"},
               {"version", LIMBER_VERSION},
               {"processor", processor_name()},
               {"instruction_set", instruction_set()},
               {"threads", arguments.threads},
               {"seed", arguments.options.seed},
               {"a", of_model(arguments.a, a)},
               {"b", b != nullptr ? of_model(arguments.b, *b) : Json(nullptr)},
               {"size", table.size}};
#ifdef LIMBER_CHECKS
  json["checks"] = true;
#else
  json["checks"] = false;
#endif
  for (const BenchRow& row : table.rows) {
    json["rows"].push_back({{"question", row.question},
                            {"situation", row.situation},
                            {"poses", row.poses},
                            {"least_us", row.least_us},
                            {"median_us", row.median_us}});
  }
  return json;
}

void write_table(const Json& json) {
  write_line("limber     {}{}", json["version"].get<std::string>(),
             json["checks"] == true ? ", with checks on, so times are much longer than in a release build" : "");
  write_line("processor  {}", json["processor"].get<std::string>());
  write_line("SIMD       {}", json["instruction_set"].get<std::string>());
  write_line("threads    {}", json["threads"].get<std::uint64_t>());
  for (const char* const name : {"a", "b"}) {
    if (json[name].is_null()) continue;
    write_line("{}          {}, {} triangles", name == std::string("a") ? 'A' : 'B',
               json[name]["model"].get<std::string>(), grouped(json[name]["triangles"].get<std::uint64_t>()));
  }
  write_line("size       {}", to_text(json["size"].get<double>()));
  write_line("seed       {}\n", json["seed"].get<std::uint64_t>());
  write_line("{:<27}{:<18}{:>5}{:>12}{:>12}", "question", "situation", "poses", "least us", "median us");
  for (const Json& row : json["rows"]) {
    write_line("{:<27}{:<18}{:>5}{:>12}{:>12}", row["question"].get<std::string>(), row["situation"].get<std::string>(),
               row["poses"].get<std::size_t>(), to_text(row["least_us"].get<double>()),
               to_text(row["median_us"].get<double>()));
  }
}

ExitCode run(const BenchArguments& arguments) {
  using oneapi::tbb::global_control;
  const global_control threads(global_control::max_allowed_parallelism, arguments.threads);
  const RigidModel a(load_mesh_argument(arguments.a), Engine::fast);
  std::optional<RigidModel> b;
  if (!arguments.b.empty()) b.emplace(load_mesh_argument(arguments.b), Engine::fast);
  std::optional<OutputFile> out;
  if (!arguments.out.empty()) out.emplace("--out", arguments.out);
  const Json json =
      json_of(arguments, a, b ? &*b : nullptr, run_bench(a.fast(), (b ? *b : a).fast(), arguments.options));
  if (out) {
    std::string text = "question,situation,poses,least_us,median_us\n";
    for (const Json& row : json["rows"]) text += csv_line(row);
    out->write(text);
  }
  if (arguments.out != "-") arguments.json ? write(to_line(json)) : write_table(json);
  return ExitCode::answered;
}

constexpr const char* bench_help = R"(
For each pose B is turned at random and slid along a line through both centers, to gaps of 1, 0.05 and 0.001 of the
size, and until it overlaps; a gap that this line does not have is left out. The size is the larger diagonal of both
boxes. within and contacts have a limit of 0.002 of it. The closest point is that of a vertex of B. A path is 20 small
steps from a gap of 0.05; its cache is empty at first. Without B, A is asked about itself.

A refit moves vertices by a few hundredths of the model's own size, and commits: all, or the hundredth of them around
one. Self-contacts have a limit of 0.001 of that size. --threads is about builds and refits; all else takes one thread.

Times are in microseconds for one query. A pose has the median of up to 5 rounds, a row least and median of its poses.
Answers are compared first: with a cache and without, collisions, intervals, limits, contacts and closest points with
exact distances, refitted with new trees. If two disagree, the exit status is 1, and the error names the pose.

Half of --time is for drawing poses and comparing answers: no pose is begun that would not end within it, if it took as
long as those before. No question is asked once the time is spent, but for this: one pose is drawn, its answers are
compared, and each of its questions is asked once, however long that takes. Reading files and building their trees comes
before the time.
)";

}  // namespace

Verb add_bench(CLI::App& app) {
  const auto arguments = std::make_shared<BenchArguments>();
  BenchOptions& options = arguments->options;
  CLI::App& command = *app.add_subcommand("bench", "What queries and updates of your models take on your machine");
  command.add_option("A", arguments->a, model_argument_help)->type_name("MODEL")->required();
  command.add_option("B", arguments->b, "as A, in the same length unit")->type_name("MODEL");
  add_count(command, "--seed", options.seed, {}, "which poses are drawn");
  add_count(command, "--poses", options.poses, {1, 1000}, "how many are drawn at each gap, at most");
  add_number(command, "--time", options.seconds, {0, 86'400, "a number from 0 to 86400"},
             "how long to draw poses and measure; one pose is measured once in any case")
      ->type_name("SECONDS");
  add_count(command, "--threads", arguments->threads, {1, 1024}, "for builds and refits");
  add_json(command, arguments->json, "answer with one JSON object");
  add_table(command, arguments->out, "where the rows are written");
  command.parse_complete_callback([&command] { check_table(command); });
  command.footer(bench_help);
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program
