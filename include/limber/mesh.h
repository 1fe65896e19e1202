// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "limber/base.h"
#include "limber/geometry.h"
#include "limber/math.h"

/// Triangle meshes: positions and index triples, any triangle soup.
namespace limber {

/// Three corners of a triangle as indices into a mesh's positions.
using Corners = std::array<VertexId, 3>;

/// A non-owning view of a mesh.
///
/// Pre      Every corner names one of the positions; positions are finite and at most `max_coordinate` in size.
struct MeshView {
  std::span<const Vec3> positions;
  std::span<const Corners> triangles;

  Triangle triangle(TriangleId id) const {
    const Corners& c = triangles[id];
    return {positions[c[0]], positions[c[1]], positions[c[2]]};
  }
};

/// Checks what a MeshView promises, and that there is at least one triangle.
///
/// Errors   The first offence: `empty_mesh`, `non_finite`, `too_large` or `index_out_of_range`, with `where`.
/// Cost     O(vertices + triangles).
LIMBER_API Result<void> check_mesh(MeshView mesh);

/// Checks positions alone. Errors: `non_finite` or `too_large`, with the index of the first bad one.
LIMBER_API Result<void> check_positions(std::span<const Vec3> positions);

/// Positions as other programs keep them: float32 or float64, packed or with a stride. Does not own them.
///
/// Alias    Coordinates need no alignment.
class PositionsView {
 public:
  /// The coordinates x, y, z of each vertex one after the other. Throws std::invalid_argument unless there are three a
  /// vertex.
  LIMBER_API static PositionsView packed(std::span<const float> coordinates);
  LIMBER_API static PositionsView packed(std::span<const double> coordinates);
  /// x, y, z of vertex i start at `first` + i * `stride_bytes` bytes. Throws std::invalid_argument for a stride that
  /// no memory has, such as a negative one that was converted.
  LIMBER_API static PositionsView strided(const float* first, std::size_t count, std::size_t stride_bytes);
  LIMBER_API static PositionsView strided(const double* first, std::size_t count, std::size_t stride_bytes);

  std::size_t size() const { return count_; }
  /// Pre: i < size().
  LIMBER_API Vec3 operator[](std::size_t i) const;
  /// Writes them to `positions`. Pre: as many as size().
  LIMBER_API void copy_to(std::span<Vec3> positions) const;

 private:
  PositionsView(const void* first, std::size_t count, std::size_t stride_bytes, bool is_float32)
      : first_(static_cast<const unsigned char*>(first)),
        count_(count),
        stride_bytes_(stride_bytes),
        is_float32_(is_float32) {}

  const unsigned char* first_;
  std::size_t count_, stride_bytes_;
  bool is_float32_;
};

/// A mesh that owns its arrays and is known to be sound.
///
/// Shape    n >= 1 triangles over v positions. Degenerate, duplicate, coplanar and intersecting triangles, unreferenced
///          and repeated vertices, open and non-manifold edges are all ordinary.
/// Unit     Positions are in any length unit; meshes that meet in a query share it.
class Mesh {
 public:
  /// Takes the arrays over when they are sound.
  ///
  /// Errors   As check_mesh().
  LIMBER_API static Result<Mesh> create(std::vector<Vec3> positions, std::vector<Corners> triangles);
  LIMBER_API static Result<Mesh> create(const PositionsView& positions, std::vector<Corners> triangles);

  const std::vector<Vec3>& positions() const { return positions_; }
  const std::vector<Corners>& triangles() const { return triangles_; }
  Triangle triangle(TriangleId id) const { return view().triangle(id); }
  MeshView view() const { return {positions_, triangles_}; }
  operator MeshView() const { return view(); }
  /// Whether the triangles have no boundary: each edge, by vertex ids, is run through as often in one direction as in
  /// the other. Each face then has an outside, where its corners run counter-clockwise. It is as the triangles say: a
  /// mesh that was wound inside out has its outside inside.
  ///
  /// Promise  True for every such mesh; for another one with a probability of 2^-64, by a hash of its edges.
  bool is_closed() const { return is_closed_; }

  /// Replaces one position.
  ///
  /// Errors   `index_out_of_range`, `non_finite`, `too_large`; the mesh is then as before, as for the functions below.
  LIMBER_API Result<void> set_position(VertexId id, const Vec3& position);
  /// Replaces the positions with the given ids; the last entry counts where an id is repeated.
  ///
  /// Alias    `positions` may be a part of this mesh's own: they are read before any is replaced.
  /// Errors   `size_mismatch`; `index_out_of_range`, `non_finite`, `too_large` with the entry's index.
  LIMBER_API Result<void> set_positions(std::span<const VertexId> ids, std::span<const Vec3> positions);
  /// Replaces all positions. Errors as above.
  LIMBER_API Result<void> set_positions(std::span<const Vec3> positions);

 private:
  friend struct MeshWriter;  // for the library's own use
  Mesh(std::vector<Vec3> positions, std::vector<Corners> triangles);
  std::vector<Vec3> positions_;
  std::vector<Corners> triangles_;
  bool is_closed_;
};

/// Which vertices are at equal positions; -0 equals 0. Welding makes one vertex of them.
struct [[nodiscard]] Weld {
  std::vector<VertexId> welded_of;  ///< for each vertex, the welded one that it becomes
  std::vector<VertexId> first_of;   ///< for each welded vertex, the first vertex that is there
};

/// Finds equal positions. Welded vertices are numbered in order of first appearance.
///
/// Throws   std::invalid_argument if a coordinate is not a number, or if there are 2^32 - 1 positions or more;
///          std::bad_alloc.
/// Cost     O(n log n).
LIMBER_API Weld weld(std::span<const Vec3> positions);

struct [[nodiscard]] WeldedMesh {
  Mesh mesh;
  Weld vertices;  ///< of the mesh that was welded
};

/// Makes one vertex of those at equal positions, as queries need it that go by vertex ids: is_closed(), ClosedSurface,
/// and what neighbors are. A soup of triangles, whose corners are vertices of their own, becomes a surface.
///
/// Shape    Triangles keep their ids and the order of their corners. Those with two corners in one place name a vertex
///          twice. Vertices of no triangle stay.
/// Throws   std::invalid_argument if the mesh has been moved from; std::bad_alloc.
/// Cost     As weld() of its positions, and O(triangles).
LIMBER_API WeldedMesh weld(const Mesh& mesh);

}  // namespace limber
