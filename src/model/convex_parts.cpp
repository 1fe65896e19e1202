// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/convex_parts.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/access.h"
#include "base/check.h"
#include "geometry/primitives.h"
#include "model/model_impl.h"

namespace limber::model {

/// Which vertices triangles use, and the number of each among these.
struct ConvexParts::UsedVertices {
  explicit UsedVertices(const Mesh& mesh) : corner_of(mesh.positions().size(), no_id) {
    for (const Corners& triangle : mesh.triangles()) {
      for (const VertexId v : triangle) corner_of[v] = 0;
    }
    for (VertexId v = 0; v < corner_of.size(); ++v) {
      if (corner_of[v] != no_id) corner_of[v] = static_cast<std::uint32_t>(vertices.size()), vertices.push_back(v);
    }
    for (const Corners& t : mesh.triangles()) triangles.push_back({corner_of[t[0]], corner_of[t[1]], corner_of[t[2]]});
  }

  std::vector<VertexId> vertices;
  std::vector<std::uint32_t> corner_of;
  std::vector<Corners> triangles;
};

ConvexParts::ConvexParts(const Model& model) : ConvexParts(model, UsedVertices(model.mesh())) {}

ConvexParts::ConvexParts(const Model& model, const UsedVertices& used)
    : surface_id_(Access::impl(model).surface_id),
      moved_vertices_(Access::impl(model).stats.moved_vertices),
      triangles_(used.triangles),
      neighbors_(used.vertices.size(),
                 [&](const auto& add) {
                   // Where the surface is closed, the triangle next to an edge lists its other direction.
                   const bool is_closed = model.mesh().is_closed();
                   for (const Corners& t : used.triangles) {
                     for (std::size_t k = 0; k < 3; ++k) {
                       add(t[k], t[geometry::next_corner[k]]);
                       if (!is_closed) add(t[geometry::next_corner[k]], t[k]);
                     }
                   }
                 }),
      triangles_of_(used.vertices.size(), [&](const auto& add) {
        for (TriangleId t = 0; t < used.triangles.size(); ++t) {
          for (const std::uint32_t corner : used.triangles[t]) add(corner, t);
        }
      }) {
  const double part = 1. / static_cast<double>(used.vertices.size());
  for (const VertexId v : used.vertices) {
    positions_.push_back(model.mesh().positions()[v]);
    center_ += part * positions_.back();
  }
}

bool ConvexParts::is_of(const Model& model) const {
  const Model::Impl& impl = Access::impl(model);
  return impl.surface_id == surface_id_ && impl.stats.moved_vertices == moved_vertices_;
}

ConvexParts::Support ConvexParts::scan(const Vec3& direction) const {
  Support best{0, -std::numeric_limits<double>::infinity()};
  std::uint32_t corner = 0;
  for (const Vec3& p : positions_) {
    const double height = dot(direction, p);
    if (height > best.height) best = {corner, height};
    ++corner;
  }
  return best;
}

ConvexParts::Support ConvexParts::climb(const Vec3& direction, std::uint32_t start) const {
  LIMBER_ASSERT(start < count());
  Support best{start, dot(direction, position(start))};
  for (std::uint32_t from = no_id; from != best.corner;) {
    from = best.corner;
    for (const std::uint32_t next : neighbors_.of(from)) {
      const double height = dot(direction, position(next));
      if (height > best.height) best = {next, height};
    }
  }
  return best;
}

bool ConvexParts::has_corners(TriangleId t, std::span<const std::uint32_t> corners) const {
  const Corners& has = triangles_[t];
  return std::all_of(corners.begin(), corners.end(),
                     [&](std::uint32_t corner) { return corner == has[0] || corner == has[1] || corner == has[2]; });
}

TriangleId ConvexParts::triangle_at(std::span<const std::uint32_t> corners, const Vec3& point) const {
  const std::span<const TriangleId> around = triangles_of_.of(corners[0]);
  for (const TriangleId t : around) {
    if (has_corners(t, corners)) return t;
  }
  // The corners are those of a face of several triangles. The triangles around a corner go on to where the point is.
  constexpr int most_rounds = 16;
  TriangleId nearest = around[0];
  double least = std::numeric_limits<double>::infinity();
  std::uint32_t at = corners[0];
  for (int round = 0; round < most_rounds && least > 0; ++round) {
    const double before = least;
    for (const TriangleId t : triangles_of_.of(at)) {
      const Triangle triangle{position(triangles_[t][0]), position(triangles_[t][1]), position(triangles_[t][2])};
      const double distance = geometry::closest_on(triangle, point).distance;
      if (distance < least) least = distance, nearest = t;
    }
    if (least == before) break;
    const auto is_farther = [&](std::uint32_t i, std::uint32_t j) {
      return length_sq(position(i) - point) < length_sq(position(j) - point);
    };
    at = *std::min_element(triangles_[nearest].begin(), triangles_[nearest].end(), is_farther);
  }
  return nearest;
}

}  // namespace limber::model
