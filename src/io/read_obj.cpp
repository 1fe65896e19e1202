// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <map>

#include "io/scan.h"

namespace limber::io {
namespace {

bool is_keyword(std::string_view word) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return is_letter(word[0]) && std::all_of(word.begin(), word.end(), [&](char c) {
           return is_letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == ':';
         });
}

BadResult out_of_range(std::size_t face, std::int64_t index, std::size_t vertex_count) {
  return missing_vertex(face, index, vertex_count, ", counted from 1");
}

/// The vertex index at the front of a corner "v", "v/vt", "v//vn" or "v/vt/vn".
std::optional<std::int32_t> corner_index(std::string_view corner) {
  const auto is_part_of_corner = [](char c) { return (c >= '0' && c <= '9') || c == '/' || c == '-' || c == '+'; };
  if (!std::all_of(corner.begin(), corner.end(), is_part_of_corner)) return {};
  return integer<std::int32_t>(corner.substr(0, corner.find('/')));
}

/// Faces by the name that stands before them; a name that comes again goes on.
class NamedParts {
 public:
  void begin(std::string_view name) { name_ = trimmed(name), is_known_ = false; }
  void add_face() {
    if (!is_known_) {
      const auto [found, is_new] = ids_.emplace(name_, static_cast<std::uint32_t>(names.size()));
      if (is_new) names.push_back(name_);
      id_ = found->second;
      is_known_ = true;
    }
    part_of_face.push_back(id_);
  }

  std::vector<std::string> names;
  std::vector<std::uint32_t> part_of_face;

 private:
  std::string name_;
  std::map<std::string, std::uint32_t> ids_;
  std::uint32_t id_ = 0;
  bool is_known_ = false;
};

class ObjReader {
 public:
  Soup read(std::string_view file);

 private:
  void read_record(std::string_view line, std::size_t line_number);
  void read_face(std::string_view words);
  void check_corners() const;

  Soup soup_;
  NamedParts objects_, groups_;
  std::uint32_t largest_corner_ = 0;
};

void ObjReader::read_face(std::string_view words) {
  const std::size_t face = soup_.faces.size();
  const auto vertex_count = static_cast<std::int64_t>(soup_.positions.size());
  for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
    const std::optional<std::int32_t> index = corner_index(word);
    if (!index) throw malformed("face", face, in_quotes(word) + " is not a corner");
    // Positive indices count from 1, also to vertices further down; negative ones count back from the last vertex.
    const std::int64_t vertex = *index > 0 ? std::int64_t{*index} - 1 : vertex_count + *index;
    if (*index == 0 || vertex < 0) throw out_of_range(face, *index, soup_.positions.size());
    const auto corner = static_cast<std::uint32_t>(vertex);
    largest_corner_ = std::max(largest_corner_, corner);
    soup_.faces.corners.push_back(corner);
  }
  soup_.faces.ends.push_back(soup_.faces.corners.size());
  objects_.add_face();
  groups_.add_face();
}

void ObjReader::read_record(std::string_view line, std::size_t line_number) {
  line = without_comment(line);
  const std::string_view keyword = take_word(line);
  if (keyword.empty()) return;
  // A fourth coordinate or a color may follow the three.
  if (keyword == "v") return soup_.positions.push_back(take_position(line, soup_.positions.size()));
  if (keyword == "f" || keyword == "fo") return read_face(line);  // "fo" is the same in old files
  if (keyword == "o") objects_.begin(line);
  if (keyword == "g") groups_.begin(line);
  if (!is_keyword(keyword)) throw malformed("line", line_number, in_quotes(keyword) + " is not an OBJ keyword");
}

/// The line up to a backslash at its end, by which the record goes on in the next line; none without one. A comment
/// ends with its line.
std::optional<std::string_view> continued(std::string_view line) {
  if (without_comment(line).size() < line.size()) return {};
  line = line.substr(0, line.find_last_not_of(" \t\v\f") + 1);
  if (!line.ends_with('\\')) return {};
  return line.substr(0, line.size() - 1);
}

/// Checks what only the end of the file can tell, since faces may precede their vertices.
void ObjReader::check_corners() const {
  const std::size_t vertex_count = soup_.positions.size();
  if (soup_.faces.corners.empty() || largest_corner_ < vertex_count) return;
  for (std::size_t face = 0; face < soup_.faces.size(); ++face) {
    for (const std::uint32_t corner : soup_.faces[face]) {
      if (corner >= vertex_count) throw out_of_range(face, std::int64_t{corner} + 1, vertex_count);
    }
  }
}

Soup ObjReader::read(std::string_view file) {
  std::string_view rest = without_byte_order_mark(file);
  std::string joined;
  for (std::size_t line_number = 1; !rest.empty(); ++line_number) {
    std::string_view line = take_line(rest);
    const std::size_t first_line = line_number;
    joined.clear();
    for (auto part = continued(line); part; part = continued(line)) {
      joined.append(*part).append(1, ' ');
      line = take_line(rest);
      ++line_number;
    }
    if (!joined.empty()) line = joined.append(line);
    read_record(line, first_line);
  }
  if (soup_.positions.empty() && soup_.faces.size() == 0) throw malformed("has neither vertices nor faces");
  check_corners();
  NamedParts& parts = objects_.names.size() > 1 ? objects_ : groups_;
  if (parts.names.size() <= 1 && !objects_.names.empty()) parts = std::move(objects_);
  soup_.parts = std::move(parts.names);
  soup_.part_of_face = std::move(parts.part_of_face);
  return std::move(soup_);
}

}  // namespace

Soup read_obj(std::string_view file) { return ObjReader().read(file); }

}  // namespace limber::io
