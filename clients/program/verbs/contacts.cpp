// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "answers/answers.h"
#include "answers/contact_answers.h"
#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"
#include "limber/distance.h"

/// The verbs contacts and self: pairs of triangles of two models, or of one.
namespace limber::program {
namespace {

/// The options that `limber contacts` and `limber self` share: which pairs to find, and where to write them.
struct ContactArguments {
  std::optional<double> margin;
  bool intersections = false;
  std::optional<std::uint64_t> closest;
  std::string out;  // empty: no file
  std::optional<std::uint64_t> max_count;
  bool json = false;
  bool exit_code = false;
};

constexpr std::uint64_t table_rows_unless_told = 10;
constexpr std::uint64_t most_closest = 1'000'000;
constexpr std::size_t csv_chunk_bytes = std::size_t{1} << 16U;

/// Adds `count`, `intersecting` and `pairs`.
void append_contacts(Json& json, const FoundContacts& found) {
  json["count"] = found.count;
  json["intersecting"] = found.intersecting_count;
  Json& pairs = json["pairs"] = Json::array();
  for (const FoundContact& contact : found.first) pairs.push_back(to_json(contact, found.detail));
}

/// How many pairs there are.
void write_count_line(const FoundContacts& found) {
  if (found.detail == ContactDetail::ids) return write_line("pairs     {}", found.count);
  write_line("pairs     {}, {} of them at distance 0", found.count, found.intersecting_count);
}

/// At most `row_count` of the pairs, below a blank line and names of columns. Nothing where there is no row.
void write_table(const FoundContacts& found, std::size_t row_count) {
  row_count = std::min(row_count, found.first.size());
  if (row_count == 0) return;
  const char* const others = found.detail == ContactDetail::ids ? "" : "      distance         depth  features";
  write_line("\ntriangle a  triangle b{}{}", others, found.has_parts ? "; parts" : "");
  const auto name_of = [](const std::string* part) { return part != nullptr ? *part : "-"; };
  for (std::size_t i = 0; i < row_count; ++i) {
    const FoundContact& contact = found.first[i];
    const std::string parts = "; " + name_of(contact.part_a) + ", " + name_of(contact.part_b);
    const std::string more = found.detail == ContactDetail::ids
                                 ? ""
                                 : fmt::format("  {:>12.6g}  {:>12.6g}  {}, {}", contact.distance, contact.depth,
                                               to_text(contact.feature_a), to_text(contact.feature_b));
    write_line("{:>10}  {:>10}{}{}", contact.triangle_a, contact.triangle_b, more, found.has_parts ? parts : "");
  }
  if (row_count < found.count) write_line("and {} more", found.count - row_count);
}

void write_csv(OutputFile& out, const FoundContacts& found) {
  const std::string part;
  FoundContact sample;
  if (found.has_parts) sample.part_a = sample.part_b = &part;
  const AnswerColumns columns(to_json(sample, found.detail));
  std::string text = columns.header();
  for (const FoundContact& contact : found.first) {
    text += columns.line(to_json(contact, found.detail));
    if (text.size() < csv_chunk_bytes) continue;
    out.write_rows(text);
    text.clear();
  }
  out.write_rows(text);
}

/// Writes what a verb has found where its arguments say.
class ContactOutput {
 public:
  /// Opens the CSV file, if there is one. Errors: BadInput as OutputFile.
  explicit ContactOutput(const ContactArguments& arguments) : arguments_(arguments) {
    if (!arguments.out.empty()) out_.emplace("--out", arguments.out);
  }

  /// How many pairs are written at most.
  std::size_t room() const {
    const bool is_all = out_ || arguments_.json;
    return arguments_.max_count.value_or(is_all ? std::numeric_limits<std::size_t>::max() : table_rows_unless_told);
  }

  /// Writes the file, and an answer to standard output: the object that `json` makes, with the pairs; or what `lines`
  /// writes, and a table.
  void write(const FoundContacts& found, const auto& json, const auto& lines) {
    if (out_) write_csv(*out_, found);
    if (arguments_.out == "-") return;
    if (arguments_.json) return program::write(to_line(json()));
    lines();
    write_table(found, arguments_.max_count.value_or(table_rows_unless_told));
  }

