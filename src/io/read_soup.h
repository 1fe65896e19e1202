// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "limber/base.h"
#include "limber/math.h"

/// What a file holds before anything is triangulated or shared. Errors of this header name no file: the public
/// functions put the path in front.
namespace limber::io {

/// Faces of any number of corners, one after the other.
struct FaceLists {
  std::vector<std::uint32_t> corners;
  std::vector<std::size_t> ends;  ///< where each face ends in `corners`; it starts where the face before it ends

  std::size_t size() const { return ends.size(); }
  std::span<const std::uint32_t> operator[](std::size_t face) const {
    const std::size_t begin = face == 0 ? 0 : ends[face - 1];
    return std::span(corners).subspan(begin, ends[face] - begin);
  }
};

struct Soup {
  std::vector<Vec3> positions;
  FaceLists faces;
};

/// Adds a face whose corners count from `first_vertex`.
///
/// Errors   `index_out_of_range` when a corner is negative or not below `vertex_count`; `where` is the face.
template <typename Corners>
Result<void> add_face(FaceLists& faces, const Corners& corners, std::size_t first_vertex, std::size_t vertex_count) {
  for (const auto corner : corners) {
    if (corner < 0 || static_cast<std::uint64_t>(corner) >= vertex_count) {
      return Error{ErrorCode::index_out_of_range,
                   "face " + std::to_string(faces.size()) + " names vertex " + std::to_string(corner) +
                       ", but there are only " + std::to_string(vertex_count) + " vertices",
                   faces.size()};
    }
    faces.corners.push_back(static_cast<std::uint32_t>(first_vertex + static_cast<std::size_t>(corner)));
  }
  faces.ends.push_back(faces.corners.size());
  return {};
}

/// OBJ, PLY, OFF and STL text by way of CGAL, from the bytes of the file.
Result<Soup> read_obj(std::string_view file);
Result<Soup> read_ply(std::string_view file);
Result<Soup> read_off(std::string_view file);
Result<Soup> read_stl_text(std::string_view file);

/// Binary STL and glTF by way of Assimp. glTF is read from its path because it may name further files.
Result<Soup> read_stl_binary(std::string_view file);
Result<Soup> read_gltf(const std::filesystem::path& path, std::string_view file);

}  // namespace limber::io
