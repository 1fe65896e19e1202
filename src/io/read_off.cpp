// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "io/parse_mesh.h"
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
///
/// `vertex_words` becomes the number of words for a vertex.
Result<void> take_keyword(std::string_view& record, std::size_t& vertex_words) {
  std::string_view rest = record;
  const std::string_view word = take_word(rest);
  const std::size_t at = word.find("OFF");
  if (at == word.npos) return malformed("does not start with OFF");
  std::string_view kind = word.substr(0, at);
  vertex_words = 3;
  for (const auto& [extra, words] : {std::pair<std::string_view, std::size_t>{"ST", 2}, {"C", 4}, {"N", 3}}) {
    if (!kind.starts_with(extra)) continue;
    kind.remove_prefix(extra.size());
    vertex_words += words;
  }
  if (!kind.empty())
    return malformed(in_quotes(word.substr(0, at + 3)) + " is not read, only OFF, NOFF, COFF and STOFF");
  record.remove_prefix(static_cast<std::size_t>(word.data() - record.data()) + at + 3);
  return {};
}

/// Takes the corners of a face off the front.
Result<void> take_face(std::string_view& words, std::uint32_t vertex_count, FaceLists& faces) {
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

/// Reads vertices and faces: a line for each, with anything behind what is read, or all as one stream of words whatever
/// the lines, with nothing behind the last face.
Result<Soup> read_body(std::string_view rest, std::array<std::uint32_t, 2> counts, std::size_t vertex_words,
                       bool is_stream, bool& has_more) {
  std::string stream;
  if (is_stream) {
    for (auto line = take_record(rest); !line.empty(); line = take_record(rest)) stream.append(line).append(1, ' ');
  }
  std::string_view words = stream;
  const auto next_row = [&] { return is_stream || !(words = take_record(rest)).empty(); };
  const auto ends_before = [&](const char* what, std::size_t row, std::uint32_t count) {
    return malformed(std::string("ends before ") + what + " " + std::to_string(row) + " of " + std::to_string(count));
  };
  Soup soup;
  for (std::size_t vertex = 0; vertex < counts[0]; ++vertex) {
    if (!next_row()) return ends_before("vertex", vertex, counts[0]);
    Vec3 position;
    if (Result<void> taken = take_position(words, vertex, position); !taken) return taken.error();
    for (std::size_t i = 3; i < vertex_words; ++i) take_word(words);
    soup.positions.push_back(position);
  }
  for (std::size_t face = 0; face < counts[1]; ++face) {
    if (!next_row()) return ends_before("face", face, counts[1]);
    if (Result<void> taken = take_face(words, counts[0], soup.faces); !taken) return taken.error();
  }
  has_more = is_stream ? !take_word(words).empty() : !take_record(rest).empty();
  if (is_stream && has_more) return malformed("has words behind its last face");
  return soup;
}

}  // namespace

Result<Soup> read_off(std::string_view file) {
  std::string_view rest = without_byte_order_mark(file);
  std::string_view record = take_record(rest);
  std::size_t vertex_words = 0;
  if (Result<void> taken = take_keyword(record, vertex_words); !taken) return taken.error();
  std::string_view words = record;
  if (take_word(words).empty()) record = take_record(rest);
  words = record;
  const std::string_view first = take_word(words);
  if (first == "BINARY") return malformed("binary OFF is not read");
  const auto vertex_count = integer<std::uint32_t>(first);
  const auto face_count = integer<std::uint32_t>(take_word(words));
  if (!vertex_count || !face_count) return malformed("has no counts of vertices and faces after OFF");

  const std::array counts = {*vertex_count, *face_count};
  bool has_more = false;
  Result<Soup> soup = read_body(rest, counts, vertex_words, false, has_more);
  if (soup && !has_more) return soup;
  Result<Soup> stream = read_body(rest, counts, vertex_words, true, has_more);
  return stream ? std::move(stream) : std::move(soup);
}

}  // namespace limber::io
