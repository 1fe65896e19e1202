// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/contact_answers.h"

#include <algorithm>

#include "command/text.h"

namespace limber::program {
namespace {

std::string table_row(const FoundContact& contact, ContactDetail detail) {
  std::string row = fmt::format("{:>10}  {:>10}", contact.triangle_a, contact.triangle_b);
  if (detail == ContactDetail::ids) return row;
  return row + fmt::format("  {:>12.6g}  {:>12.6g}  {}, {}", contact.distance, contact.depth,
                           to_text(contact.feature_a), to_text(contact.feature_b));
}

}  // namespace

std::string to_text(Feature feature) {
  switch (feature.kind) {
    case FeatureKind::vertex:
      return fmt::format("vertex {}", feature.index);
    case FeatureKind::edge:
      return fmt::format("edge {}", feature.index);
    case FeatureKind::face:
      return "face";
  }
  throw std::logic_error("a feature is of no known kind");
}

std::string to_text(NormalSide side) {
  switch (side) {
    case NormalSide::unknown:
      return "unknown";
    case NormalSide::outward:
      return "outward";
    case NormalSide::inward:
      return "inward";
  }
  throw std::logic_error("a normal is of no known side");
}

Json to_json(const FoundContact& contact, ContactDetail detail) {
  Json json = {{"triangle_a", contact.triangle_a}, {"triangle_b", contact.triangle_b}};
  if (detail == ContactDetail::all) {
    json["distance"] = contact.distance;
    json["depth"] = contact.depth;
    json["point_a"] = to_json(contact.point_a);
    json["point_b"] = to_json(contact.point_b);
    json["normal"] = to_json(contact.normal);
    json["normal_side"] = to_text(contact.normal_side);
    json["feature_a"] = to_text(contact.feature_a);
    json["feature_b"] = to_text(contact.feature_b);
  }
  json["face_a"] = contact.face_a;
  json["face_b"] = contact.face_b;
  return json;
}

std::string csv_cells(const FoundContact& contact, ContactDetail detail) {
  std::string cells = fmt::format("{},{},", contact.triangle_a, contact.triangle_b);
  if (detail == ContactDetail::all) {
    cells += fmt::format("{},{},{},{},{},{},{},{},", contact.distance, contact.depth, to_text(contact.point_a, ","),
                         to_text(contact.point_b, ","), to_text(contact.normal, ","), to_text(contact.normal_side),
                         to_text(contact.feature_a), to_text(contact.feature_b));
  }
  return cells + fmt::format("{},{}", contact.face_a, contact.face_b);
}

std::string contact_columns(ContactDetail detail) {
  if (detail == ContactDetail::ids) return "triangle_a,triangle_b,face_a,face_b";
  return "triangle_a,triangle_b,distance,depth,point_a_x,point_a_y,point_a_z,point_b_x,point_b_y,point_b_z,"
         "normal_x,normal_y,normal_z,normal_side,feature_a,feature_b,face_a,face_b";
}

void append_contacts(Json& json, const FoundContacts& found) {
  json["count"] = found.count;
  json["intersecting"] = found.intersecting_count;
  Json& pairs = json["pairs"] = Json::array();
  for (const FoundContact& contact : found.first) pairs.push_back(to_json(contact, found.detail));
}

void write_count_line(const FoundContacts& found) {
  if (found.detail == ContactDetail::ids) return write_line("pairs     {}", found.count);
  write_line("pairs     {}, {} of them at distance 0", found.count, found.intersecting_count);
}

void write_table(const FoundContacts& found, std::size_t row_count) {
  row_count = std::min(row_count, found.first.size());
  if (row_count == 0) return;
  const char* const others = found.detail == ContactDetail::ids ? "" : "      distance         depth  features";
  write_line("\ntriangle a  triangle b{}", others);
  for (std::size_t i = 0; i < row_count; ++i) write_line("{}", table_row(found.first[i], found.detail));
  if (row_count < found.count) write_line("and {} more", found.count - row_count);
}

}  // namespace limber::program
