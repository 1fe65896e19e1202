// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "io/prepare.h"
#include "io/text_scan.h"

namespace limber::io {
namespace {

enum class Encoding { ascii, little_endian, big_endian };

struct ScalarType {
  std::size_t byte_count = 0;
  bool is_signed = false;
  bool is_float = false;
};

struct Property {
  std::string_view name;
  ScalarType type;
  std::optional<ScalarType> size_type;  // of a list
};

struct Element {
  std::string_view name;
  std::size_t count = 0;
  std::vector<Property> properties;

  bool holds_vertices() const { return name == "vertex" || name == "vertices"; }
  bool holds_faces() const { return name == "face" || name == "faces"; }
};

struct Header {
  Encoding encoding{};
  std::string_view encoding_name;
  std::vector<Element> elements;
};

bool is_corner_list(const Property& property) {
  return property.size_type && (property.name == "vertex_indices" || property.name == "vertex_index");
}

std::optional<ScalarType> scalar_type(std::string_view word) {
  struct Named {
    std::string_view name, sized_name;
    ScalarType type;
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

Result<Property> parse_property(std::string_view words) {
  Property property;
  std::string_view type_name = take_word(words);
  if (type_name == "list") {
    property.size_type = scalar_type(take_word(words));
    if (!property.size_type || property.size_type->is_float) return malformed("has a list whose sizes are no integers");
    type_name = take_word(words);
  }
  const std::optional<ScalarType> type = scalar_type(type_name);
  if (!type) return malformed(quoted(type_name) + " is not a PLY type");
  property.type = *type;
  property.name = take_word(words);
  return property;
}

/// Takes the header off the front of `rest`.
Result<Header> take_header(std::string_view& rest) {
  Header header;
  std::string_view words = take_line(rest);
  if (take_word(words) != "ply") return malformed("does not start with ply");
  while (!rest.empty()) {
    words = take_line(rest);
    const std::string_view keyword = take_word(words);
    if (keyword == "format") {
      header.encoding_name = take_word(words);
      header.encoding = header.encoding_name == "ascii"                  ? Encoding::ascii
                        : header.encoding_name == "binary_little_endian" ? Encoding::little_endian
                                                                         : Encoding::big_endian;
      if (header.encoding == Encoding::big_endian && header.encoding_name != "binary_big_endian") {
        return malformed(quoted(header.encoding_name) + " is not a PLY encoding");
      }
    } else if (keyword == "element") {
      const std::string_view name = take_word(words);
      const auto count = integer<std::uint32_t>(take_word(words));
      if (!count) return malformed("element " + quoted(name) + " has no count that fits 32 bits");
      header.elements.push_back({name, *count, {}});
    } else if (keyword == "property") {
      if (header.elements.empty()) return malformed("has a property before the first element");
      const Result<Property> property = parse_property(words);
      if (!property) return property.error();
      header.elements.back().properties.push_back(*property);
    } else if (keyword == "end_header") {
      if (header.encoding_name.empty()) return malformed("has no format line");
      return header;
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      return malformed(quoted(keyword) + " is not a PLY header keyword");
    }
  }
  return malformed("ends inside its header");
}

/// Walks over the data and copies what is of use.
class Copier {
 public:
  Copier(std::string_view data, Encoding encoding, std::string& out) : rest_(data), encoding_(encoding), out_(out) {}

  Result<void> copy(const Element& element) {
    if (element.holds_vertices()) return copy_vertices(element);
    if (element.holds_faces()) return copy_faces(element);
    for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      for (const Property& property : element.properties) {
        if (!skip(property)) return truncated(element, i);
      }
    }
    return {};
  }

 private:
  static Error truncated(const Element& element, std::size_t at) {
    return malformed(std::string(element.name), at,
                     "the file ends here or holds a bad value, it promises " + std::to_string(element.count));
  }

  /// The next value as it stands in the file: a word or some bytes. Empty at the end.
  std::string_view take(ScalarType type) {
    if (encoding_ == Encoding::ascii) return take_word(rest_);
    if (rest_.size() < type.byte_count) return {};
    const std::string_view bytes = rest_.substr(0, type.byte_count);
    rest_.remove_prefix(type.byte_count);
    return bytes;
  }

  std::optional<std::int64_t> take_integer(ScalarType type) {
    const std::string_view raw = take(type);
    if (encoding_ == Encoding::ascii) return integer<std::int64_t>(raw);
    if (raw.empty()) return {};
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const std::size_t at = encoding_ == Encoding::big_endian ? i : raw.size() - 1 - i;
      bits = (bits << 8U) | static_cast<unsigned char>(raw[at]);
    }
    const std::uint64_t sign = std::uint64_t{1} << (8 * raw.size() - 1);
    if (type.is_signed && (bits & sign) != 0)
      return static_cast<std::int64_t>(bits) - static_cast<std::int64_t>(2 * sign);
    return static_cast<std::int64_t>(bits);
  }

  void append_integer(std::uint32_t value) {
    if (encoding_ == Encoding::ascii) {
      out_.append(std::to_string(value)).append(1, ' ');
      return;
    }
    for (unsigned i = 0; i < 4; ++i) {
      const unsigned shift = encoding_ == Encoding::big_endian ? 24 - 8 * i : 8 * i;
      out_ += static_cast<char>((value >> shift) & 0xffU);
    }
  }

  bool skip(const Property& property) {
    std::int64_t size = 1;
    if (property.size_type) {
      const auto read = take_integer(*property.size_type);
      if (!read || *read < 0) return false;
      size = *read;
    }
    for (; size > 0; --size) {
      if (take(property.type).empty()) return false;
    }
    return true;
  }

  Result<void> copy_vertices(const Element& element) {
    for (std::size_t vertex = 0; vertex < element.count; ++vertex) {
      std::array<std::string_view, 3> position;
      for (const Property& property : element.properties) {
        const std::size_t axis = property.name == "x" ? 0 : property.name == "y" ? 1 : property.name == "z" ? 2 : 3;
        if (axis == 3) {
          if (!skip(property)) return truncated(element, vertex);
          continue;
        }
        position[axis] = take(property.type);
        if (position[axis].empty()) return truncated(element, vertex);
      }
      for (const std::string_view coordinate : position) {
        out_.append(coordinate);
        if (encoding_ != Encoding::ascii) continue;
        if (Result<void> checked = check_coordinate(coordinate, vertex); !checked) return checked;
        out_ += ' ';
      }
    }
    return {};
  }

  Result<void> copy_faces(const Element& element) {
    for (std::size_t face = 0; face < element.count; ++face) {
      for (const Property& property : element.properties) {
        if (!is_corner_list(property)) {
          if (!skip(property)) return truncated(element, face);
          continue;
        }
        const auto size = take_integer(*property.size_type);
        if (!size || *size < 0 || static_cast<std::uint64_t>(*size) > rest_.size()) return truncated(element, face);
        append_integer(static_cast<std::uint32_t>(*size));
        for (std::int64_t i = 0; i < *size; ++i) {
          const auto corner = take_integer(property.type);
          if (!corner) return truncated(element, face);
          if (*corner < 0 || *corner > 0xffff'ffff) {
            return Error{ErrorCode::index_out_of_range,
                         "face " + std::to_string(face) + " names vertex " + std::to_string(*corner), face};
          }
          append_integer(static_cast<std::uint32_t>(*corner));
        }
      }
    }
    return {};
  }

  std::string_view rest_;
  Encoding encoding_;
  std::string& out_;
};

/// The lines of the new header for an element; none when it carries nothing for us.
Result<std::string> element_header(const Element& element) {
  const auto count_named = [&](auto&& has_name) {
    return std::count_if(element.properties.begin(), element.properties.end(), has_name);
  };
  std::string text = "element " + std::string(element.name) + " " + std::to_string(element.count) + "\n";
  if (element.holds_vertices()) {
    for (const char* axis : {"x", "y", "z"}) {
      const auto is_axis = [&](const Property& property) { return property.name == axis; };
      const auto found = std::find_if(element.properties.begin(), element.properties.end(), is_axis);
      if (count_named(is_axis) != 1 || found->size_type || !found->type.is_float) {
        return malformed(std::string("has no vertex coordinate ") + axis + " of type float or double");
      }
      text += std::string("property ") + (found->type.byte_count == 8 ? "double " : "float ") + axis + "\n";
    }
  } else if (element.holds_faces()) {
    if (count_named(is_corner_list) != 1) return malformed("has faces without a list vertex_indices");
    if (std::find_if(element.properties.begin(), element.properties.end(), is_corner_list)->type.is_float) {
      return malformed("has vertex indices that are no integers");
    }
    text += "property list uint uint vertex_indices\n";
  } else {
    text.clear();
  }
  return text;
}

}  // namespace

// Kept from CGAL's reader: counts and list sizes it would allocate for, or loop over, after the end of the file;
// coordinates that are missing or integers; indices of 8 or 16 bits; further properties of the same name or of a type
// it does not know, for which it reads nothing and so loses step; values of other properties that are not finite.
Result<std::string> prepare_ply(std::string_view file) {
  const Result<Header> header = take_header(file);
  if (!header) return header.error();
  std::string text = "ply\nformat " + std::string(header->encoding_name) + " 1.0\n";
  bool has_vertices = false;
  for (const Element& element : header->elements) {
    const Result<std::string> lines = element_header(element);
    if (!lines) return lines.error();
    text += *lines;
    has_vertices |= element.holds_vertices();
  }
  if (!has_vertices) return malformed("has no vertices");
  text += "end_header\n";
  Copier copier(file, header->encoding, text);
  for (const Element& element : header->elements) {
    if (Result<void> copied = copier.copy(element); !copied) return copied.error();
  }
  return text;
}

}  // namespace limber::io