 private:
  ContactArguments arguments_;
  std::optional<OutputFile> out_;
};

/// Adds `--margin`, `--intersections`, `--closest`, `--out`, `--max-count`, `--json`, and `--exit-code` with what it
/// tells.
void add_contact_arguments(CLI::App& command, ContactArguments& arguments, const std::string& told) {
  add_margin(command, arguments.margin, "all pairs at most that far apart; with 0 those that intersect");
  command.add_flag("--intersections", arguments.intersections,
                   "all pairs that intersect, by their ids alone: faster than --margin 0");
  add_count(command, "--closest", arguments.closest, {1, most_closest}, "the K closest pairs")->type_name("K");
  add_file(command, "--out", arguments.out, "FILE",
           "where a row for each pair is written, as CSV; - for standard output, which then has nothing else");
  add_count(command, "--max-count", arguments.max_count, {0, std::numeric_limits<std::uint32_t>::max()},
            "how many pairs are written at most; without it 10 as text, all as CSV or JSON");
  command.add_flag("--json", arguments.json, "answer with one JSON object");
  add_exit_code(command, arguments.exit_code, told);
}

/// To be called once everything is parsed: at most one of the first three options may be given, and standard output is
/// for one answer. Returns whether there is such a question.
bool check_contact_arguments(const CLI::App& command) {
  std::string question;
  for (const std::string name : {"--margin", "--intersections", "--closest"}) {
    if (command.get_option(name)->count() == 0) continue;
    if (!question.empty()) throw CLI::ValidationError(question, "leaves no room for " + name);
    question = name;
  }
  if (command.get_option("--json")->count() > 0 && command.get_option("--out")->count() > 0 &&
      command.get_option("--out")->as<std::string>() == "-") {
    throw CLI::ValidationError("--out", "leaves no room on standard output for --json");
  }
  return !question.empty();
}

/// The help about rows and columns.
std::string contact_rows_help() {
  return fmt::format(R"(The deepest pairs come first, then the nearest; ids decide where these are equal. distance is 0
exactly where the triangles intersect. depth is then how far b has to move at least for the two triangles to part, and
0 otherwise; it is no depth of the models, and vanishes as meshes are refined. The normal has length 1 and points from
a to b. normal_side is outward where it points out of a and into b, as the faces of closed meshes say;
inward where one triangle looks at the back of the other, so that the pair may lie inside a body; unknown where no mesh
is closed, or the faces do not tell. point_a and point_b are closest points, and one point where the triangles
intersect; lengths are in the meshes' unit. feature_a and feature_b are the parts of the triangles that
these points lie on: "vertex 0" to "vertex 2"; "edge 0" to "edge 2", where edge 0 goes from vertex 0 to vertex 1; or
"face". Triangles count from 0 in the file's order, after larger faces have been split into fans; face_a and face_b are
the file's own, counted from 0. Where a file has several parts, part_a and part_b come last and name theirs. Times are
in microseconds. Columns of CSV:

{}

With --intersections, {}. JSON has count, intersecting, which is the number of pairs at distance 0, and pairs, an array
of objects with the names of the columns; point_a, point_b and normal are arrays of three numbers.
)",
                     AnswerColumns(to_json(FoundContact(), ContactDetail::all)).help(),
                     AnswerColumns(to_json(FoundContact(), ContactDetail::ids)).help());
}

struct ContactsArguments {
  PlacedArguments models;
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
  const FoundContacts found = find(arguments.contacts, pair, output.room());
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

struct SelfArguments {
  std::string model;
  ContactArguments contacts;
};

ExitCode run(const SelfArguments& arguments) {
  const ContactArguments& asked = arguments.contacts;
  const RigidModel model(load_mesh_argument(arguments.model));
  ContactOutput output(asked);
  const Model& tree = model.model();
  const std::uint64_t triangle_count = tree.mesh().triangles().size();
  FoundContacts found = find(
      asked, output.room(), triangle_count * (triangle_count - 1) / 2,
      [&](std::span<Contact> closest) { return self_closest_pairs(tree, closest); },
      [&](double margin, ContactCollector& visit) { return visit_self_contacts(tree, margin, visit); },
      [&](ContactCollector& visit) { return visit_self_intersections(tree, visit); });
  set_faces(found, model, model);
  std::optional<DistanceResult> distance;  // the shortest one of triangles that are no neighbors
  if (!asked.margin && !asked.intersections && !asked.closest) {
    const Stopwatch asking;
    distance = self_distance(tree);
    found.elapsed_us = rounded_us(found.elapsed_us + asking.microseconds());
    found.stats += distance->stats;
  }
  const bool is_yes = found.intersecting_count > 0;
  const auto witness = with_faces(distance ? distance->witness : std::nullopt, model, model);
  const auto json = [&] {
    Json object = {{"query", "self"}, {"is_yes", is_yes}};
    object["margin"] = to_json(asked.margin);
    object["closest"] = to_json(asked.closest);
    object["distance"] = nullptr;
    if (distance) append_distance(object["distance"], *distance, witness);
    append_contacts(object, found);
    append_work(object, found.stats, model.build_us(), found.elapsed_us);
    return object;
  };
  output.write(found, json, [&] {
    write_line("collision {}", is_yes ? "yes" : "no");
    write_count_line(found);
    if (distance) write_distance_lines(*distance, witness);
    write_work_lines(found.stats, model.build_us(), found.elapsed_us);
  });
  return asked.exit_code && found.count > 0 ? ExitCode::found : ExitCode::answered;
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
