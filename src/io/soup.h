// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/check.h"
#include "limber/base.h"
#include "limber/math.h"

/// What a file holds before anything is triangulated or shared, and the errors of reading it. Errors of the readers
/// name no file: the public functions put the path in front.
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

inline Error malformed(std::string reason) { return {ErrorCode::malformed_file, std::move(reason), {}}; }

/// A malformed_file error at a place that can be counted: "vertex 7: reason".
inline Error malformed(std::string_view what, std::size_t where, std::string_view reason) {
  return {ErrorCode::malformed_file, std::string(what) + " " + std::to_string(where) + ": " + std::string(reason),
          where};
}

inline Error not_finite(std::size_t vertex) {
  return {ErrorCode::non_finite, "vertex " + std::to_string(vertex) + " is not finite", vertex};
}

/// A face that names a vertex the file does not have.
inline Error missing_vertex(std::size_t face, std::int64_t vertex, std::size_t vertex_count) {
  return {ErrorCode::index_out_of_range,
          "face " + std::to_string(face) + " names vertex " + std::to_string(vertex) + ", but there are only " +
              std::to_string(vertex_count) + " vertices",
          face};
}

/// A word of the file as it may appear in a message: short and printable.
inline std::string in_quotes(std::string_view word, std::size_t max_length = 20) {
  std::string text = "'";
  for (const char c : word.substr(0, max_length)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > max_length ? "...'" : "'");
}

/// Takes blanks off both ends.
std::string_view trimmed(std::string_view text);

}  // namespace limber::io
