// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// CGAL's AABB tree of triangles over an inexact kernel with exact predicates; one tree moves by its traits'
// transformation, as in Polygon_mesh_processing's rigid collision. No distance between two meshes. For closest points
// the tree is over a kernel of doubles, with a tree of vertices for first guesses.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Rigid_triangle_mesh_collision_detection.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>

#include "bench/peers/peer.h"

namespace limber::bench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

Surface surface_of(const Mesh& mesh) {
  Surface surface;
  // Three vertices of its own for every triangle: a soup is no manifold.
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle corners = mesh.triangle(t);
    Surface::Vertex_index v[3];
    for (std::size_t k = 0; k < 3; ++k) v[k] = surface.add_vertex({corners[k].x, corners[k].y, corners[k].z});
    surface.add_face(v[0], v[1], v[2]);
  }
  return surface;
}

class CgalPeer : public Peer {
 public:
  CgalPeer(const Mesh& a, const Mesh& b) : a_(surface_of(a)), b_(surface_of(b)) {
    detection_.add_mesh(a_);
    detection_.add_mesh(b_);
    ask(Question::collide, {});  // builds the trees
  }
  bool answers(Question question) const override { return question == Question::collide; }
  double ask(Question, const Transform& pose) override {
    const Mat3& r = pose.rotation;
    const Vec3& t = pose.translation;
    detection_.set_transformation(
        1, {r.row0.x, r.row0.y, r.row0.z, t.x, r.row1.x, r.row1.y, r.row1.z, t.y, r.row2.x, r.row2.y, r.row2.z, t.z});
    return detection_.get_all_intersections(1).empty() ? 1 : 0;
  }

 private:
  Surface a_, b_;
  CGAL::Rigid_triangle_mesh_collision_detection<Surface> detection_;
};

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

std::unique_ptr<Peer> make_cgal(const Mesh& a, const Mesh& b) { return std::make_unique<CgalPeer>(a, b); }

Projector cgal_projector(const Mesh& mesh) {
  return {"CGAL", "AABB_tree, accelerated", false,
          [tree = std::make_shared<const PointTree>(mesh)](const Vec3& p) { return tree->distance(p); }};
}

}  // namespace limber::bench
