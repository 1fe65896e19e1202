// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/track_contacts.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "command/bad_input.h"
#include "command/contact_arguments.h"
#include "command/text.h"
#include "verbs/contact_answers.h"

namespace limber::program {

void add_track_contacts(CLI::App& command, TrackContactArguments& arguments) {
  command.add_flag("--contacts", arguments.contacts,
                   "fast: also count the pairs of triangles of the two models that intersect or are close");
  command.add_flag("--self", arguments.self,
                   "fast: also count the pairs of triangles of each deforming model with itself");
  add_margin(command, arguments.margin,
             "with --contacts and --self: how far apart pairs are at most; without it they have to intersect");
}

void check_track_contacts(const TrackContactArguments& arguments, DeformingEngine engine) {
  if (!arguments.contacts && !arguments.self) {
    if (arguments.margin) throw BadInput("--margin: belongs to --contacts and --self");
    return;
  }
  if (engine == DeformingEngine::fast) return;
  throw BadInput(fmt::format("{}: belongs to --engine fast", arguments.contacts ? "--contacts" : "--self"));
}

std::string frame_contact_columns(const std::string& name) {
  std::string columns = fmt::format("{0}_us,{0}_count,{0}_intersecting", name);
  const std::string of_pair = contact_columns(ContactDetail::all);
  for (const std::string_view column : fields_of(of_pair, ',')) columns += fmt::format(",{}_{}", name, column);
  return columns;
}

std::string csv_cells(const FrameContacts& contacts) {
  const FoundContacts& found = contacts.found;
  const std::string columns = contact_columns(found.detail);
  const auto commas = static_cast<std::size_t>(std::count(columns.begin(), columns.end(), ','));
  const std::string first =
      found.first.empty() ? std::string(commas, ',') : csv_cells(found.first.front(), found.detail);
  return fmt::format("{},{},{},{}", to_text(found.elapsed_us), found.count, found.intersecting_count, first);
}

void append_contacts(Json& json, const FrameContacts& contacts) {
  const FoundContacts& found = contacts.found;
  json[contacts.name] = {{"query_us", found.elapsed_us},
                         {"count", found.count},
                         {"intersecting", found.intersecting_count},
                         {"pair", found.first.empty() ? Json(nullptr) : to_json(found.first.front(), found.detail)}};
}

}  // namespace limber::program
