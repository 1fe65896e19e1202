// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "limber/contacts.h"

/// Pairs of triangles that a query has found, in the order in which the program writes them.
namespace limber::program {

/// A pair of triangles, and the faces of the files that they come from.
struct FoundContact : Contact {
  std::uint32_t face_a = 0, face_b = 0;
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
  std::vector<FoundContact> first;  ///< as many as were asked for: the deepest, then the nearest, then by ids
  QueryStats stats;
  double elapsed_us = 0;
};

/// Counts pairs, and keeps the first few of them.
class ContactCollector {
 public:
  explicit ContactCollector(std::size_t room) : room_(room) {}

  /// Visits. Never ends the query.
  bool operator()(const Contact& contact);
  bool operator()(const TrianglePair& pair);

  /// What was found, in order. The collector is empty afterwards.
  FoundContacts take();

 private:
  std::size_t room_;
  FoundContacts found_;  // `first` is a heap with the last of them on top
};

/// Runs a query, which hands its pairs to a collector with room for some of them. Faces are not set.
FoundContacts collect_contacts(std::size_t room, ContactDetail detail,
                               const std::function<PairCount(ContactCollector&)>& query);

/// Asks for the closest of so many pairs, as many as `count`, and hands them to a collector.
PairCount visit_closest(std::uint64_t count, std::uint64_t pair_count,
                        const std::function<PairCount(std::span<Contact>)>& closest_pairs, ContactCollector& visit);

/// Sets the faces; `a` and `b` have `face_of(triangle)`.
template <typename Faces>
void set_faces(FoundContacts& found, const Faces& a, const Faces& b) {
  for (FoundContact& contact : found.first) {
    contact.face_a = a.face_of(contact.triangle_a);
    contact.face_b = b.face_of(contact.triangle_b);
  }
}

}  // namespace limber::program
