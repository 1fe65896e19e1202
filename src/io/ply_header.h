// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "io/soup.h"

/// The header of a PLY file: which elements follow and what each of them consists of.
namespace limber::io {

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

/// Takes the header off the front of `rest`.
///
/// Promise  There is one element of vertices, with one number x, y and z each, and at most one of faces or
///          strips, with one list of integer vertex indices. The header's names refer to the file's bytes.
Result<PlyHeader> take_ply_header(std::string_view& rest);

}  // namespace limber::io
