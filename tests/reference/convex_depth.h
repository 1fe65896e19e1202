// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "limber/mesh.h"

namespace limber::reference {

/// The brute-force twin of convex_depth(), of cores that meet, in float64 or in rational numbers: the border of their
/// Minkowski difference has the normals of faces and of pairs of edges; along each, all corners are looked at.
template <typename Number>
class LeastDepth {
 public:
  using Vector = std::array<Number, 3>;

  /// Vertices as placed.
  LeastDepth(const std::vector<Vec3>& a, const std::vector<Corners>& triangles_a, const std::vector<Vec3>& b,
             const std::vector<Corners>& triangles_b)
      : a_(corners_of(a, triangles_a)), b_(corners_of(b, triangles_b)) {
    const std::vector<Vector> edges_a = edges_of(a, triangles_a), edges_b = edges_of(b, triangles_b);
    for (std::size_t i = 0; i < edges_a.size(); i += 3) look_along(edges_a[i], edges_a[i + 1]);
    for (std::size_t i = 0; i < edges_b.size(); i += 3) look_along(edges_b[i], edges_b[i + 1]);
    for (const Vector& e : edges_a) {
      for (const Vector& f : edges_b) look_along(e, f);
    }
  }

  /// The square of the depth; 0 where no direction has been found, as for bodies in a line.
  Number depth_sq() const { return least_.value_or(Number(0)); }

 private:
  static Vector minus(const Vector& p, const Vector& q) { return {p[0] - q[0], p[1] - q[1], p[2] - q[2]}; }
  static Number dot(const Vector& p, const Vector& q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; }
  static Vector vector(const Vec3& p) { return {Number(p.x), Number(p.y), Number(p.z)}; }
  static std::vector<Vector> corners_of(const std::vector<Vec3>& positions, const std::vector<Corners>& triangles) {
    std::vector<Vector> corners;
    for (const Corners& t : triangles) {
      for (const VertexId v : t) corners.push_back(vector(positions[v]));
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    return corners;
  }
  static std::vector<Vector> edges_of(const std::vector<Vec3>& positions, const std::vector<Corners>& triangles) {
    std::vector<Vector> edges;
    for (const Corners& t : triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        edges.push_back(minus(vector(positions[t[(k + 1) % 3]]), vector(positions[t[k]])));
      }
    }
    return edges;
  }
  void look_along(const Vector& e, const Vector& f) {
    const Vector normal{e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
    const Number size_sq = dot(normal, normal);
    if (!(size_sq > Number(1e-24) * dot(e, e) * dot(f, f))) return;
    const auto is_lower = [&](const Vector& p, const Vector& q) { return dot(normal, p) < dot(normal, q); };
    const auto [low_a, high_a] = std::minmax_element(a_.begin(), a_.end(), is_lower);
    const auto [low_b, high_b] = std::minmax_element(b_.begin(), b_.end(), is_lower);
    for (const Number& height : {dot(normal, minus(*high_a, *low_b)), dot(normal, minus(*high_b, *low_a))}) {
      const Number depth_sq = height > Number(0) ? Number(height * height / size_sq) : Number(0);
      if (!least_ || depth_sq < *least_) least_ = depth_sq;
    }
  }

  std::vector<Vector> a_, b_;
  std::optional<Number> least_;
};

}  // namespace limber::reference
