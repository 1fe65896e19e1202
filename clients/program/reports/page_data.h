// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "answers/answers.h"
#include "command/output.h"
#include "limber/mesh.h"

/// Meshes and numbers as a page carries them: few bytes, in base64. clients/pages/shared/decode.ts reads them back.
namespace limber::program {

using Bytes = std::vector<std::uint8_t>;

std::string base64_of(std::span<const std::uint8_t> bytes);

/// Appends a count in groups of 7 bits, the lowest first; every group but the last has its highest bit set.
void append_count(Bytes& bytes, std::uint64_t count);

/// Numbers as low + step * k, where k is a whole number of 24 bits.
///
/// Promise  Each is off by at most half a step, up to rounding; the step is the range of the numbers / (2^24 - 1).
/// Pre      There is one; all are finite, as is their range.
Json quantized(std::span<const double> numbers);

/// Points, quantized coordinate by coordinate: each of the three has its own low and step.
Json quantized(std::span<const Vec3> points);

/// Ids that increase, as the differences between them.
Json increasing_ids(std::span<const std::uint32_t> ids);

/// Both points of a witness, then triangles and faces: of a, of b; null where there is none.
Json flat_witness(const std::optional<FoundWitness>& witness);

/// What was asked for, as every page tells it.
Json settings_of(const DistanceOptions& options, const std::optional<double>& min_clearance);

/// Moves what stands under these names to the ends of lists under the same names; null where there is nothing.
template <typename Names>
void append_row(Json& lists, Json row, const Names& names) {
  for (const char* const name : names) lists[name].push_back(std::move(row[name]));
}

/// What a page says of what stands somewhere: names, files as typed, numbers of models, and poses.
inline constexpr std::array part_names = {"name", "file", "model", "poses"};

/// The triangles of a mesh, over vertices that are numbered anew: in the order in which triangles first name them.
/// Vertices without a triangle are left out.
struct PageTriangles {
  std::vector<VertexId> vertices;  ///< by number in the page
  Bytes corners;                   ///< of each corner: the number of vertices named before it minus the vertex

  explicit PageTriangles(MeshView mesh);

  /// What belongs to the vertices, in the page's order.
  template <typename T>
  std::vector<T> in_order(std::span<const T> of_vertices) const {
    std::vector<T> ordered;
    ordered.reserve(vertices.size());
    for (const VertexId v : vertices) ordered.push_back(of_vertices[v]);
    return ordered;
  }
};

/// The positions of a deforming mesh in many frames: whole multiples of one step, and of these the differences from one
/// frame to the next. Every 32nd frame stands for itself, so that a page can start there.
///
/// Promise  Coordinates are off by at most half a step, which is 2^-16 of the diagonal of the first frame's box.
class PositionFrames {
 public:
  /// Pre: there is a position.
  explicit PositionFrames(std::span<const Vec3> first);

  /// Pre      As many positions as in the first frame.
  /// Errors   BadInput where a position is so far from the first frame that it has no place in a picture with it.
  void add(std::span<const Vec3> positions);

  /// Keeps the first of every two frames.
  void drop_every_second();

  std::size_t byte_count() const { return byte_count_; }

  /// `low`, `step`, `run` (how many frames from one that stands for itself to the next) and `data`, a text for each
  /// frame. Written are counts, for the coordinates one after the other: where k coordinates are as expected, 0 and k;
  /// else 2 d for a difference d > 0 from what is expected, and -2 d - 1 for d < 0. Expected is the coordinate in the
  /// frame before; in a frame that stands for itself, that of the vertex before.
  Json to_json() const;

 private:
  using Steps = std::vector<std::int64_t>;

  Steps steps_of(std::span<const Vec3> positions) const;
  Steps expected(const Steps& steps) const;
  void append(const Steps& steps);

  Vec3 low_;
  double step_ = 1;
  std::vector<Bytes> frames_;
  std::size_t byte_count_ = 0;
  Steps last_;  // the frame that was added last
};

/// Poses as twelve float64 each: the rows of the rotation, then the translation. The lowest byte of each comes first.
Json poses_json(std::span<const Transform> poses);

}  // namespace limber::program
