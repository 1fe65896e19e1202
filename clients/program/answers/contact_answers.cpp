// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/contact_answers.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <utility>

#include "command/options.h"
#include "command/text.h"

namespace limber::program {
namespace {

/// The deepest first, then the nearest; ids decide where these are equal, so that the order is that of no traversal.
bool is_before(const Contact& a, const Contact& b) {
  return std::tie(b.depth, a.distance, a.triangle_a, a.triangle_b) <
         std::tie(a.depth, b.distance, b.triangle_a, b.triangle_b);
}

constexpr std::uint64_t table_rows_unless_told = 10;
constexpr std::uint64_t most_closest = 1'000'000;
constexpr std::size_t csv_chunk_bytes = std::size_t{1} << 16U;

Json json_of_region(const ContactRegion& region) {
  return {{"count", region.count},       {"intersecting", region.intersecting_count},
          {"distance", region.distance}, {"depth", region.depth},
          {"low", to_json(region.low)},  {"high", program::to_json(region.high)}};
}

/// As NormalSide, whose first value is unknown.
constexpr std::array normal_side_words = {"unknown", "outward", "inward"};

std::string table_row(const FoundContact& contact, ContactDetail detail) {
  std::string row = fmt::format("{:>10}  {:>10}", contact.triangle_a, contact.triangle_b);
  if (detail == ContactDetail::ids) return row;
  return row + fmt::format("  {:>12.6g}  {:>12.6g}  {}, {}", contact.distance, contact.depth,
                           to_text(contact.feature_a), to_text(contact.feature_b));
}

}  // namespace

bool ContactCollector::operator()(const Contact& contact) {
  ++found_.count;
  if (contact.distance == 0) ++found_.intersecting_count;
  std::vector<FoundContact>& first = found_.first;
  if (first.size() == room_) {
    if (room_ == 0 || !is_before(contact, first.front())) return true;
    std::pop_heap(first.begin(), first.end(), is_before);
    first.pop_back();
  }
  first.push_back({contact});
  std::push_heap(first.begin(), first.end(), is_before);
  return true;
}

bool ContactCollector::operator()(const TrianglePair& pair) {
  Contact contact;
  contact.triangle_a = pair.a;
  contact.triangle_b = pair.b;
  return (*this)(contact);
}

FoundContacts ContactCollector::take() {
  std::sort_heap(found_.first.begin(), found_.first.end(), is_before);
  return std::exchange(found_, {});
}

FoundContacts collect_contacts(std::size_t room, ContactDetail detail,
                               const std::function<PairCount(ContactCollector&)>& query) {
  ContactCollector collector(room);
  const Stopwatch asking;
  const PairCount counted = query(collector);
  const double elapsed_us = asking.microseconds();
  FoundContacts found = collector.take();
  found.detail = detail;
  found.stats = counted.stats;
  found.elapsed_us = elapsed_us;
  return found;
}

std::string to_text(Feature feature) {
  if (feature.kind == FeatureKind::face) return "face";
  return fmt::format("{} {}", feature.kind == FeatureKind::vertex ? "vertex" : "edge", feature.index);
}

Json to_json(const FoundContact& contact, ContactDetail detail) {
  Json json = {{"triangle_a", contact.triangle_a}, {"triangle_b", contact.triangle_b}};
  if (detail == ContactDetail::all) {
    json["distance"] = contact.distance;
    json["depth"] = contact.depth;
    json["point_a"] = to_json(contact.point_a);
    json["point_b"] = to_json(contact.point_b);
    json["normal"] = to_json(contact.normal);
    json["normal_side"] = normal_side_words.at(static_cast<std::size_t>(contact.normal_side));
    json["feature_a"] = to_text(contact.feature_a);
    json["feature_b"] = to_text(contact.feature_b);
  }
  json["face_a"] = contact.face_a;
  json["face_b"] = contact.face_b;
  if (contact.region) json["region"] = *contact.region;
  append_parts(json, contact.part_a, contact.part_b);
  return json;
}

void find_regions(FoundContacts& found, MeshView a, MeshView b, std::size_t room) {
  ContactRegions regions = regions_of({found.first.begin(), found.first.end()}, a, b);
  for (std::size_t i = 0; i < found.first.size(); ++i) found.first[i].region = regions.region_of[i];
  found.regions = std::move(regions.regions);
  found.first.resize(std::min(room, found.first.size()));
}

void append_contacts(Json& json, const FoundContacts& found) {
  json["count"] = found.count;
  json["intersecting"] = found.intersecting_count;
  if (found.regions) {
    Json& regions = json["regions"] = Json::array();
    for (const ContactRegion& region : *found.regions) regions.push_back(json_of_region(region));
  }
  Json& pairs = json["pairs"] = Json::array();
  for (const FoundContact& contact : found.first) pairs.push_back(to_json(contact, found.detail));
}

void write_count_line(const FoundContacts& found) {
  if (found.detail == ContactDetail::ids) return write_line("pairs     {}", found.count);
  write_line("pairs     {}, {} of them at distance 0", found.count, found.intersecting_count);
  if (!found.regions) return;
  write_line("regions   {}", found.regions->size());
  for (std::size_t r = 0; r < std::min<std::size_t>(table_rows_unless_told, found.regions->size()); ++r) {
    const ContactRegion& region = (*found.regions)[r];
    write_line("region {}  {} pairs, distance {:.6g}, depth {:.6g}, from {} to {}", r, region.count, region.distance,
               region.depth, to_text(region.low, " "), to_text(region.high, " "));
  }
}

void write_table(const FoundContacts& found, std::size_t row_count) {
  row_count = std::min(row_count, found.first.size());
  if (row_count == 0) return;
  const char* const others = found.detail == ContactDetail::ids ? "" : "      distance         depth  features";
  write_line("\ntriangle a  triangle b{}{}", others, found.has_parts ? "; parts" : "");
  const auto name_of = [](const std::string* part) { return part != nullptr ? *part : "-"; };
  for (std::size_t i = 0; i < row_count; ++i) {
    const FoundContact& contact = found.first[i];
    const std::string parts = "; " + name_of(contact.part_a) + ", " + name_of(contact.part_b);
    write_line("{}{}", table_row(contact, found.detail), found.has_parts ? parts : "");
  }
  if (row_count < found.count) write_line("and {} more", found.count - row_count);
}

void add_margin(CLI::App& command, std::optional<double>& target, const std::string& description) {
  add_number(command, "--margin", target, not_negative, description)->type_name("LENGTH");
}

void add_contact_arguments(CLI::App& command, ContactArguments& arguments, const std::string& told) {
  add_margin(command, arguments.margin, "all pairs at most that far apart; with 0 those that intersect");
  command.add_flag("--intersections", arguments.intersections,
                   "all pairs that intersect, by their ids alone: faster than --margin 0");
  add_count(command, "--closest", arguments.closest, {1, most_closest}, "the K closest pairs")->type_name("K");
  add_file(command, "--out", arguments.out, "FILE",
           "where a row for each pair is written, as CSV; - for standard output, which then has nothing else");
  add_count(command, "--max-count", arguments.max_count, {0, std::numeric_limits<std::uint32_t>::max()},
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
  if (command.get_option("--json")->count() > 0 && command.get_option("--out")->count() > 0 &&
      command.get_option("--out")->as<std::string>() == "-") {
    throw CLI::ValidationError("--out", "leaves no room on standard output for --json");
  }
  return !question.empty();
}

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

ContactOutput::ContactOutput(const ContactArguments& arguments) : arguments_(arguments) {
  if (!arguments.out.empty()) out_.emplace("--out", arguments.out);
}

std::size_t ContactOutput::table_rows() const { return arguments_.max_count.value_or(table_rows_unless_told); }

std::size_t ContactOutput::room() const {
  const bool is_all = out_ || arguments_.json;
  return is_all ? arguments_.max_count.value_or(std::numeric_limits<std::size_t>::max()) : table_rows();
}

void ContactOutput::write(const FoundContacts& found, const std::function<Json()>& json,
                          const std::function<void()>& lines) {
  if (out_) write_csv(found);
  if (arguments_.out == "-") return;
  if (arguments_.json) return program::write(to_line(json()));
  lines();
  write_table(found, table_rows());
}

void ContactOutput::write_csv(const FoundContacts& found) {
  const std::string part;
  FoundContact sample;
  if (found.regions) sample.region = 0;
  if (found.has_parts) sample.part_a = sample.part_b = &part;
  const AnswerColumns columns(to_json(sample, found.detail));
  std::string text = columns.header();
  for (const FoundContact& contact : found.first) {
    text += columns.line(to_json(contact, found.detail));
    if (text.size() < csv_chunk_bytes) continue;
    out_->write_rows(text);
    text.clear();
  }
  out_->write_rows(text);
}

}  // namespace limber::program
