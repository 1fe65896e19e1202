// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>

#include "io/prepare.h"
#include "io/text_scan.h"

namespace limber::io {
namespace {

bool is_keyword(std::string_view word) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return is_letter(word[0]) && std::all_of(word.begin(), word.end(), [&](char c) {
           return is_letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == ':';
         });
}

Result<void> add_vertex(std::string& text, std::string_view words, std::size_t vertex) {
  text += 'v';  // a fourth coordinate or a colour may follow the three
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = take_word(words);
    if (Result<void> checked = check_coordinate(word, vertex); !checked) return checked;
    text.append(1, ' ').append(word);
  }
  text += '\n';
  return {};
}

Error out_of_range(std::size_t face, std::int32_t index, std::size_t vertex_count) {
  return {ErrorCode::index_out_of_range,
          "face " + std::to_string(face) + " names vertex " + std::to_string(index) +
              ", counted from 1, but there are only " + std::to_string(vertex_count) + " vertices",
          face};
}

/// A corner, kept because vertices may follow the faces that name them.
struct LargestCorner {
  std::int32_t index = 0;
  std::size_t face = 0;
};

Result<void> add_face(std::string& text, std::string_view words, std::size_t face, std::size_t vertex_count,
                      LargestCorner& largest) {
  text += 'f';
  for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
    const std::string_view vertex = word.substr(0, word.find('/'));
    const auto index = integer<std::int32_t>(vertex);
    if (!index || word.find_first_not_of("+-0123456789/") != word.npos) {
      return malformed("face", face, quoted(word) + " is not a corner");
    }
    const bool reaches_back_too_far = -static_cast<std::int64_t>(*index) > static_cast<std::int64_t>(vertex_count);
    if (*index == 0 || reaches_back_too_far) return out_of_range(face, *index, vertex_count);
    if (*index > largest.index) largest = {*index, face};
    text.append(1, ' ').append(vertex);
  }
  text += '\n';
  return {};
}

}  // namespace

// Kept from CGAL's reader: lines "l" and unknown keywords, which it takes for errors; tabs between corners, after which
// it reads no further; corners that are no integers, at which it ends the face; index 0, which it takes for the next
// vertex to come; indices of missing vertices, which it misses when they are off by one.
Result<std::string> prepare_obj(std::string_view file) {
  std::string_view rest = without_byte_order_mark(file);
  std::string text;
  std::string joined;
  std::size_t vertex_count = 0, face_count = 0;
  LargestCorner largest;
  for (std::size_t line_number = 1; !rest.empty(); ++line_number) {
    std::string_view line = take_line(rest);
    const std::size_t first_line = line_number;
    if (line.ends_with('\\')) {  // the record goes on in the next line
      joined.clear();
      while (line.ends_with('\\')) {
        joined.append(line.substr(0, line.size() - 1)).append(1, ' ');
        line = take_line(rest);
        ++line_number;
      }
      line = joined.append(line);
    }
    line = without_comment(line);
    const std::string_view keyword = take_word(line);
    Result<void> added;
    if (keyword.empty()) continue;
    if (keyword == "v") {
      added = add_vertex(text, line, vertex_count++);
    } else if (keyword == "f" || keyword == "fo") {  // "fo" is the same in old files
      added = add_face(text, line, face_count++, vertex_count, largest);
    } else if (!is_keyword(keyword)) {
      added = malformed("line", first_line, quoted(keyword) + " is not an OBJ keyword");
    }
    if (!added) return added.error();
  }
  if (vertex_count == 0 && face_count == 0) return malformed("has neither vertices nor faces");
  if (static_cast<std::size_t>(largest.index) > vertex_count) {
    return out_of_range(largest.face, largest.index, vertex_count);
  }
  return text;
}

}  // namespace limber::io
