// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/check.h"
#include "limber/base.h"
#include "limber/math.h"

/// What a file holds before anything is triangulated or shared.
///
/// Errors   Functions in src/io throw BadResult, which the public functions catch: nearly everything in a file can be
///          wrong, and a Result at each place would hide what is read. Unless said otherwise texts name no file, and
///          the public functions put the path in front.
namespace limber::io {

/// Faces of any number of corners, one after the other.
struct FaceLists {
  std::vector<std::uint32_t> corners;
  std::vector<std::size_t> ends;  ///< where each face ends in `corners`; it starts where the face before it ends

  std::size_t size() const { return ends.size(); }
  std::span<const std::uint32_t> operator[](std::size_t face) const {
    LIMBER_ASSERT(face < ends.size() && ends[face] <= corners.size());
    const std::size_t begin = face == 0 ? 0 : ends[face - 1];
    return std::span(corners).subspan(begin, ends[face] - begin);
  }
};

struct Soup {
  std::vector<Vec3> positions;
  FaceLists faces;
  std::vector<std::string> parts;           ///< names of the parts, those with faces only; empty if the file has none
  std::vector<std::uint32_t> part_of_face;  ///< in `parts`; empty if the file has none
};

/// Gives the bytes of a buffer file that a glTF file names, at most `max_bytes` of them.
///
/// The path is decoded and relative to the glTF file's folder; it has no "..", no root and no scheme.
using BufferSource = std::function<std::string(const std::string& path, std::uint64_t max_bytes)>;

/// One reader for each format, from the bytes of the file. Each takes time and memory in proportion to the bytes it is
/// given, whatever a header promises; glTF scenes, which may show a mesh many times, have limits of their own. Faces
/// name existing vertices. Without `external`, glTF files that name buffer files are malformed.
Soup read_obj(std::string_view file);
Soup read_off(std::string_view file);
Soup read_ply(std::string_view file);
Soup read_stl(std::string_view file);
Soup read_gltf(std::string_view file, const BufferSource& external);

/// All bytes of a regular file. Pipes, devices and sockets are refused without being read.
///
/// Errors   `unreadable_file`; `too_large` when there are more than `max_bytes`.
std::string read_regular_file(const std::filesystem::path& path, std::uint64_t max_bytes);

/// Buffer files in the folder of `mesh_file` or below it. Symbolic links that lead out of the folder are refused.
BufferSource buffers_beside(const std::filesystem::path& mesh_file);

/// A file that is not what its format says.
inline BadResult malformed(std::string reason) { return BadResult({ErrorCode::malformed_file, std::move(reason), {}}); }

/// The same at a place that can be counted: "vertex 7: reason".
inline BadResult malformed(std::string_view what, std::size_t where, std::string_view reason) {
  return BadResult(
      {ErrorCode::malformed_file, std::string(what) + " " + std::to_string(where) + ": " + std::string(reason), where});
}

/// A face that names a vertex the file does not have. `how` says how vertices are counted if not from 0.
inline BadResult missing_vertex(std::size_t face, std::int64_t vertex, std::size_t vertex_count, const char* how = "") {
  return BadResult({ErrorCode::index_out_of_range,
                    "face " + std::to_string(face) + " names vertex " + std::to_string(vertex) + how +
                        ", but there are only " + std::to_string(vertex_count) + " vertices",
                    face});
}

/// A word of the file as it may appear in a message: short and printable.
inline std::string in_quotes(std::string_view word, std::size_t max_length = 20) {
  std::string text = "'";
  for (const char c : word.substr(0, max_length)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > max_length ? "...'" : "'");
}

}  // namespace limber::io
