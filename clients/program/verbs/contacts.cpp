// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "answers/answers.h"
#include "answers/contact_answers.h"
#include "command/text.h"
#include "command/verb.h"
#include "limber/distance.h"

/// The verbs contacts and self: pairs of triangles of two models, or of one.
namespace limber::program {
namespace {

struct ContactsArguments {
  PlacedArguments models;
  bool regions = false;
  ContactArguments contacts;
};

/// Asks the one question of the arguments. `within_margin` takes a margin and a visitor, `meeting` a visitor alone.
FoundContacts find(const ContactArguments& arguments, std::size_t room, std::uint64_t pair_count, const auto& closest,
                   const auto& within_margin, const auto& meeting) {
  const ContactDetail detail = arguments.margin || arguments.closest ? ContactDetail::all : ContactDetail::ids;
  return collect_contacts(room, detail, [&](ContactCollector& visit) {
    if (arguments.margin) return within_margin(*arguments.margin, visit);
    if (!arguments.closest) return meeting(visit);
    std::vector<Contact> pairs(std::min(*arguments.closest, pair_count));
    const PairCount found = closest(std::span(pairs));
    for (std::size_t i = 0; i < found.count; ++i) visit(pairs[i]);
    return found;
  });
}

FoundContacts find(const ContactArguments& arguments, const Pair& pair, std::size_t room) {
  const Placed a = pair.a(), b = pair.b();
  const std::uint64_t pair_count =
      std::uint64_t{a.model().mesh().triangles().size()} * b.model().mesh().triangles().size();
  FoundContacts found = find(
      arguments, room, pair_count, [&](std::span<Contact> closest) { return closest_pairs(a, b, closest); },
      [&](double margin, ContactCollector& visit) { return visit_contacts(a, b, margin, visit); },
      [&](ContactCollector& visit) { return visit_intersections(a, b, visit); });
  set_faces(found, pair.a().model, pair.b().model);
  return found;
}

ExitCode run(const ContactsArguments& arguments) {
  const Pair pair(arguments.models);
  ContactOutput output(arguments.contacts);
  const std::size_t all = std::numeric_limits<std::size_t>::max();
  FoundContacts found = find(arguments.contacts, pair, arguments.regions ? all : output.room());
  if (arguments.regions) {
    find_regions(found, pair.a().model.mesh(), pair.b().model.mesh(), output.room());
  }
  const Nesting nesting = found.intersecting_count > 0 ? Nesting::none : nesting_of(pair.a(), pair.b());
  const auto json = [&] {
    Json answer = {{"query", "contacts"}};
    answer["margin"] = to_json(arguments.contacts.margin);
    answer["closest"] = to_json(arguments.contacts.closest);
    append_contacts(answer, found);
    answer["inside"] = to_json(nesting);
    append_work(answer, found.stats, pair.build_us(), found.elapsed_us);
    return answer;
  };
  output.write(found, json, [&] {
    write_count_line(found);
    write_work_lines(found.stats, pair.build_us(), found.elapsed_us);
  });
  warn_about(nesting, "contacts");
  return arguments.contacts.exit_code && found.count > 0 ? ExitCode::found : ExitCode::answered;
}

constexpr const char* contacts_help = R"(
One of --margin, --intersections and --closest says which pairs are asked for. The count is that of all of them, even
where fewer are written. With --closest it is less than K where there are fewer pairs; which of several equally close
ones are among the K is not defined. Whether triangles intersect is decided exactly, and touching is intersecting.
Points and normals are in the world frame.

--regions says which pairs are connected: two are neighbors if their triangles of A share a vertex, or are one, and
their triangles of B, too. A region is all that is reached from neighbor to neighbor, such as each place where a shaft
goes through a plate. The deepest comes first, then the nearest; regions count from 0. Pairs get a column region. JSON
has regions, an array of count, intersecting, distance, which is the least, depth, the largest, and low and high, a box
around the points of its pairs.

Models are surfaces, not solids: pairs of one wholly inside the other are those of their surfaces. Where a closed model
has the other inside, a warning says so, and the field inside in JSON.

)";

struct SelfArguments {
  std::string model;
  ContactArguments contacts;
};

struct SelfAnswer {
  FoundContacts found;
  std::optional<DistanceResult> distance;  ///< the shortest one of triangles that are no neighbors
  std::optional<FoundWitness> witness;
  QueryStats stats;
  double elapsed_us = 0;
};

SelfAnswer answer_to(const ContactArguments& arguments, const RigidModel& model, std::size_t room) {
  const Model& tree = model.model();
  const std::uint64_t triangle_count = tree.mesh().triangles().size();
  SelfAnswer answer;
  answer.found = find(
      arguments, room, triangle_count * (triangle_count - 1) / 2,
      [&](std::span<Contact> closest) { return self_closest_pairs(tree, closest); },
      [&](double margin, ContactCollector& visit) { return visit_self_contacts(tree, margin, visit); },
      [&](ContactCollector& visit) { return visit_self_intersections(tree, visit); });
  set_faces(answer.found, model, model);
  answer.stats = answer.found.stats;
  answer.elapsed_us = answer.found.elapsed_us;
  if (arguments.margin || arguments.intersections || arguments.closest) return answer;
  const Stopwatch asking;
  answer.distance = self_distance(tree);
  answer.elapsed_us = rounded_us(answer.elapsed_us + asking.microseconds());
  answer.witness = with_faces(answer.distance->witness, model, model);
  answer.stats += answer.distance->stats;
  return answer;
}

ExitCode run(const SelfArguments& arguments) {
  const RigidModel model(load_mesh_argument(arguments.model));
  ContactOutput output(arguments.contacts);
  const SelfAnswer answer = answer_to(arguments.contacts, model, output.room());
  const FoundContacts& found = answer.found;
  const bool is_yes = found.intersecting_count > 0;
  const auto json = [&] {
    Json object = {{"query", "self"}, {"is_yes", is_yes}};
    object["margin"] = to_json(arguments.contacts.margin);
    object["closest"] = to_json(arguments.contacts.closest);
    object["distance"] = nullptr;
    if (answer.distance) append_distance(object["distance"], *answer.distance, answer.witness);
    append_contacts(object, found);
    append_work(object, answer.stats, model.build_us(), answer.elapsed_us);
    return object;
  };
  output.write(found, json, [&] {
    write_line("collision {}", is_yes ? "yes" : "no");
    write_count_line(found);
    if (answer.distance) write_distance_lines(*answer.distance, answer.witness);
    write_work_lines(answer.stats, model.build_us(), answer.elapsed_us);
  });
  return arguments.contacts.exit_code && found.count > 0 ? ExitCode::found : ExitCode::answered;
}

constexpr const char* self_help = R"(
Without --margin, --intersections and --closest the answer is whether the model meets itself, in JSON is_yes, in which
pairs of triangles, and the shortest distance of two triangles that are no neighbors: status, lower, upper and witness
as limber distance tells them, in JSON an object distance. Where all triangles are neighbors, status is beyond_limit.
With --closest the count is less than K where there are fewer pairs; which of several equally close ones are among the K
is not defined.

Triangles that share a vertex are neighbors. They meet only if they have a point in common beyond what they share: the
vertex, the edge between two, or all of a triangle of the same three. That is decided exactly; otherwise such a pair
does not count, however large the margin. In files, vertices at equal positions are one, and so are shared. Each pair
comes once, with triangle_a < triangle_b. Points and normals are in the model's own frame.

)";

}  // namespace

Verb add_contacts(CLI::App& app) {
  const auto arguments = std::make_shared<ContactsArguments>();
  CLI::App& command = *app.add_subcommand("contacts", "Pairs of triangles of two models that intersect or are close");
  add_placed_arguments(command, arguments->models);
  add_contact_arguments(command, arguments->contacts, "there is such a pair");
  command.add_flag("--regions", arguments->regions, "with --margin: which pairs belong together")
      ->needs(command.get_option("--margin"));
  command.parse_complete_callback([&command] {
    if (check_contact_arguments(command)) return;
    throw CLI::RequiredError("--margin, --intersections or --closest");
  });
  command.footer(contacts_help + contact_rows_help());
  return {&command, [arguments] { return run(*arguments); }};
}

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
