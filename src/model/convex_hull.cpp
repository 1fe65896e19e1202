// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/convex_hull.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include "base/check.h"
#include "geometry/primitives.h"

namespace limber::model {
namespace {

/// A convex surface that grows from a tetrahedron, point by point.
class GrowingHull {
 public:
  /// Pre: the four points do not lie in one plane.
  GrowingHull(std::span<const Vec3> points, const Corners& base, VertexId apex) : points_(points) {
    const int side = side_of(base, apex);
    LIMBER_ASSERT(side != 0);
    const Corners b = side < 0 ? base : Corners{base[0], base[2], base[1]};
    faces_ = {b, {b[0], apex, b[1]}, {b[1], apex, b[2]}, {b[2], apex, b[0]}};
  }

  void add(VertexId point) {
    edges_.clear();
    std::size_t kept = 0;
    for (const Corners& face : faces_) {
      if (side_of(face, point) <= 0) {
        faces_[kept++] = face;
      } else {
        for (std::size_t i = 0; i < 3; ++i) edges_.emplace_back(face[i], face[geometry::next_corner[i]]);
      }
    }
    if (edges_.empty()) return;
    faces_.resize(kept);
    std::sort(edges_.begin(), edges_.end());
    for (const auto& [from, to] : edges_) {
      if (std::binary_search(edges_.begin(), edges_.end(), Edge{to, from})) continue;  // between two seen faces
      faces_.push_back({from, to, point});
    }
    LIMBER_ASSERT(faces_.size() >= 4);
  }

  const std::vector<Corners>& faces() const { return faces_; }

 private:
  using Edge = std::pair<VertexId, VertexId>;

  /// +1 if the point is in front of the face, so that it sees it.
  int side_of(const Corners& face, VertexId point) const {
    return geometry::orient3d(points_[face[0]], points_[face[1]], points_[face[2]], points_[point]);
  }

  std::span<const Vec3> points_;
  std::vector<Corners> faces_;
  std::vector<Edge> edges_;
};

/// The triangles, with those points alone that they use, in their order.
Hull with_used_points(std::span<const Vec3> points, std::vector<Corners> triangles, bool is_solid) {
  std::vector<VertexId> new_id(points.size(), no_id);
  for (const Corners& corners : triangles) {
    for (const VertexId v : corners) new_id[v] = 0;
  }
  Hull hull;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (new_id[i] == no_id) continue;
    new_id[i] = static_cast<VertexId>(hull.positions.size());
    hull.positions.push_back(points[i]);
  }
  for (Corners& corners : triangles) {
    for (VertexId& v : corners) v = new_id[v];
  }
  hull.triangles = std::move(triangles), hull.is_solid = is_solid;
  return hull;
}

/// The triangles of the hull of points in one plane: what a hull with one more point has besides the faces at that
/// point. `axis` is one along which the first triangle has an area.
std::vector<Corners> flat_hull(std::span<const Vec3> points, const Corners& first, std::size_t axis) {
  std::vector<Vec3> with_apex(points.begin(), points.end());
  Vec3 apex = points[first[0]];
  apex[axis] = apex[axis] == 0 ? 1 : -apex[axis];  // anywhere else along the axis is outside of the plane
  const auto apex_id = static_cast<VertexId>(points.size());
  with_apex.push_back(apex);
  GrowingHull hull(with_apex, first, apex_id);
  for (VertexId v = 0; v < points.size(); ++v) hull.add(v);
  std::vector<Corners> flat;
  std::copy_if(hull.faces().begin(), hull.faces().end(), std::back_inserter(flat),
               [&](const Corners& face) { return std::find(face.begin(), face.end(), apex_id) == face.end(); });
  return flat;
}

}  // namespace

Hull convex_hull(std::span<const Vec3> points) {
  LIMBER_ASSERT(!points.empty() && points.size() < no_id);
  const auto count = static_cast<VertexId>(points.size());
  const auto [least, most] = std::minmax_element(points.begin(), points.end(), geometry::lexicographically_less);
  const auto p = static_cast<VertexId>(least - points.begin()), q = static_cast<VertexId>(most - points.begin());
  VertexId r = 0, s = 0;
  std::optional<std::size_t> axis;
  for (; r < count; ++r) {
    axis = geometry::faithful_axis(points[p], points[q], points[r]);
    if (axis) break;
  }
  if (!axis) return with_used_points(points, {{p, q, q}}, false);  // on a line these two are its ends
  while (s < count && geometry::orient3d(points[p], points[q], points[r], points[s]) == 0) ++s;
  if (s == count) return with_used_points(points, flat_hull(points, {p, q, r}, *axis), false);
  GrowingHull hull(points, {p, q, r}, s);
  for (VertexId v = 0; v < count; ++v) hull.add(v);
  return with_used_points(points, hull.faces(), true);
}

}  // namespace limber::model
