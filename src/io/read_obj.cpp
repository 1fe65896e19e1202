// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>

#include "io/readers.h"
#include "io/text_scan.h"

namespace limber::io {
namespace {

bool is_keyword(std::string_view word) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return is_letter(word[0]) && std::all_of(word.begin(), word.end(), [&](char c) {
           return is_letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == ':';
         });
}

Error out_of_range(std::size_t face, std::int64_t index, std::size_t vertex_count) {
  return {ErrorCode::index_out_of_range,
          "face " + std::to_string(face) + " names vertex " + std::to_string(index) +
              ", counted from 1, but there are only " + std::to_string(vertex_count) + " vertices",
          face};
}

/// The vertex index at the front of a corner "v", "v/vt", "v//vn" or "v/vt/vn".
std::optional<std::int32_t> corner_index(std::string_view corner) {
  const auto is_part_of_corner = [](char c) { return (c >= '0' && c <= '9') || c == '/' || c == '-' || c == '+'; };
  if (!std::all_of(corner.begin(), corner.end(), is_part_of_corner)) return {};
  return integer<std::int32_t>(corner.substr(0, corner.find('/')));
}

class ObjReader {
 public:
  Result<Soup> read(std::string_view file);

 private:
  Result<void> read_record(std::string_view line, std::size_t line_number);
  Result<void> read_vertex(std::string_view words);
  Result<void> read_face(std::string_view words);
  Result<void> check_corners() const;

  Soup soup_;
  std::uint32_t largest_corner_ = 0;
};

Result<void> ObjReader::read_vertex(std::string_view words) {
  Vec3 position;  // a fourth coordinate or a color may follow the three
  if (Result<void> taken = take_position(words, soup_.positions.size(), position); !taken) return taken;
  soup_.positions.push_back(position);
  return {};
}

Result<void> ObjReader::read_face(std::string_view words) {
  const std::size_t face = soup_.faces.size();
  const auto vertex_count = static_cast<std::int64_t>(soup_.positions.size());
  for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
    const std::optional<std::int32_t> index = corner_index(word);
    if (!index) return malformed("face", face, in_quotes(word) + " is not a corner");
    // Positive indices count from 1, also to vertices further down; negative ones count back from the last vertex.
    const std::int64_t vertex = *index > 0 ? std::int64_t{*index} - 1 : vertex_count + *index;
    if (*index == 0 || vertex < 0) return out_of_range(face, *index, soup_.positions.size());
    const auto corner = static_cast<std::uint32_t>(vertex);
    largest_corner_ = std::max(largest_corner_, corner);
    soup_.faces.corners.push_back(corner);
  }
  soup_.faces.ends.push_back(soup_.faces.corners.size());
  return {};
}

Result<void> ObjReader::read_record(std::string_view line, std::size_t line_number) {
  line = without_comment(line);
  const std::string_view keyword = take_word(line);
  if (keyword.empty()) return {};
  if (keyword == "v") return read_vertex(line);
  if (keyword == "f" || keyword == "fo") return read_face(line);  // "fo" is the same in old files
  if (!is_keyword(keyword)) return malformed("line", line_number, in_quotes(keyword) + " is not an OBJ keyword");
  return {};
}

/// Checks what only the end of the file can tell, since faces may precede their vertices.
Result<void> ObjReader::check_corners() const {
  const std::size_t vertex_count = soup_.positions.size();
  if (soup_.faces.corners.empty() || largest_corner_ < vertex_count) return {};
  for (std::size_t face = 0; face < soup_.faces.size(); ++face) {
    for (const std::uint32_t corner : soup_.faces[face]) {
      if (corner >= vertex_count) return out_of_range(face, std::int64_t{corner} + 1, vertex_count);
    }
  }
  return {};
}

Result<Soup> ObjReader::read(std::string_view file) {
  std::string_view rest = without_byte_order_mark(file);
  std::string joined;
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
    if (Result<void> done = read_record(line, first_line); !done) return done.error();
  }
  if (soup_.positions.empty() && soup_.faces.size() == 0) return malformed("has neither vertices nor faces");
  if (Result<void> checked = check_corners(); !checked) return checked.error();
  return std::move(soup_);
}

}  // namespace

Result<Soup> read_obj(std::string_view file) { return ObjReader().read(file); }

}  // namespace limber::io
