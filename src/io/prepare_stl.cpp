// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <initializer_list>

#include "io/prepare.h"
#include "io/text_scan.h"

namespace limber::io {
namespace {

constexpr std::size_t binary_head_bytes = 84, binary_facet_bytes = 50;

/// What a binary file of the promised number of facets would hold.
std::optional<std::uint64_t> promised_bytes(std::string_view file) {
  if (file.size() < binary_head_bytes) return {};
  std::uint64_t facet_count = 0;
  for (std::size_t i = 4; i-- > 0;) facet_count = (facet_count << 8U) | static_cast<unsigned char>(file[80 + i]);
  return binary_head_bytes + facet_count * binary_facet_bytes;
}

/// Keywords are in small letters, in capitals from some programs.
bool is_keyword(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                    [](char c, char k) { return c == k || c == k - 'a' + 'A'; });
}

Error misplaced(std::size_t facet, std::string_view found, std::string_view wanted) {
  return malformed("facet", facet,
                   found.empty() ? "the file ends where '" + std::string(wanted) + "' is due"
                                 : quoted(found) + " stands where '" + std::string(wanted) + "' is due");
}

Result<void> check_words(std::string_view& rest, std::size_t facet, std::initializer_list<std::string_view> due) {
  for (const std::string_view wanted : due) {
    if (const std::string_view found = take_word(rest); !is_keyword(found, wanted))
      return misplaced(facet, found, wanted);
  }
  return {};
}

/// Adds a facet whose first word is taken already.
Result<void> add_facet(std::string& text, std::string_view& rest, std::size_t facet) {
  if (Result<void> checked = check_words(rest, facet, {"normal"}); !checked) return checked;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = take_word(rest);
    if (number_kind(word) == NumberKind::none) return misplaced(facet, word, "a number");
  }
  if (Result<void> checked = check_words(rest, facet, {"outer", "loop"}); !checked) return checked;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    if (Result<void> checked = check_words(rest, facet, {"vertex"}); !checked) return checked;
    text += 'v';
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = take_word(rest);
      if (Result<void> checked = check_coordinate(word, 3 * facet + corner); !checked) return checked;
      text.append(1, ' ').append(word);
    }
    text += '\n';
  }
  text += "f -3 -2 -1\n";
  return check_words(rest, facet, {"endloop", "endfacet"});
}

}  // namespace

Result<bool> is_binary_stl(std::string_view file) {
  const std::optional<std::uint64_t> promised = promised_bytes(file);
  if (promised == file.size()) return true;  // also when it starts with "solid", as some binary files do
  std::string_view rest = file;
  if (is_keyword(take_word(rest), "solid") && file.find('\0') == file.npos) return false;
  if (!promised) return malformed("is neither a text nor a binary STL file");
  return malformed("is no STL text, and as a binary file it promises " + std::to_string(*promised) + " bytes but has " +
                   std::to_string(file.size()));
}

Result<std::string> prepare_stl_text(std::string_view file) {
  std::string_view rest = file;
  std::string text;
  std::size_t facet = 0;
  for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
    if (!is_keyword(word, "solid")) return misplaced(facet, word, "solid");
    take_line(rest);  // the solid's name
    for (word = take_word(rest); is_keyword(word, "facet"); word = take_word(rest), ++facet) {
      if (Result<void> added = add_facet(text, rest, facet); !added) return added.error();
    }
    if (!is_keyword(word, "endsolid")) return misplaced(facet, word, "endsolid");
    take_line(rest);
  }
  return text;
}

}  // namespace limber::io
