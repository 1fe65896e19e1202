// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/contact_answers.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "command/text.h"
#include "command/verb.h"

namespace limber::program {
namespace {

/// The deepest first, then the nearest; ids decide where these are equal, so that the order is that of no traversal.
bool is_before(const Contact& a, const Contact& b) {
  return std::tie(b.depth, a.distance, a.triangle_a, a.triangle_b) <
         std::tie(a.depth, b.distance, b.triangle_a, b.triangle_b);
}

/// As NormalSide, whose first value is unknown.
constexpr std::array normal_side_words = {"unknown", "outward", "inward"};

}  // namespace

bool ContactCollector::operator()(const Contact& contact) {
  ++found.count;
  if (contact.distance == 0) ++found.intersecting_count;
  std::vector<FoundContact>& first = found.first;
  if (first.size() == room) {
    if (room == 0 || !is_before(contact, first.front())) return true;
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

FoundContacts collect_contacts(std::size_t room, ContactDetail detail,
                               const std::function<PairCount(ContactCollector&)>& query) {
  ContactCollector collector{room, {}};
  FoundContacts& found = collector.found;
  const Stopwatch asking;
  found.stats = query(collector).stats;
  found.elapsed_us = asking.microseconds();
  found.detail = detail;
  std::sort_heap(found.first.begin(), found.first.end(), is_before);
  return std::move(found);
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
  append_parts(json, contact.part_a, contact.part_b);
  return json;
}

void add_margin(CLI::App& command, std::optional<double>& target, const std::string& description) {
  add_number(command, "--margin", target, not_negative, description);
}

}  // namespace limber::program
