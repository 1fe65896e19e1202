// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// CGAL's AABB tree of triangles, with coordinates in double, and its tree of vertices for first guesses.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "bench/contacts/linked_projectors.h"

namespace limber::bench {
namespace {

using CgalKernel = CGAL::Simple_cartesian<double>;
using CgalTriangles = std::vector<CgalKernel::Triangle_3>;
using CgalPrimitive = CGAL::AABB_triangle_primitive<CgalKernel, CgalTriangles::const_iterator>;
using CgalTree = CGAL::AABB_tree<CGAL::AABB_traits<CgalKernel, CgalPrimitive>>;

CgalKernel::Point_3 as_cgal(const Vec3& v) { return {v.x, v.y, v.z}; }

class CgalMesh {
 public:
  explicit CgalMesh(const Mesh& mesh) {
    for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
      const Triangle corners = mesh.triangle(t);
      triangles_.emplace_back(as_cgal(corners.v0), as_cgal(corners.v1), as_cgal(corners.v2));
    }
    tree_.rebuild(triangles_.cbegin(), triangles_.cend());
    tree_.accelerate_distance_queries();
  }
  double distance(const Vec3& point) const { return std::sqrt(tree_.squared_distance(as_cgal(point))); }

 private:
  CgalTriangles triangles_;
  CgalTree tree_;
};

}  // namespace

LinkedProjector cgal_projector(const Mesh& mesh) {
  return {"CGAL", "AABB_tree, accelerated", false,
          [built = std::make_shared<const CgalMesh>(mesh)](std::span<const Vec3> points, std::span<double> distances) {
            for (std::size_t i = 0; i < points.size(); ++i) distances[i] = built->distance(points[i]);
          }};
}

}  // namespace limber::bench
