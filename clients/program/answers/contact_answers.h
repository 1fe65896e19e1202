// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "answers/answers.h"
#include "command/output.h"
#include "limber/contacts.h"

namespace CLI {
class App;
}

/// Pairs of triangles: what queries find, and how it is written.
namespace limber::program {

/// A pair of triangles, and the faces and parts of the files that they come from.
struct FoundContact : Contact {
  std::uint32_t face_a = 0, face_b = 0;
  const std::string *part_a = nullptr, *part_b = nullptr;  ///< as in FoundWitness
};

/// What was asked about each pair.
enum class ContactDetail {
  ids,  ///< that it intersects, and nothing else: distance, depth, points, normal and features are not set
  all,
};

struct FoundContacts {
  std::size_t count = 0;               ///< of all pairs
  std::size_t intersecting_count = 0;  ///< those at distance 0
  ContactDetail detail = ContactDetail::all;
  bool has_parts = false;           ///< whether parts of a model are told
  std::vector<FoundContact> first;  ///< as many as were asked for: the deepest, then the nearest, then by ids
  QueryStats stats;
  double elapsed_us = 0;
};

/// Counts pairs, and keeps the first few of them. Never ends the query.
struct ContactCollector {
  std::size_t room;
  FoundContacts found;  ///< `first` is a heap with the last of them on top

  bool operator()(const Contact& contact);
  bool operator()(const TrianglePair& pair);
};

/// Runs a query, which hands its pairs to a collector with room for some of them. Faces are not set.
FoundContacts collect_contacts(std::size_t room, ContactDetail detail,
                               const std::function<PairCount(ContactCollector&)>& query);

/// Sets the faces and parts; `a` and `b` have `face_of(triangle)`.
template <typename Faces>
void set_faces(FoundContacts& found, const Faces& a, const Faces& b) {
  found.has_parts = part_of(a, 0) != nullptr || part_of(b, 0) != nullptr;
  for (FoundContact& contact : found.first) {
    contact.face_a = a.face_of(contact.triangle_a);
    contact.face_b = b.face_of(contact.triangle_b);
    contact.part_a = part_of(a, contact.triangle_a);
    contact.part_b = part_of(b, contact.triangle_b);
  }
}

/// "vertex 0", "edge 2", "face".
std::string to_text(Feature feature);

Json to_json(const FoundContact& contact, ContactDetail detail);

/// `--margin`, with what it means.
void add_margin(CLI::App& command, std::optional<double>& target, const std::string& description);

}  // namespace limber::program
