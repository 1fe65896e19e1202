// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// CGAL's AABB tree of triangles over a kernel of doubles, with a tree of vertices for first guesses. It has no distance
// between two meshes.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>

#include "bench/peers/peer.h"

namespace limber::bench {
namespace {

class PointTree {
 public:
  explicit PointTree(const Mesh& mesh) {
    for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
      const Triangle corners = mesh.triangle(t);
      triangles_.emplace_back(point(corners.v0), point(corners.v1), point(corners.v2));
    }
    tree_.rebuild(triangles_.cbegin(), triangles_.cend());
    tree_.accelerate_distance_queries();
  }
  double distance(const Vec3& p) const { return std::sqrt(tree_.squared_distance(point(p))); }

 private:
  using Doubles = CGAL::Simple_cartesian<double>;
  using Triangles = std::vector<Doubles::Triangle_3>;
  using Primitive = CGAL::AABB_triangle_primitive<Doubles, Triangles::const_iterator>;

  static Doubles::Point_3 point(const Vec3& v) { return {v.x, v.y, v.z}; }

  Triangles triangles_;
  CGAL::AABB_tree<CGAL::AABB_traits<Doubles, Primitive>> tree_;
};

}  // namespace

Projector cgal_projector(const Mesh& mesh) {
  return {"CGAL", "AABB_tree, accelerated", false,
          [tree = std::make_shared<const PointTree>(mesh)](const Vec3& p) { return tree->distance(p); }};
}

}  // namespace limber::bench
