// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <initializer_list>

#include "base/check.h"
#include "io/scan.h"

namespace limber::io {
namespace {

constexpr std::size_t binary_head_bytes = 84, binary_facet_bytes = 50, binary_normal_bytes = 12;

/// What a binary file of the promised number of facets would hold.
std::optional<std::uint64_t> promised_bytes(std::string_view file) {
  if (file.size() < binary_head_bytes) return {};
  return binary_head_bytes + unsigned_number(file.substr(80, 4)) * binary_facet_bytes;
}

/// Adds a triangle of the last three positions.
void add_facet(Soup& soup) {
  LIMBER_ASSERT(soup.positions.size() >= 3 && soup.positions.size() < no_id);
  const auto vertex_count = static_cast<std::uint32_t>(soup.positions.size());
  for (std::uint32_t i = 3; i > 0; --i) soup.faces.corners.push_back(vertex_count - i);
  soup.faces.ends.push_back(soup.faces.corners.size());
}

/// Where each facet starts if all are followed by as many bytes as their attributes say; empty unless the file ends
/// with the last of them.
std::vector<std::size_t> facets_with_attributes(std::string_view file) {
  std::vector<std::size_t> starts;
  std::size_t at = binary_head_bytes;
  for (std::uint64_t left = unsigned_number(file.substr(80, 4)); left > 0; --left) {
    if (at > file.size() || file.size() - at < binary_facet_bytes) return {};
    starts.push_back(at);
    at += binary_facet_bytes;
    at += static_cast<std::size_t>(unsigned_number(file.substr(at - 2, 2)));
  }
  return at == file.size() ? starts : std::vector<std::size_t>();
}

bool has_no_attributes(std::string_view file, std::size_t facet_count) {
  std::size_t facet = 0;
  while (facet < facet_count &&
         unsigned_number(file.substr(binary_head_bytes + (facet + 1) * binary_facet_bytes - 2, 2)) == 0)
    ++facet;
  return facet == facet_count;
}

/// Facets one after the other, or where `starts` says.
Soup read_binary(std::string_view file, std::size_t facet_count, const std::vector<std::size_t>& starts = {}) {
  Soup soup;
  soup.positions.reserve(3 * facet_count);
  soup.faces.corners.reserve(3 * facet_count);
  soup.faces.ends.reserve(facet_count);
  for (std::size_t facet = 0; facet < facet_count; ++facet) {
    std::size_t at = starts.empty() ? binary_head_bytes + facet * binary_facet_bytes : starts[facet];
    LIMBER_ASSERT(file.size() - at >= binary_facet_bytes);
    at += binary_normal_bytes;
    for (int corner = 0; corner < 3; ++corner) {
      Vec3 position;
      for (std::size_t axis = 0; axis < 3; ++axis, at += 4) position[axis] = float_number(file.substr(at, 4));
      soup.positions.push_back(position);
    }
    add_facet(soup);
  }
  return soup;
}

/// Keywords are in small letters, in capitals from some programs.
bool is_keyword(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                    [](char c, char k) { return c == k || c == k - 'a' + 'A'; });
}

BadResult misplaced(std::size_t facet, std::string_view found, std::string_view wanted) {
  return malformed("facet", facet,
                   found.empty() ? "the file ends where '" + std::string(wanted) + "' is due"
                                 : in_quotes(found) + " stands where '" + std::string(wanted) + "' is due");
}

void check_words(std::string_view& rest, std::size_t facet, std::initializer_list<std::string_view> due) {
  for (const std::string_view wanted : due) {
    const std::string_view found = take_word(rest);
    if (!is_keyword(found, wanted)) throw misplaced(facet, found, wanted);
  }
}

/// Reads a facet whose first word is taken already.
void read_facet(std::string_view& rest, Soup& soup) {
  const std::size_t facet = soup.faces.size();
  check_words(rest, facet, {"normal"});
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = take_word(rest);
    if (number(word).kind == NumberKind::none) throw misplaced(facet, word, "a number");
  }
  check_words(rest, facet, {"outer", "loop"});
  for (int corner = 0; corner < 3; ++corner) {
    check_words(rest, facet, {"vertex"});
    soup.positions.push_back(take_position(rest, soup.positions.size()));
  }
  add_facet(soup);
  check_words(rest, facet, {"endloop", "endfacet"});
}

Soup read_text(std::string_view file) {
  std::string_view rest = without_byte_order_mark(file);
  Soup soup;
  for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
    if (!is_keyword(word, "solid")) throw misplaced(soup.faces.size(), word, "solid");
    const std::string_view name = trimmed(take_line(rest));
    const std::size_t first = soup.faces.size();
    for (word = take_word(rest); is_keyword(word, "facet"); word = take_word(rest)) read_facet(rest, soup);
    if (soup.faces.size() > first) soup.parts.emplace_back(name);
    soup.part_of_face.resize(soup.faces.size(), static_cast<std::uint32_t>(soup.parts.size()) - 1);
    if (!is_keyword(word, "endsolid")) throw misplaced(soup.faces.size(), word, "endsolid");
    take_line(rest);
  }
  return soup;
}

}  // namespace

Soup read_stl(std::string_view file) {
  const std::optional<std::uint64_t> promised = promised_bytes(file);
  const auto facets_that_fit = promised ? (file.size() - binary_head_bytes) / binary_facet_bytes : std::size_t{0};
  // Also when it starts with "solid", as some binary files do.
  if (promised == file.size()) return read_binary(file, facets_that_fit);
  std::string_view rest = without_byte_order_mark(file);
  if (is_keyword(take_word(rest), "solid") && file.find('\0') == file.npos) return read_text(file);
  if (!promised) throw malformed("is neither a text nor a binary STL file");
  if (const auto starts = facets_with_attributes(file); !starts.empty()) {
    return read_binary(file, starts.size(), starts);
  }
  const std::uint64_t count = unsigned_number(file.substr(80, 4));
  // Other bytes may follow, unless facets speak of bytes behind themselves: these would be taken for facets.
  if (count > 0 && *promised < file.size() && has_no_attributes(file, static_cast<std::size_t>(count))) {
    return read_binary(file, static_cast<std::size_t>(count));
  }
  // Programs that write as they go leave the number of facets 0.
  if (count == 0 && file.size() == binary_head_bytes + facets_that_fit * binary_facet_bytes) {
    return read_binary(file, facets_that_fit);
  }
  throw malformed("is no STL text, and as a binary file it promises " + std::to_string(*promised) + " bytes but has " +
                  std::to_string(file.size()));
}

}  // namespace limber::io
