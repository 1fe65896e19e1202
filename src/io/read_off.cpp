// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "io/scan.h"

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
/// Returns the number of words for a vertex.
std::size_t take_keyword(std::string_view& record) {
  std::string_view rest = record;
  const std::string_view word = take_word(rest);
  const std::size_t at = word.find("OFF");
  if (at == word.npos) throw malformed("does not start with OFF");
  std::string_view kind = word.substr(0, at);
  std::size_t vertex_words = 3;
  for (const auto& [extra, words] : {std::pair<std::string_view, std::size_t>{"ST", 2}, {"C", 4}, {"N", 3}}) {
    if (!kind.starts_with(extra)) continue;
    kind.remove_prefix(extra.size());
    vertex_words += words;
  }
  if (!kind.empty())
    throw malformed(in_quotes(word.substr(0, at + 3)) + " is not read, only OFF, NOFF, COFF and STOFF");
  record.remove_prefix(static_cast<std::size_t>(word.data() - record.data()) + at + 3);
  return vertex_words;
}

/// Takes the corners of a face off the front.
void take_face(std::string_view& words, std::uint32_t vertex_count, FaceLists& faces) {
  const std::size_t face = faces.size();
  const std::string_view size_word = take_word(words);
  const auto size = integer<std::uint32_t>(size_word);
  if (!size) throw malformed("face", face, in_quotes(size_word) + " is not a number of corners");
  for (std::uint32_t i = 0; i < *size; ++i) {
    const std::string_view word = take_word(words);
    const auto corner = integer<std::int64_t>(word);
    if (!corner) {
      throw malformed("face", face,
                      word.empty() ? "fewer corners than promised" : in_quotes(word) + " is not a corner");
    }
    if (*corner < 0 || *corner >= vertex_count) throw missing_vertex(face, *corner, vertex_count);
    faces.corners.push_back(static_cast<std::uint32_t>(*corner));
  }
  faces.ends.push_back(faces.corners.size());
}

/// Reads vertices and faces: a line for each, with anything behind what is read, or all as one stream of words whatever
/// the lines, with nothing behind the last face.
Soup read_body(std::string_view rest, std::array<std::uint32_t, 2> counts, std::size_t vertex_words, bool is_stream,
               bool& has_more) {
  std::string stream;
  if (is_stream) {
    for (auto line = take_record(rest); !line.empty(); line = take_record(rest)) stream.append(line).append(1, ' ');
  }
  std::string_view words = stream;
  const auto go_to_row = [&](const char* what, std::size_t row, std::uint32_t count) {
    if (is_stream || !(words = take_record(rest)).empty()) return;
    throw malformed(std::string("ends before ") + what + " " + std::to_string(row) + " of " + std::to_string(count));
  };
  Soup soup;
  for (std::size_t vertex = 0; vertex < counts[0]; ++vertex) {
    go_to_row("vertex", vertex, counts[0]);
    soup.positions.push_back(take_position(words, vertex));
    for (std::size_t i = 3; i < vertex_words; ++i) take_word(words);
  }
  for (std::size_t face = 0; face < counts[1]; ++face) {
    go_to_row("face", face, counts[1]);
    take_face(words, counts[0], soup.faces);
  }
  has_more = is_stream ? !take_word(words).empty() : !take_record(rest).empty();
  if (is_stream && has_more) throw malformed("has words behind its last face");
  return soup;
}

}  // namespace

Soup read_off(std::string_view file) {
  std::string_view rest = without_byte_order_mark(file);
  std::string_view record = take_record(rest);
  const std::size_t vertex_words = take_keyword(record);
  std::string_view words = record;
  if (take_word(words).empty()) record = take_record(rest);
  words = record;
  const std::string_view first = take_word(words);
  if (first == "BINARY") throw malformed("binary OFF is not read");
  const auto vertex_count = integer<std::uint32_t>(first);
  const auto face_count = integer<std::uint32_t>(take_word(words));
  if (!vertex_count || !face_count) throw malformed("has no counts of vertices and faces after OFF");

  const std::array counts = {*vertex_count, *face_count};
  bool has_more = false;
  std::optional<BadResult> refused;
  Soup soup;
  try {
    soup = read_body(rest, counts, vertex_words, false, has_more);
    if (!has_more) return soup;
  } catch (const BadResult& reason) {
    refused = reason;
  }
  try {
    return read_body(rest, counts, vertex_words, true, has_more);
  } catch (const BadResult&) {
    if (refused) throw *refused;
    return soup;
  }
}

}  // namespace limber::io
