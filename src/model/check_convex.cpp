// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/check_convex.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "mesh/adjacency.h"

namespace limber::model {
namespace {

using geometry::next_corner;

Error not_convex(const std::string& text, std::size_t where) {
  return {ErrorCode::not_convex, "the mesh is not convex: " + text, where};
}

std::string name_of(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

double height_over(const Triangle& t, const Vec3& p) {
  const Vec3 normal = cross(geometry::near_unit(t.v1 - t.v0), geometry::near_unit(t.v2 - t.v0));
  return normal == Vec3{} ? 0 : std::abs(dot(geometry::unit(normal), p - t.v0));
}

/// Decides for the triangles of one mesh.
class ConvexityCheck {
 public:
  ConvexityCheck(const Mesh& mesh, double max_concavity)
      : mesh_(mesh), triangles_(mesh.triangles()), max_concavity_(max_concavity) {
    std::vector<bool> is_used(mesh.positions().size());
    for (const Corners& t : triangles_) {
      for (const VertexId v : t) is_used[v] = true;
    }
    for (VertexId v = 0; v < is_used.size(); ++v) {
      if (is_used[v]) vertices_.push_back(v);
    }
  }

  Result<bool> run() {
    const auto is_less = [&](VertexId v, VertexId w) { return geometry::lexicographically_less(at(v), at(w)); };
    const auto [least, most] = std::minmax_element(vertices_.begin(), vertices_.end(), is_less);
    const VertexId p = *least, q = *most;
    const auto off_line = std::find_if(vertices_.begin(), vertices_.end(),
                                       [&](VertexId v) { return !geometry::are_collinear(at(p), at(q), at(v)); });
    if (off_line == vertices_.end()) return check_segment();
    const Triangle plane{at(p), at(q), at(*off_line)};
    const bool is_flat = std::all_of(vertices_.begin(), vertices_.end(), [&](VertexId v) {
      return geometry::orient3d(plane.v0, plane.v1, plane.v2, at(v)) == 0 ||
             height_over(plane, at(v)) <= max_concavity_;
    });
    if (is_flat) {
      return check_polygon(*geometry::faithful_axis(at(p), at(q), at(*off_line)));
    }
    if (auto closed = mesh::check_closed(mesh_); !closed) return closed.error();
    return check_solid();
  }

 private:
  const Vec3& at(VertexId v) const { return mesh_.positions()[v]; }
  /// All in a line: the segments that triangles are have no gap between them.
  Result<bool> check_segment() const {
    std::vector<std::pair<Vec3, Vec3>> segments;
    for (const Corners& t : triangles_) {
      const auto [low, high] = std::minmax({at(t[0]), at(t[1]), at(t[2])}, [](const Vec3& p, const Vec3& q) {
        return geometry::lexicographically_less(p, q);
      });
      segments.emplace_back(low, high);
    }
    std::sort(segments.begin(), segments.end(),
              [](const auto& s, const auto& t) { return geometry::lexicographically_less(s.first, t.first); });
    Vec3 end = segments[0].second;
    for (const auto& [low, high] : segments) {
      if (geometry::lexicographically_less(end, low)) {
        return not_convex("its triangles lie in a line, with a gap of " + name_of(geometry::safe_length(low - end)), 0);
      }
      if (geometry::lexicographically_less(end, high)) end = high;
    }
    return false;
  }

  /// All in a plane: the triangles run around alike, and their outline is one that turns to one side alone.
  Result<bool> check_polygon(std::size_t axis) const {
    const auto turn = [&](VertexId u, VertexId v, VertexId w) { return geometry::orient2d(at(u), at(v), at(w), axis); };
    const int sense = turn(triangles_[0][0], triangles_[0][1], triangles_[0][2]);
    std::map<std::pair<VertexId, VertexId>, TriangleId> sides;
    for (TriangleId t = 0; t < triangles_.size(); ++t) {
      const Corners& c = triangles_[t];
      bool is_good = sense != 0 && turn(c[0], c[1], c[2]) == sense;
      for (std::size_t k = 0; k < 3; ++k) is_good &= sides.emplace(std::pair{c[k], c[next_corner[k]]}, t).second;
      if (!is_good)
        return not_convex("it is flat, and triangle " + std::to_string(t) + " has no area or lies on others", t);
    }
    std::map<VertexId, std::pair<VertexId, TriangleId>> outline;
    std::size_t length = 0;
    for (const auto& [side, t] : sides) {
      if (sides.contains({side.second, side.first})) continue;
      outline[side.first] = {side.second, t}, ++length;
    }
    // Around a convex polygon the order of coordinates changes twice.
    VertexId v = outline.begin()->first;
    std::size_t steps = 0, changes = 0;
    do {
      const auto [w, t] = outline[v];
      const auto next = outline.find(w);
      if (next == outline.end()) break;
      const VertexId x = next->second.first;
      if (turn(v, w, x) == -sense) {
        return not_convex("it is flat, and its outline is concave at vertex " + std::to_string(w), t);
      }
      changes += geometry::lexicographically_less(at(v), at(w)) != geometry::lexicographically_less(at(w), at(x));
      v = w, ++steps;
    } while (v != outline.begin()->first && steps < length);
    if (steps != length || length != outline.size() || changes != 2) {
      return not_convex("it is flat, and has more than one outline, or one that crosses itself", 0);
    }
    return false;
  }

  /// How far a vertex is in front of a triangle's plane, if that is too far; `inside` is the side that is behind it.
  std::optional<double> too_far(TriangleId t, VertexId v, int inside) const {
    const Triangle corners = mesh_.triangle(t);
    if (geometry::orient3d(corners.v0, corners.v1, corners.v2, at(v)) != -inside) return std::nullopt;
    const double height = height_over(corners, at(v));
    return height > max_concavity_ ? std::optional(height) : std::nullopt;
  }
  /// The side of its triangles on which a closed surface has its inside, by the sign of the volume.
  int inside() const {
    const Vec3& origin = at(vertices_[0]);
    double volume = 0;
    for (TriangleId t = 0; t < triangles_.size(); ++t) {
      const Triangle corners = mesh_.triangle(t);
      volume += dot(corners.v0 - origin, cross(corners.v1 - origin, corners.v2 - origin));
    }
    return volume < 0 ? 1 : -1;
  }
  static std::string in_front(VertexId v, double height, TriangleId t) {
    return "vertex " + std::to_string(v) + " is " + name_of(height) + " in front of triangle " + std::to_string(t);
  }

  /// A closed surface: all vertices are on one side of all triangles, the inner one.
  Result<bool> check_solid() const {
    const int side = inside();
    std::optional<Error> concave;
    mesh::for_each_edge(triangles_, mesh_.positions().size(), [&](VertexId low, auto sides) {
      if (concave || low == sides[0].high) return;
      const TriangleId t = sides[0].triangle;
      for (const VertexId v : triangles_[sides.back().triangle]) {
        const auto height = too_far(t, v, side);
        if (!height) continue;
        const std::string edge = "edge (" + std::to_string(low) + ", " + std::to_string(sides[0].high) + ")";
        concave = not_convex(edge + " is concave: " + in_front(v, *height, t), t);
        return;
      }
    });
    if (concave) return *concave;
    for (TriangleId t = 0; t < triangles_.size(); ++t) {
      for (const VertexId v : vertices_) {
        if (const auto height = too_far(t, v, side)) return not_convex(in_front(v, *height, t), t);
      }
    }
    return true;
  }

  const Mesh& mesh_;
  const std::vector<Corners>& triangles_;
  double max_concavity_;
  std::vector<VertexId> vertices_;
};

}  // namespace

Result<bool> check_convex(const Mesh& mesh, double max_concavity) { return ConvexityCheck(mesh, max_concavity).run(); }

}  // namespace limber::model
