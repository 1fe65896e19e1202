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
#include "command/run_files.h"
#include "limber/contacts.h"

namespace CLI {
class App;
}

/// Pairs of triangles: the options that ask for them, what queries find, and how it is written.
namespace limber::program {

/// Pairs that are connected: two are neighbors if their triangles of A share a vertex, or are one, and their triangles
/// of B, too. Of two neighbors both are in one region.
struct ContactRegion {
  std::size_t count = 0, intersecting_count = 0;  ///< of its pairs
  double depth = 0, distance = 0;                 ///< the largest, the least
  Vec3 low, high;                                 ///< a box around the points of its pairs
};

struct ContactRegions {
  std::vector<ContactRegion> regions;    ///< the deepest first, then the nearest, then the largest
  std::vector<std::uint32_t> region_of;  ///< of each pair
};

/// Cost     O(n log n) for n pairs.
ContactRegions regions_of(const std::vector<Contact>& contacts, MeshView a, MeshView b);

/// A pair of triangles, and the faces and parts of the files that they come from.
struct FoundContact : Contact {
  std::uint32_t face_a = 0, face_b = 0;
  const std::string *part_a = nullptr, *part_b = nullptr;  ///< as in FoundWitness
  std::optional<std::uint32_t> region = {};                ///< where regions were asked for
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
  std::optional<std::vector<ContactRegion>> regions = {};  ///< of all pairs, where they were asked for
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

/// Finds the regions of all pairs, and keeps the first few of the pairs. Pre: all pairs are there, with all detail.
void find_regions(FoundContacts& found, MeshView a, MeshView b, std::size_t room);

/// `count`, `intersecting`, `regions` where there are some, and `pairs`.
void append_contacts(Json& json, const FoundContacts& found);

/// How many pairs there are, and regions where they were asked for: the first few of these, too.
void write_count_line(const FoundContacts& found);
/// At most `row_count` of the pairs, below a blank line and names of columns. Nothing where there is no row.
void write_table(const FoundContacts& found, std::size_t row_count);

/// What the verbs about pairs of triangles share: which pairs are asked for, and where they are written.
struct ContactArguments {
  std::optional<double> margin;
  bool intersections = false;
  std::optional<std::uint64_t> closest;
  std::string out;  // empty: no file
  std::optional<std::uint64_t> max_count;
  bool json = false;
  bool exit_code = false;
};

/// `--margin`, with what it means.
void add_margin(CLI::App& command, std::optional<double>& target, const std::string& description);

/// `--margin`, `--intersections`, `--closest`, `--out`, `--max-count`, `--json`, and `--exit-code` with what it tells.
void add_contact_arguments(CLI::App& command, ContactArguments& arguments, const std::string& told);

/// To be called once everything is parsed: at most one of the first three options may be given, and standard output is
/// for one answer. Returns whether there is such a question.
bool check_contact_arguments(const CLI::App& command);

/// The help about rows and columns.
std::string contact_rows_help();

/// Writes what a verb has found where its arguments say.
class ContactOutput {
 public:
  /// Opens the CSV file, if there is one.
  ///
  /// Errors   BadInput where it cannot be written, or is one of the `inputs`.
  explicit ContactOutput(const ContactArguments& arguments);

  /// How many pairs are written at most.
  std::size_t room() const;

  /// Writes the file, and an answer to standard output: one object, made by `append` around the pairs; or what `lines`
  /// writes, and a table. Errors: OutputFailed.
  void write(const FoundContacts& found, const std::function<Json()>& json, const std::function<void()>& lines);

 private:
  std::size_t table_rows() const;
  void write_csv(const FoundContacts& found);

  ContactArguments arguments_;
  std::optional<OutputFile> out_;
};

}  // namespace limber::program
