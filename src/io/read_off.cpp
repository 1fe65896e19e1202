// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>

#include "io/readers.h"
#include "io/text_scan.h"

namespace limber::io {
namespace {

/// The next line that holds more than blanks and comments; empty at the end.
std::string_view take_record(std::string_view& rest) {
  while (!rest.empty()) {
    const std::string_view line = without_comment(take_line(rest));
    if (!std::all_of(line.begin(), line.end(), is_blank)) return line;
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
  if (!kind.empty())
    return malformed(in_quotes(word.substr(0, at + 3)) + " is not read, only OFF, NOFF, COFF and STOFF");
  record.remove_prefix(static_cast<std::size_t>(word.data() - record.data()) + at + 3);
  return {};
}

/// Reads the corners of a face; colors may follow them.
Result<void> read_face(std::string_view words, std::uint32_t vertex_count, FaceLists& faces) {
  const std::size_t face = faces.size();
  const std::string_view size_word = take_word(words);
  const auto size = integer<std::uint32_t>(size_word);
  if (!size) return malformed("face", face, in_quotes(size_word) + " is not a number of corners");
  for (std::uint32_t i = 0; i < *size; ++i) {
    const std::string_view word = take_word(words);
    const auto corner = integer<std::int64_t>(word);
    if (!corner) {
      return malformed("face", face,
                       word.empty() ? "fewer corners than promised" : in_quotes(word) + " is not a corner");
    }
    if (*corner < 0 || *corner >= vertex_count) return missing_vertex(face, *corner, vertex_count);
    faces.corners.push_back(static_cast<std::uint32_t>(*corner));
  }
  faces.ends.push_back(faces.corners.size());
  return {};
}

}  // namespace

Result<Soup> read_off(std::string_view file) {
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

  Soup soup;
  for (std::size_t vertex = 0; vertex < *vertex_count; ++vertex) {
    words = take_record(rest);
    if (words.empty()) {
      return malformed("ends before vertex " + std::to_string(vertex) + " of " + std::to_string(*vertex_count));
    }
    Vec3 position;
    if (Result<void> taken = take_position(words, vertex, position); !taken) return taken.error();
    soup.positions.push_back(position);
  }
  for (std::size_t face = 0; face < *face_count; ++face) {
    words = take_record(rest);
    if (words.empty()) {
      return malformed("ends before face " + std::to_string(face) + " of " + std::to_string(*face_count));
    }
    if (Result<void> read = read_face(words, *vertex_count, soup.faces); !read) return read.error();
  }
  return soup;
}

}  // namespace limber::io
