// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/ply_header.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "io/text_scan.h"

namespace limber::io {
namespace {

std::optional<PlyType> scalar_type(std::string_view word) {
  struct Named {
    std::string_view name, sized_name;
    PlyType type;
  };
  static constexpr std::array<Named, 8> types = {{{"char", "int8", {1, true, false}},
                                                  {"uchar", "uint8", {1, false, false}},
                                                  {"short", "int16", {2, true, false}},
                                                  {"ushort", "uint16", {2, false, false}},
                                                  {"int", "int32", {4, true, false}},
                                                  {"uint", "uint32", {4, false, false}},
                                                  {"float", "float32", {4, true, true}},
                                                  {"double", "float64", {8, true, true}}}};
  for (const Named& named : types) {
    if (word == named.name || word == named.sized_name) return named.type;
  }
  return {};
}

std::optional<PlyEncoding> encoding(std::string_view word) {
  if (word == "ascii") return PlyEncoding::ascii;
  if (word == "binary_little_endian") return PlyEncoding::little_endian;
  if (word == "binary_big_endian") return PlyEncoding::big_endian;
  return {};
}

Result<PlyProperty> parse_property(std::string_view words) {
  PlyProperty property;
  std::string_view type_name = take_word(words);
  if (type_name == "list") {
    property.size_type = scalar_type(take_word(words));
    if (!property.size_type || property.size_type->is_float) return malformed("has a list whose sizes are no integers");
    type_name = take_word(words);
  }
  const std::optional<PlyType> type = scalar_type(type_name);
  if (!type) return malformed(in_quotes(type_name) + " is not a PLY type");
  property.type = *type;
  property.name = take_word(words);
  return property;
}

Result<void> check_vertices(const PlyElement& element) {
  for (const char* axis : {"x", "y", "z"}) {
    const auto is_axis = [&](const PlyProperty& property) { return property.name == axis; };
    const auto found = std::find_if(element.properties.begin(), element.properties.end(), is_axis);
    if (std::count_if(element.properties.begin(), element.properties.end(), is_axis) != 1 || found->size_type) {
      return malformed(std::string("has no vertex coordinate ") + axis + " that is one number");
    }
  }
  return {};
}

Result<void> check_faces(const PlyElement& element) {
  const auto is_corner_list = [](const PlyProperty& property) { return property.is_corner_list(); };
  const auto found = std::find_if(element.properties.begin(), element.properties.end(), is_corner_list);
  if (std::count_if(element.properties.begin(), element.properties.end(), is_corner_list) != 1) {
    return malformed("has faces without a list vertex_indices");
  }
  if (found->type.is_float) return malformed("has vertex indices that are no integers");
  return {};
}

Result<void> check_elements(PlyHeader& header) {
  std::size_t vertex_elements = 0, face_elements = 0;
  for (const PlyElement& element : header.elements) {
    if (element.holds_vertices()) {
      ++vertex_elements;
      header.vertex_count = element.count;
      if (Result<void> checked = check_vertices(element); !checked) return checked;
    } else if (element.holds_faces() || element.holds_strips()) {
      ++face_elements;
      if (Result<void> checked = check_faces(element); !checked) return checked;
    }
  }
  if (vertex_elements == 0) return malformed("has no vertices");
  if (vertex_elements > 1 || face_elements > 1) return malformed("has two elements of vertices or of faces");
  return {};
}

/// Reads one line of the header; `at_end` tells that it was the last.
Result<void> read_line(std::string_view words, PlyHeader& header, bool& has_format, bool& at_end) {
  const std::string_view keyword = take_word(words);
  if (keyword == "format") {
    const std::string_view name = take_word(words);
    const std::optional<PlyEncoding> known = encoding(name);
    if (!known) return malformed(in_quotes(name) + " is not a PLY encoding");
    header.encoding = *known;
    has_format = true;
  } else if (keyword == "element") {
    const std::string_view name = take_word(words);
    const auto count = integer<std::uint32_t>(take_word(words));
    if (!count) return malformed("element " + in_quotes(name) + " has no count that fits 32 bits");
    header.elements.push_back({name, *count, {}});
  } else if (keyword == "property") {
    if (header.elements.empty()) return malformed("has a property before the first element");
    const Result<PlyProperty> property = parse_property(words);
    if (!property) return property.error();
    header.elements.back().properties.push_back(*property);
  } else if (keyword == "end_header") {
    if (!has_format) return malformed("has no format line");
    at_end = true;
  } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
    return malformed(in_quotes(keyword) + " is not a PLY header keyword");
  }
  return {};
}

}  // namespace

Result<PlyHeader> take_ply_header(std::string_view& rest) {
  std::string_view first_line = take_line(rest);
  if (take_word(first_line) != "ply") return malformed("does not start with ply");
  PlyHeader header;
  bool has_format = false, at_end = false;
  while (!rest.empty() && !at_end) {
    if (Result<void> read = read_line(take_line(rest), header, has_format, at_end); !read) return read.error();
  }
  if (!at_end) return malformed("ends inside its header");
  if (Result<void> checked = check_elements(header); !checked) return checked.error();
  return header;
}

}  // namespace limber::io
