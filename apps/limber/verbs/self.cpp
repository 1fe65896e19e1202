// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <span>

#include "command/contact_arguments.h"
#include "command/text.h"
#include "command/verb.h"
#include "limber/distance.h"
#include "verbs/answers.h"
#include "verbs/contact_answers.h"

namespace limber::program {
namespace {

struct SelfArguments {
  std::string model;
  ContactArguments contacts;
};

/// The shortest distance of triangles that are no neighbors.
struct SelfDistance {
  DistanceResult result;
  std::optional<FoundWitness> witness;
};

/// Where no pairs are asked for, what intersects, and how far apart the rest is.
bool is_overview(const ContactArguments& arguments) {
  return !arguments.margin && !arguments.intersections && !arguments.closest;
}

struct SelfAnswer {
  FoundContacts found;
  std::optional<SelfDistance> distance;
  QueryStats stats;
  double elapsed_us = 0;
};

SelfAnswer ask(const RigidModel& model, const ContactArguments& arguments, std::size_t room) {
  const ContactDetail detail = arguments.margin || arguments.closest ? ContactDetail::all : ContactDetail::ids;
  SelfAnswer answer;
  answer.found = collect_contacts(room, detail, [&](ContactCollector& visit) {
    if (arguments.closest) {
      const std::uint64_t triangle_count = model.fast().mesh().triangles().size();
      const auto closest_pairs = [&](std::span<Contact> closest) { return self_closest_pairs(model.fast(), closest); };
      return visit_closest(*arguments.closest, triangle_count * (triangle_count - 1) / 2, closest_pairs, visit);
    }
    if (arguments.margin) return visit_self_contacts(model.fast(), *arguments.margin, visit);
    return visit_self_intersections(model.fast(), visit);
  });
  set_faces(answer.found, model, model);
  answer.stats = answer.found.stats;
  answer.elapsed_us = answer.found.elapsed_us;
  if (!is_overview(arguments)) return answer;
  const Stopwatch asking;
  const DistanceResult result = self_distance(model.fast());
  answer.elapsed_us = rounded_us(answer.elapsed_us + asking.microseconds());
  answer.distance = {result, with_faces(result.witness, model, model)};
  answer.stats.node_tests += result.stats.node_tests;
  answer.stats.triangle_tests += result.stats.triangle_tests;
  return answer;
}

ExitCode run(const SelfArguments& arguments) {
  const RigidModel model(load_mesh_argument(arguments.model), Engine::fast);
  ContactOutput output(arguments.contacts, {arguments.model});
  const SelfAnswer answer = ask(model, arguments.contacts, output.room());
  const FoundContacts& found = answer.found;
  const bool meets_itself = found.intersecting_count > 0;
  const auto json = [&] {
    Json object = {{"query", "self"}, {"meets_itself", meets_itself}};
    object["margin"] = to_json(arguments.contacts.margin);
    object["closest"] = to_json(arguments.contacts.closest);
    object["distance"] = nullptr;
    if (answer.distance) append_distance(object["distance"], answer.distance->result, answer.distance->witness);
    append_contacts(object, found);
    append_work(object, answer.stats, model.build_us(), answer.elapsed_us);
    return object;
  };
  output.write(found, json, [&] {
    write_line("meets     {}", meets_itself ? "yes" : "no");
    write_count_line(found);
    if (answer.distance) write_distance_lines(answer.distance->result, answer.distance->witness);
    write_work_lines(answer.stats, model.build_us(), answer.elapsed_us);
  });
  return arguments.contacts.exit_code && found.count > 0 ? ExitCode::found : ExitCode::answered;
}

constexpr const char* self_help = R"(
Without --margin, --intersections and --closest the answer is whether the model meets itself, in which pairs of
triangles, and the shortest distance of two triangles that are no neighbors: status, lower, upper and witness as limber
distance tells them, in JSON an object distance. Where all triangles are neighbors, status is beyond_limit. With
--closest the count is less than K where there are fewer pairs; which of several equally close ones are among the K is
not defined.

Triangles that share a vertex are neighbors. They meet only if they have a point in common beyond what they share: the
vertex, the edge between two, or all of a triangle of the same three. That is decided exactly; otherwise such a pair
does not count, however large the margin. In files, vertices at equal positions are one, and so are shared. Each pair
comes once, with triangle_a < triangle_b. Points and normals are in the model's own frame.

)";

}  // namespace

Verb add_self(CLI::App& app) {
  const auto arguments = std::make_shared<SelfArguments>();
  CLI::App& command = *app.add_subcommand("self", "Whether and where a model meets itself, or comes close to itself");
  command.add_option("M", arguments->model, model_argument_help)->type_name("MODEL")->required();
  add_contact_arguments(command, arguments->contacts,
                        "the model meets itself or, with --margin or --closest, there is such a pair");
  command.parse_complete_callback([&command] { check_contact_arguments(command); });
  command.footer(self_help + contact_rows_help());
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program
