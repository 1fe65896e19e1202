// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdint>

#include "base/check.h"
#include "io/scan.h"

namespace limber::io {
namespace {

// --- the header: which elements follow, and what each of them consists of ---

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyType {
  std::size_t byte_count = 0;
  bool is_signed = false;
  bool is_float = false;
};

struct PlyProperty {
  std::string_view name;
  PlyType type;
  std::optional<PlyType> size_type;  ///< of a list

  bool is_corner_list() const { return size_type && (name == "vertex_indices" || name == "vertex_index"); }
};

struct PlyElement {
  std::string_view name;
  std::size_t count = 0;  ///< as promised, at most 2^32 - 1
  std::vector<PlyProperty> properties;

  bool holds_vertices() const { return name == "vertex" || name == "vertices"; }
  bool holds_faces() const { return name == "face" || name == "faces"; }
  bool holds_strips() const { return name == "tristrips"; }  ///< of triangles, which -1 may separate
};

struct PlyHeader {
  PlyEncoding encoding{};
  std::vector<PlyElement> elements;
  std::size_t vertex_count = 0;
};

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

PlyProperty parse_property(std::string_view words) {
  PlyProperty property;
  std::string_view type_name = take_word(words);
  if (type_name == "list") {
    property.size_type = scalar_type(take_word(words));
    if (!property.size_type || property.size_type->is_float) throw malformed("has a list whose sizes are no integers");
    type_name = take_word(words);
  }
  const std::optional<PlyType> type = scalar_type(type_name);
  if (!type) throw malformed(in_quotes(type_name) + " is not a PLY type");
  property.type = *type;
  property.name = take_word(words);
  return property;
}

void check_vertices(const PlyElement& element) {
  for (const char* axis : {"x", "y", "z"}) {
    const auto is_axis = [&](const PlyProperty& property) { return property.name == axis; };
    const auto found = std::find_if(element.properties.begin(), element.properties.end(), is_axis);
    if (std::count_if(element.properties.begin(), element.properties.end(), is_axis) != 1 || found->size_type) {
      throw malformed(std::string("has no vertex coordinate ") + axis + " that is one number");
    }
  }
}

void check_faces(const PlyElement& element) {
  const auto is_corner_list = [](const PlyProperty& property) { return property.is_corner_list(); };
  const auto found = std::find_if(element.properties.begin(), element.properties.end(), is_corner_list);
  if (std::count_if(element.properties.begin(), element.properties.end(), is_corner_list) != 1) {
    throw malformed("has faces without a list vertex_indices");
  }
  if (found->type.is_float) throw malformed("has vertex indices that are no integers");
}

void check_elements(PlyHeader& header) {
  std::size_t vertex_elements = 0, face_elements = 0;
  for (const PlyElement& element : header.elements) {
    if (element.holds_vertices()) {
      ++vertex_elements;
      header.vertex_count = element.count;
      check_vertices(element);
    } else if (element.holds_faces() || element.holds_strips()) {
      ++face_elements;
      check_faces(element);
    }
  }
  if (vertex_elements == 0) throw malformed("has no vertices");
  if (vertex_elements > 1 || face_elements > 1) throw malformed("has two elements of vertices or of faces");
}

/// Reads one line of the header; `at_end` tells that it was the last.
void read_line(std::string_view words, PlyHeader& header, bool& has_format, bool& at_end) {
  const std::string_view keyword = take_word(words);
  if (keyword == "format") {
    const std::string_view name = take_word(words);
    const std::optional<PlyEncoding> known = encoding(name);
    if (!known) throw malformed(in_quotes(name) + " is not a PLY encoding");
    header.encoding = *known;
    has_format = true;
  } else if (keyword == "element") {
    const std::string_view name = take_word(words);
    const auto count = integer<std::uint32_t>(take_word(words));
    if (!count) throw malformed("element " + in_quotes(name) + " has no count that fits 32 bits");
    header.elements.push_back({name, *count, {}});
  } else if (keyword == "property") {
    if (header.elements.empty()) throw malformed("has a property before the first element");
    header.elements.back().properties.push_back(parse_property(words));
  } else if (keyword == "end_header") {
    if (!has_format) throw malformed("has no format line");
    at_end = true;
  } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
    throw malformed(in_quotes(keyword) + " is not a PLY header keyword");
  }
}

/// Takes the header off the front of `rest`.
///
/// Promise  There is one element of vertices, with one number x, y and z each, and at most one of faces or
///          strips, with one list of integer vertex indices. The header's names refer to the file's bytes.
PlyHeader take_ply_header(std::string_view& rest) {
  std::string_view first_line = take_line(rest);
  if (take_word(first_line) != "ply") throw malformed("does not start with ply");
  PlyHeader header;
  bool has_format = false, at_end = false;
  while (!rest.empty() && !at_end) {
    read_line(take_line(rest), header, has_format, at_end);
  }
  if (!at_end) throw malformed("ends inside its header");
  check_elements(header);
  return header;
}

// --- the data ---

/// Walks over the data behind the header.
class PlyReader {
 public:
  PlyReader(std::string_view data, const PlyHeader& header)
      : rest_(data),
        is_text_(header.encoding == PlyEncoding::ascii),
        byte_order_(header.encoding == PlyEncoding::big_endian ? ByteOrder::big : ByteOrder::little),
        vertex_count_(header.vertex_count) {}

  void read(const PlyElement& element) {
    if (element.holds_vertices()) return read_vertices(element);
    if (element.holds_faces() || element.holds_strips()) return read_faces(element);
    for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      for (const PlyProperty& property : element.properties) {
        if (!skip(property)) throw truncated(element, i);
      }
    }
  }

