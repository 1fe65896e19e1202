// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "geometry/primitives.h"
#include "geometry/rigid.h"
#include "reference/place.h"
#include "reference/reference.h"

namespace limber::reference {
namespace {

using EdgeVertices = std::array<VertexId, 2>;

/// The vertices and edges that triangles have, each once and in ascending order, and all positions in the world.
struct Elements {
  std::vector<Corners> faces;
  std::vector<VertexId> vertices;
  std::vector<EdgeVertices> edges;
  std::vector<Vec3> positions;

  explicit Elements(const Placed& placed) : faces(placed.mesh.triangles.begin(), placed.mesh.triangles.end()) {
    std::set<VertexId> all_vertices;
    std::set<EdgeVertices> all_edges;
    for (const Corners& c : faces) {
      all_vertices.insert(c.begin(), c.end());
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId v = c[k], w = c[geometry::next_corner[k]];
        if (v != w) all_edges.insert({std::min(v, w), std::max(v, w)});
      }
    }
    vertices.assign(all_vertices.begin(), all_vertices.end());
    edges.assign(all_edges.begin(), all_edges.end());
    for (const Vec3& p : placed.mesh.positions) positions.push_back(placed.pose(p));
  }
  static bool share(const EdgeVertices& p, const EdgeVertices& q) {
    return p[0] == q[0] || p[0] == q[1] || p[1] == q[0] || p[1] == q[1];
  }
  bool has(TriangleId t, VertexId v) const { return std::find(faces[t].begin(), faces[t].end(), v) != faces[t].end(); }
  Triangle face(TriangleId t) const { return {positions[faces[t][0]], positions[faces[t][1]], positions[faces[t][2]]}; }
  Segment edge(EdgeId e) const { return {positions[edges[e][0]], positions[edges[e][1]]}; }
};

void add_vertex_face(const Elements& of_vertices, const Elements& of_faces, double margin, bool is_vertex_of_b,
                     bool is_self, std::vector<VertexFacePair>& found) {
  for (const VertexId v : of_vertices.vertices) {
    for (TriangleId t = 0; t < of_faces.faces.size(); ++t) {
      if (is_self && of_faces.has(t, v)) continue;
      const auto [distance, weights] = geometry::closest_on(of_faces.face(t), of_vertices.positions[v]);
      if (distance <= margin) found.push_back({v, t, is_vertex_of_b, distance, weights});
    }
  }
}

void add_edge_edge(const Elements& a, const Elements& b, double margin, bool is_self,
                   std::vector<EdgeEdgePair>& found) {
  for (EdgeId i = 0; i < a.edges.size(); ++i) {
    for (EdgeId j = is_self ? i + 1 : 0; j < b.edges.size(); ++j) {
      if (is_self && Elements::share(a.edges[i], b.edges[j])) continue;
      const auto [distance, s, t] = geometry::closest_on(a.edge(i), b.edge(j));
      if (distance <= margin) found.push_back({i, j, distance, s, t});
    }
  }
}

/// Elements at the start and at the end of a motion.
struct MotionOfElements {
  Elements start, end;

  explicit MotionOfElements(const MovingMesh& m)
      : start({m.mesh, m.start_pose}), end({{m.end_positions, m.mesh.triangles}, m.end_pose}) {}
  MovingPoint vertex(VertexId v) const { return {start.positions[v], end.positions[v]}; }
  MovingTriangle face(TriangleId t) const { return {start.face(t), end.face(t)}; }
  MovingSegment edge(EdgeId e) const { return {start.edge(e), end.edge(e)}; }
};

void add_vertex_face(const MotionOfElements& of_vertices, const MotionOfElements& of_faces, bool is_face_first,
                     bool is_self, const ElementImpactOptions& options, std::vector<Impact>& found) {
  for (const VertexId v : of_vertices.start.vertices) {
    for (TriangleId t = 0; t < of_faces.start.faces.size(); ++t) {
      if (is_self && of_faces.start.has(t, v)) continue;
      const ElementImpact time = time_of_impact(of_vertices.vertex(v), of_faces.face(t), options);
      if (time.status == ImpactStatus::clear) continue;
      found.push_back({is_face_first ? ElementPair{ElementPair::Kind::face_vertex, t, v}
                                     : ElementPair{ElementPair::Kind::vertex_face, v, t},
                       time});
    }
  }
}

void add_edge_edge(const MotionOfElements& a, const MotionOfElements& b, bool is_self,
                   const ElementImpactOptions& options, std::vector<Impact>& found) {
  for (EdgeId i = 0; i < a.start.edges.size(); ++i) {
    for (EdgeId j = is_self ? i + 1 : 0; j < b.start.edges.size(); ++j) {
      if (is_self && Elements::share(a.start.edges[i], b.start.edges[j])) continue;
      const ElementImpact time = time_of_impact(a.edge(i), b.edge(j), options);
      if (time.status != ImpactStatus::clear) found.push_back({{ElementPair::Kind::edge_edge, i, j}, time});
    }
  }
}

void check_pose(const Placed& placed) {
  LIMBER_REQUIRE(geometry::is_rigid(placed.pose), "limber::reference: a query needs rigid poses; one of a mesh is not");
}

}  // namespace

ElementPairs element_pairs(const Placed& a, const Placed& b, double margin) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::reference::element_pairs");
  check_pose(a), check_pose(b);
  const Elements of_a(a), of_b(b);
  ElementPairs found;
  add_vertex_face(of_a, of_b, margin, false, false, found.vertex_face);
  add_vertex_face(of_b, of_a, margin, true, false, found.vertex_face);
  add_edge_edge(of_a, of_b, margin, false, found.edge_edge);
  return found;
}

ElementPairs self_element_pairs(MeshView mesh, double margin) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::reference::self_element_pairs");
  const Elements elements({mesh});
  ElementPairs found;
  add_vertex_face(elements, elements, margin, false, true, found.vertex_face);
  add_edge_edge(elements, elements, margin, true, found.edge_edge);
  return found;
}

std::vector<Impact> impacts(const MovingMesh& a, const MovingMesh& b, const ElementImpactOptions& options) {
  const MotionOfElements of_a(a), of_b(b);
  std::vector<Impact> found;
  add_vertex_face(of_a, of_b, false, false, options, found);
  add_vertex_face(of_b, of_a, true, false, options, found);
  add_edge_edge(of_a, of_b, false, options, found);
  return found;
}

std::vector<Impact> self_impacts(const MovingMesh& mesh, const ElementImpactOptions& options) {
  const MotionOfElements elements(mesh);
  std::vector<Impact> found;
  add_vertex_face(elements, elements, false, true, options, found);
  add_edge_edge(elements, elements, true, options, found);
  return found;
}

}  // namespace limber::reference
