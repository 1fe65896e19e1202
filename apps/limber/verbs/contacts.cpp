// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <memory>
#include <span>

#include "command/contact_arguments.h"
#include "command/pair_arguments.h"
#include "command/text.h"
#include "command/verb.h"
#include "verbs/answers.h"
#include "verbs/contact_answers.h"

namespace limber::program {
namespace {

struct ContactsArguments {
  PlacedArguments models;
  ContactArguments contacts;
};

FoundContacts find(const ContactsArguments& arguments, const Pair& pair, std::size_t room) {
  const Placed a{pair.a().model.fast(), pair.a().pose}, b{pair.b().model.fast(), pair.b().pose};
  const ContactDetail detail = arguments.contacts.intersections ? ContactDetail::ids : ContactDetail::all;
  FoundContacts found = collect_contacts(room, detail, [&](ContactCollector& visit) {
    if (arguments.contacts.closest) {
      const std::uint64_t pair_count =
          std::uint64_t{a.model().mesh().triangles().size()} * b.model().mesh().triangles().size();
      const auto ask = [&](std::span<Contact> closest) { return closest_pairs(a, b, closest); };
      return visit_closest(*arguments.contacts.closest, pair_count, ask, visit);
    }
    if (arguments.contacts.margin) return visit_contacts(a, b, *arguments.contacts.margin, visit);
    return visit_intersections(a, b, visit);
  });
  set_faces(found, pair.a().model, pair.b().model);
  return found;
}

ExitCode run(const ContactsArguments& arguments) {
  const Pair pair(arguments.models);
  ContactOutput output(arguments.contacts, {arguments.models.a, arguments.models.b});
  const FoundContacts found = find(arguments, pair, output.room());
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

Models are surfaces, not solids: pairs of one wholly inside the other are those of their surfaces. Where a closed model
has the other inside, a warning says so, and the field inside in JSON.

)";

}  // namespace

Verb add_contacts(CLI::App& app) {
  const auto arguments = std::make_shared<ContactsArguments>();
  CLI::App& command = *app.add_subcommand("contacts", "Pairs of triangles of two models that intersect or are close");
  add_placed_arguments(command, arguments->models);
  add_contact_arguments(command, arguments->contacts, "there is such a pair");
  command.parse_complete_callback([&command] {
    if (check_contact_arguments(command)) return;
    throw CLI::RequiredError("--margin, --intersections or --closest");
  });
  command.footer(contacts_help + contact_rows_help());
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program
