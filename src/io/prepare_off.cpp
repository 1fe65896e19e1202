// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>

#include "io/prepare.h"
#include "io/text_scan.h"

namespace limber::io {
namespace {

/// The next line that holds more than blanks and comments; empty at the end.
std::string_view take_record(std::string_view& rest) {
  while (!rest.empty()) {
    const std::string_view line = without_comment(take_line(rest));
    std::string_view words = line;
    if (!take_word(words).empty()) return line;
  }
  return {};
}

/// Takes the keyword off the front, which files may write close to the first count, as in "OFF8 6 12".
Result<void> take_keyword(std::string_view& record) {
  std::string_view rest = record;
  const std::string_view word = take_word(rest);
  const std::size_t at = word.find("OFF");
  if (at == word.npos) return malformed("does not start with OFF");
  std::string_view kind = word.substr(0, at);
  for (const std::string_view extra : {"ST", "C", "N"}) {
    if (kind.starts_with(extra)) kind.remove_prefix(extra.size());
  }
  if (!kind.empty()) return malformed(quoted(word.substr(0, at + 3)) + " is not read, only OFF, NOFF, COFF and STOFF");
  record.remove_prefix(static_cast<std::size_t>(word.data() - record.data()) + at + 3);
  return {};
}

}  // namespace

// Kept from CGAL's reader: counts, for which it allocates before it reads; colours, which it looks up outside its table
// when they are too few or too small; negative indices, which it converts without a check.
Result<std::string> prepare_off(std::string_view file) {
  std::string_view rest = without_byte_order_mark(file);
  std::string_view record = take_record(rest);
  if (Result<void> taken = take_keyword(record); !taken) return taken.error();
  std::string_view words = record;
  if (take_word(words).empty()) record = take_record(rest);
  words = record;
  const std::string_view first = take_word(words);
  if (first == "BINARY") return malformed("binary OFF is not read");
  const auto vertex_count = integer<std::uint32_t>(first);
  const auto face_count = integer<std::uint32_t>(take_word(words));
  if (!vertex_count || !face_count) return malformed("has no counts of vertices and faces after OFF");

  std::string text = "OFF\n" + std::to_string(*vertex_count) + " " + std::to_string(*face_count) + " 0\n";
  for (std::size_t vertex = 0; vertex < *vertex_count; ++vertex) {
    words = take_record(rest);
    if (words.empty()) return malformed("ends before vertex " + std::to_string(vertex) + " of " + std::string(first));
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = take_word(words);
      if (Result<void> checked = check_coordinate(word, vertex); !checked) return checked.error();
      text.append(word).append(1, axis < 2 ? ' ' : '\n');
    }
  }
  for (std::size_t face = 0; face < *face_count; ++face) {
    words = take_record(rest);
    if (words.empty())
      return malformed("ends before face " + std::to_string(face) + " of " + std::to_string(*face_count));
    const std::string_view size_word = take_word(words);
    const auto size = integer<std::uint32_t>(size_word);
    if (!size) return malformed("face", face, quoted(size_word) + " is not a number of corners");
    text.append(size_word);
    for (std::uint32_t corner = 0; corner < *size; ++corner) {
      const std::string_view word = take_word(words);
      const auto index = integer<std::int64_t>(word);
      if (!index)
        return malformed("face", face,
                         word.empty() ? "fewer corners than promised" : quoted(word) + " is not a corner");
      if (*index < 0 || *index >= *vertex_count) {
        return Error{ErrorCode::index_out_of_range,
                     "face " + std::to_string(face) + " names vertex " + std::string(word) + ", but there are only " +
                         std::string(first) + " vertices",
                     face};
      }
      text.append(1, ' ').append(word);
    }
    text += '\n';
  }
  return text;
}

}  // namespace limber::io
