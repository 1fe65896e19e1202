// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>

#include "base/check.h"
#include "io/byte_order.h"
#include "io/ply_header.h"
#include "io/readers.h"
#include "io/text_scan.h"

namespace limber::io {
namespace {

/// Walks over the data behind the header.
class PlyReader {
 public:
  PlyReader(std::string_view data, const PlyHeader& header)
      : rest_(data),
        is_text_(header.encoding == PlyEncoding::ascii),
        byte_order_(header.encoding == PlyEncoding::big_endian ? ByteOrder::big : ByteOrder::little),
        vertex_count_(header.vertex_count) {}

  Result<void> read(const PlyElement& element) {
    if (element.holds_vertices()) return read_vertices(element);
    if (element.holds_faces() || element.holds_strips()) return read_faces(element);
    for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      for (const PlyProperty& property : element.properties) {
        if (!skip(property)) return truncated(element, i);
      }
    }
    return {};
  }

  Soup take_soup() { return std::move(soup_); }

 private:
  static Error truncated(const PlyElement& element, std::size_t at) {
    return malformed(std::string(element.name), at,
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

  Result<void> read_vertices(const PlyElement& element) {
    constexpr std::size_t smallest_vertex_bytes = 6;  // "0 0 0 "; no more is reserved than the file can hold
    soup_.positions.reserve(std::min(element.count, rest_.size() / smallest_vertex_bytes));
    for (std::size_t vertex = 0; vertex < element.count; ++vertex) {
      Vec3 position;
      for (const PlyProperty& property : element.properties) {
        const bool is_coordinate = property.name == "x" || property.name == "y" || property.name == "z";
        if (!is_coordinate) {
          if (!skip(property)) return truncated(element, vertex);
          continue;
        }
        const std::string_view raw = take(property.type);
        if (raw.empty()) return truncated(element, vertex);
        double& coordinate = position[static_cast<std::size_t>(property.name[0] - 'x')];
        if (is_text_) {
          const Number value = number(raw);
          if (value.kind != NumberKind::finite) return bad_coordinate(raw, value.kind, vertex);
          coordinate = value.value;
        } else {
          coordinate = property.type.is_float ? float_number(raw, byte_order_)
                                              : static_cast<double>(integer_of(raw, property.type));
        }
      }
      soup_.positions.push_back(position);
    }
    return {};
  }

  Result<void> read_faces(const PlyElement& element) {
    FaceLists& faces = soup_.faces;
    faces.ends.reserve(std::min(element.count, rest_.size()));
    for (std::size_t face = 0; face < element.count; ++face) {
      for (const PlyProperty& property : element.properties) {
        if (!property.is_corner_list()) {
          if (!skip(property)) return truncated(element, face);
          continue;
        }
        const auto size = take_integer(*property.size_type);
        if (!size || *size < 0 || static_cast<std::uint64_t>(*size) > rest_.size()) return truncated(element, face);
        std::size_t first = faces.corners.size();
        for (std::int64_t i = 0; i < *size; ++i) {
          const auto corner = take_integer(property.type);
          if (!corner) return truncated(element, face);
          if (*corner == -1 && element.holds_strips()) {
            split_strip(first);
            first = faces.corners.size();
            continue;
          }
          if (*corner < 0 || static_cast<std::uint64_t>(*corner) >= vertex_count_) {
            return missing_vertex(face, *corner, vertex_count_);
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
    return {};
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

Result<Soup> read_ply(std::string_view file) {
  const Result<PlyHeader> header = take_ply_header(file);
  if (!header) return header.error();
  PlyReader reader(file, *header);
  for (const PlyElement& element : header->elements) {
    if (Result<void> read = reader.read(element); !read) return read.error();
  }
  return reader.take_soup();
}

}  // namespace limber::io
