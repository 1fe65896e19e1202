// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/soup.h"
#include "limber/io.h"

/// From a soup to a mesh: which vertices become one, and how faces become triangles.
namespace limber::io {

/// Which vertices of a file become one, as ReadOptions has it, in one frame or in several.
class Welding {
 public:
  Welding(const Soup& first_frame, const ReadOptions& options);

  /// Whether any two vertices are one.
  bool joins_any() const;

  /// Parts the vertices that are apart in a further frame. Pre: it has as many vertices as the first one.
  void part(std::span<const Vec3> frame);

  /// Welded vertices are numbered in order of first appearance.
  Weld result() const;

 private:
  /// Joins the firsts of `equal_to_` that are within the tolerance of each other.
  void join_near(std::span<const Vec3> positions, std::span<const std::uint32_t> part_of_vertex);

  // For each vertex the first one, itself or an earlier one, ...
  std::vector<VertexId> equal_to_;   // that is at an equal position in every frame
  std::vector<VertexId> joined_to_;  // that it is joined to, within the tolerance in every frame; empty without one
  double tolerance_;
};

/// Whether vertices at these positions may be one.
bool are_together(const Vec3& p, const Vec3& q, double tolerance);

/// Splits faces into triangles, k - 2 for k corners.
///
/// Every edge of the face belongs to one triangle, every other edge to two, so triangles are as closed as faces. They
/// keep the face's direction. Which corner a face starts with does not change what the triangles of a face cover that
/// neither crosses nor touches itself.
class PolygonTriangles {
 public:
  explicit PolygonTriangles(std::span<const Vec3> positions) : positions_(positions) {}

  /// Corners of triangles as indices into `face`, three each. A face is looked at in the coordinate plane that its
  /// normal is closest to. Where the fan of its first corner stays in the face, this is it; otherwise it is cut into
  /// ears, decided exactly. Corners may repeat or lie within edges, so a face may touch itself there or go back along
  /// its edges. Faces that cross themselves or have no area are cut in some way.
  ///
  /// Errors   `too_large` naming the face, once all faces together have taken `mesh_file_limits::corner_tests`.
  std::span<const std::uint32_t> split(std::span<const std::uint32_t> face, std::size_t number);

 private:
  /// +1 where three corners turn as the face does.
  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  /// Whether two corners lie above each other.
  bool are_equal(std::uint32_t a, std::uint32_t b) const;
  /// Whether two corners of the triangle at a corner are equal.
  bool covers_nothing(std::uint32_t corner) const;
  /// Whether the triangle at a corner is in the face: a convex corner, and no other corner is in it or on it.
  bool is_ear(std::uint32_t corner);
  void cut_ears();
  /// Cuts what is left of a ring of so many corners, one of which is given.
  void cut_ring(std::uint32_t corner, std::uint32_t left);
  /// Cuts off an edge, and a corner that comes to it from inside of the face, as a triangle without area. This parts
  /// the ring in two, of which it cuts the smaller one and leaves the other. Whether there is such a corner.
  bool cut_touching(std::uint32_t& corner, std::uint32_t& left);

  std::span<const Vec3> positions_;
  std::span<const std::uint32_t> face_;
  std::size_t axis_ = 0;                    // the coordinate that is left out
  int direction_ = 0;                       // of the face in the plane of the others
  std::vector<std::uint32_t> next_, prev_;  // corners that are left, in a ring
  std::vector<bool> is_convex_;
  std::vector<std::uint32_t> triangles_;
  std::uint64_t test_count_ = 0;
};

}  // namespace limber::io