  Soup take_soup() { return std::move(soup_); }

 private:
  static BadResult truncated(const PlyElement& element, std::size_t at) {
    return malformed(element.name, at,
                     "the file ends here or holds a bad value, it promises " + std::to_string(element.count));
  }

  /// The next value as it stands in the file: a word or some bytes. Empty at the end.
  std::string_view take(PlyType type) {
    if (is_text_) return take_word(rest_);
    if (rest_.size() < type.byte_count) return {};
    const std::string_view bytes = rest_.substr(0, type.byte_count);
    rest_.remove_prefix(type.byte_count);
    return bytes;
  }

  std::optional<std::int64_t> take_integer(PlyType type) {
    const std::string_view raw = take(type);
    if (is_text_) return integer<std::int64_t>(raw);
    if (raw.empty()) return {};
    return integer_of(raw, type);
  }

  std::int64_t integer_of(std::string_view raw, PlyType type) const {
    LIMBER_ASSERT(!type.is_float && raw.size() <= 4);
    const auto value = static_cast<std::int64_t>(unsigned_number(raw, byte_order_));  // of at most 32 bits
    const std::int64_t sign = std::int64_t{1} << (8 * raw.size() - 1);
    return type.is_signed && value >= sign ? value - 2 * sign : value;
  }

  bool skip(const PlyProperty& property) {
    std::int64_t size = 1;
    if (property.size_type) {
      const auto read = take_integer(*property.size_type);
      if (!read || *read < 0) return false;
      size = *read;
    }
    if (is_text_) {
      for (; size > 0; --size) {
        if (take_word(rest_).empty()) return false;
      }
      return true;
    }
    const std::uint64_t byte_count = static_cast<std::uint64_t>(size) * property.type.byte_count;
    if (byte_count > rest_.size()) return false;
    rest_.remove_prefix(static_cast<std::size_t>(byte_count));
    return true;
  }

  void read_vertices(const PlyElement& element) {
    constexpr std::size_t smallest_vertex_bytes = 6;  // "0 0 0 "; no more is reserved than the file can hold
    soup_.positions.reserve(std::min(element.count, rest_.size() / smallest_vertex_bytes));
    for (std::size_t vertex = 0; vertex < element.count; ++vertex) {
      Vec3 position;
      for (const PlyProperty& property : element.properties) {
        const bool is_coordinate = property.name == "x" || property.name == "y" || property.name == "z";
        if (!is_coordinate) {
          if (!skip(property)) throw truncated(element, vertex);
          continue;
        }
        const std::string_view raw = take(property.type);
        if (raw.empty()) throw truncated(element, vertex);
        position[static_cast<std::size_t>(property.name[0] - 'x')] =
            is_text_                 ? coordinate(raw, vertex)
            : property.type.is_float ? float_number(raw, byte_order_)
                                     : static_cast<double>(integer_of(raw, property.type));
      }
      soup_.positions.push_back(position);
    }
  }

  void read_faces(const PlyElement& element) {
    FaceLists& faces = soup_.faces;
    faces.ends.reserve(std::min(element.count, rest_.size()));
    for (std::size_t face = 0; face < element.count; ++face) {
      for (const PlyProperty& property : element.properties) {
        if (!property.is_corner_list()) {
          if (!skip(property)) throw truncated(element, face);
          continue;
        }
        const auto size = take_integer(*property.size_type);
        if (!size || *size < 0 || static_cast<std::uint64_t>(*size) > rest_.size()) throw truncated(element, face);
        std::size_t first = faces.corners.size();
        for (std::int64_t i = 0; i < *size; ++i) {
          const auto corner = take_integer(property.type);
          if (!corner) throw truncated(element, face);
          if (*corner == -1 && element.holds_strips()) {
            split_strip(first);
            first = faces.corners.size();
            continue;
          }
          if (*corner < 0 || static_cast<std::uint64_t>(*corner) >= vertex_count_) {
            throw missing_vertex(face, *corner, vertex_count_);
          }
          faces.corners.push_back(static_cast<std::uint32_t>(*corner));
        }
        if (element.holds_strips()) {
          split_strip(first);
        } else {
          faces.ends.push_back(faces.corners.size());
        }
      }
    }
  }

  /// Makes faces of the strip whose corners stand at the end of the list. Every other triangle of a strip turns the
  /// other way round; those that name a vertex twice only lead to the next one.
  void split_strip(std::size_t first) {
    FaceLists& faces = soup_.faces;
    const std::vector<std::uint32_t> strip(faces.corners.begin() + static_cast<std::ptrdiff_t>(first),
                                           faces.corners.end());
    faces.corners.resize(first);
    for (std::size_t i = 2; i < strip.size(); ++i) {
      const std::uint32_t a = strip[i - 2], b = strip[i - 1], c = strip[i];
      if (a == b || b == c || c == a) continue;
      faces.corners.insert(faces.corners.end(), {i % 2 == 0 ? a : b, i % 2 == 0 ? b : a, c});
      faces.ends.push_back(faces.corners.size());
    }
  }

  std::string_view rest_;
  bool is_text_;
  ByteOrder byte_order_;
  std::size_t vertex_count_;
  Soup soup_;
};

}  // namespace

Soup read_ply(std::string_view file) {
  const PlyHeader header = take_ply_header(file);
  PlyReader reader(file, header);
  for (const PlyElement& element : header.elements) reader.read(element);
  return reader.take_soup();
}

}  // namespace limber::io
