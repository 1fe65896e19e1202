// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/contact_arguments.h"

#include <algorithm>
#include <limits>

#include "command/bad_input.h"
#include "command/options.h"
#include "command/text.h"
#include "verbs/contact_answers.h"

namespace limber::program {
namespace {

constexpr std::uint64_t table_rows_unless_told = 10;
constexpr std::uint64_t most_closest = 1'000'000;
constexpr std::size_t csv_chunk_bytes = std::size_t{1} << 16U;

}  // namespace

void add_margin(CLI::App& command, std::optional<double>& target, const std::string& description) {
  add_optional_number(command, "--margin", target, {0, std::numeric_limits<double>::max(), "a finite number >= 0"},
                      description)
      ->type_name("LENGTH");
}

void add_contact_arguments(CLI::App& command, ContactArguments& arguments, const std::string& told) {
  add_margin(command, arguments.margin, "all pairs at most that far apart; with 0 those that intersect");
  command.add_flag("--intersections", arguments.intersections,
                   "all pairs that intersect, by their ids alone: faster than --margin 0");
  add_optional_count(command, "--closest", arguments.closest, 1, most_closest, "the K closest pairs")->type_name("K");
  command
      .add_option("--csv", arguments.csv,
                  "where a row for each pair is written; - for standard output, which then has nothing else")
      ->type_name("FILE");
  add_optional_count(command, "--limit", arguments.limit, 0, std::numeric_limits<std::uint32_t>::max(),
                     "how many pairs are written at most; without it 10 as text, all as CSV or JSON");
  add_json(command, arguments.json, "answer with one JSON object");
  add_exit_code(command, arguments.exit_code, told);
}

bool check_contact_arguments(const CLI::App& command) {
  std::string question;
  for (const std::string name : {"--margin", "--intersections", "--closest"}) {
    if (command.get_option(name)->count() == 0) continue;
    if (!question.empty()) throw CLI::ValidationError(question, "leaves no room for " + name);
    question = name;
  }
  const CLI::Option& csv = *command.get_option("--csv");
  if (csv.count() > 0 && csv.as<std::string>() == "-" && command.get_option("--json")->count() > 0) {
    throw CLI::ValidationError("--csv", "leaves no room on standard output for --json");
  }
  return !question.empty();
}

std::string contact_rows_help() {
  const auto spaced = [](const std::string& columns) {
    return fmt::format("{}", fmt::join(fields_of(columns, ','), ", "));
  };
  return fmt::format(R"(The deepest pairs come first, then the nearest; ids decide where these are equal. distance is 0
exactly where the triangles intersect. depth is then how far b has to move at least for the two triangles to part, and
0 otherwise; it is no depth of the models, and vanishes as meshes are refined. The normal has length 1 and points from
a to b. normal_side is outward where it points out of a and into b, as the faces of closed meshes say;
inward where one triangle looks at the back of the other, so that the pair may lie inside a body; unknown where no mesh
is closed, or the faces do not tell. point_a and point_b are closest points, and one point where the triangles
intersect; lengths are in the meshes' unit. feature_a and feature_b are the parts of the triangles that
these points lie on: "vertex 0" to "vertex 2"; "edge 0" to "edge 2", where edge 0 goes from vertex 0 to vertex 1; or
"face". Triangles count from 0 in the file's order, after larger faces have been split into fans; face_a and face_b are
the file's own, counted from 0. Times are in microseconds. Columns of CSV:

{}

With --intersections, {}. JSON has count, intersecting, which is the number of pairs at distance 0, and pairs, an array
of objects with the names of the columns; point_a, point_b and normal are arrays of three numbers.
)",
                     spaced(contact_columns(ContactDetail::all)), spaced(contact_columns(ContactDetail::ids)));
}

ContactOutput::ContactOutput(const ContactArguments& arguments, const Names& inputs) : arguments_(arguments) {
  if (!arguments.csv.empty()) csv_.emplace("--csv", arguments.csv, inputs, Names{standard_output});
}

std::size_t ContactOutput::table_rows() const { return arguments_.limit.value_or(table_rows_unless_told); }

std::size_t ContactOutput::room() const {
  const bool is_all = csv_ || arguments_.json;
  return is_all ? arguments_.limit.value_or(std::numeric_limits<std::size_t>::max()) : table_rows();
}

void ContactOutput::write(const FoundContacts& found, const std::function<Json()>& json,
                          const std::function<void()>& lines) {
  if (csv_) write_csv(found);
  if (arguments_.csv == "-") return;
  if (arguments_.json) return program::write(to_line(json()));
  lines();
  write_table(found, table_rows());
}

void ContactOutput::write_csv(const FoundContacts& found) {
  std::string text = contact_columns(found.detail) + '\n';
  for (const FoundContact& contact : found.first) {
    text += csv_cells(contact, found.detail) + '\n';
    if (text.size() < csv_chunk_bytes) continue;
    csv_->write(text);
    text.clear();
  }
  csv_->write(text);
}

}  // namespace limber::program
