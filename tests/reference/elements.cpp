// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
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

/// Calls visit(vertex, face) for the vertices of one mesh and the faces of another, which do not name them where both
/// are the same.
template <typename Visit>
void visit_vertex_faces(const Elements& of_vertices, const Elements& of_faces, const Visit& visit) {
  for (const VertexId v : of_vertices.vertices) {
    for (TriangleId t = 0; t < of_faces.faces.size(); ++t) {
      if (&of_vertices != &of_faces || !of_faces.has(t, v)) visit(v, t);
    }
  }
}

/// Calls visit(edge of a, edge of b), which share no vertex where both are the same.
template <typename Visit>
void visit_edge_edges(const Elements& a, const Elements& b, const Visit& visit) {
  const bool is_self = &a == &b;
  for (EdgeId i = 0; i < a.edges.size(); ++i) {
    for (EdgeId j = is_self ? i + 1 : 0; j < b.edges.size(); ++j) {
      if (!is_self || !Elements::share(a.edges[i], b.edges[j])) visit(i, j);
    }
  }
}

/// Pairs of a and b, which may be the same.
ElementPairs pairs_of(const Elements& a, const Elements& b, double margin) {
  ElementPairs found;
  const auto add_vertex_faces = [&](const Elements& of_vertices, const Elements& of_faces, bool is_vertex_of_b) {
    visit_vertex_faces(of_vertices, of_faces, [&](VertexId v, TriangleId t) {
      const auto [distance, weights] = geometry::closest_on(of_faces.face(t), of_vertices.positions[v]);
      if (distance <= margin) found.vertex_face.push_back({v, t, is_vertex_of_b, distance, weights});
    });
  };
  add_vertex_faces(a, b, false);
  if (&a != &b) add_vertex_faces(b, a, true);
  visit_edge_edges(a, b, [&](EdgeId i, EdgeId j) {
    const auto [distance, s, t] = geometry::closest_on(a.edge(i), b.edge(j));
    if (distance <= margin) found.edge_edge.push_back({i, j, distance, s, t});
  });
  return found;
}

/// A feature by its vertices, in the order of ids; a vertex, an edge or a face by how many these are.
struct FeatureVertices {
  std::set<VertexId> vertices;
  TriangleId face = no_id;

  FeatureKind kind() const {
    return vertices.size() == 1 ? FeatureKind::vertex : vertices.size() == 2 ? FeatureKind::edge : FeatureKind::face;
  }
  std::uint32_t id(const Elements& of) const {
    if (vertices.size() == 1) return *vertices.begin();
    if (vertices.size() == 3) return face;
    const EdgeVertices ends{*vertices.begin(), *vertices.rbegin()};
    return static_cast<EdgeId>(std::lower_bound(of.edges.begin(), of.edges.end(), ends) - of.edges.begin());
  }
  Segment segment(const Elements& of) const {
    return {of.positions[*vertices.begin()], of.positions[*vertices.rbegin()]};
  }
};

ClosestPoints closest_points(const FeatureVertices& f, const Elements& of_f, const FeatureVertices& g,
                             const Elements& of_g) {
  if (g.kind() == FeatureKind::face) return limber::closest_points(f.segment(of_f).p0, of_g.face(g.face));
  if (f.kind() != FeatureKind::face) return limber::closest_points(f.segment(of_f), g.segment(of_g));
  const ClosestPoints swapped = closest_points(g, of_g, f, of_f);
  return {swapped.distance, swapped.point_b, swapped.point_a};
}

/// The features of pairs of elements of a and b, which may be the same.
std::vector<FeaturePair> features_of(const Elements& a, const Elements& b, const ElementPairs& pairs) {
  using Key = std::pair<FeatureKind, std::uint32_t>;
  std::map<std::pair<Key, Key>, FeaturePair> found;
  const auto add = [&](const FeatureVertices& f, const FeatureVertices& g) {
    Key key_f{f.kind(), f.id(a)}, key_g{g.kind(), g.id(b)};
    const bool swaps = &a == &b && key_g < key_f;
    if (swaps) std::swap(key_f, key_g);
    FeaturePair& pair = found[{key_f, key_g}];
    if (pair.multiplicity++ > 0) return;
    const ClosestPoints closest = swaps ? closest_points(g, b, f, a) : closest_points(f, a, g, b);
    pair.distance = closest.distance, pair.point_a = closest.point_a, pair.point_b = closest.point_b;
    pair.kind_a = key_f.first, pair.a = key_f.second, pair.kind_b = key_g.first, pair.b = key_g.second;
  };
  for (const VertexFacePair& p : pairs.vertex_face) {
    FeatureVertices face{{}, p.triangle};
    for (std::size_t k = 0; k < 3; ++k) {
      if (p.weights[k] > 0) face.vertices.insert((p.is_vertex_of_b ? a : b).faces[p.triangle][k]);
    }
    const FeatureVertices vertex{{p.vertex}};
    p.is_vertex_of_b ? add(face, vertex) : add(vertex, face);
  }
  const auto of_edge = [](const EdgeVertices& edge, double parameter) {
    FeatureVertices f;
    if (parameter < 1) f.vertices.insert(edge[0]);
    if (parameter > 0) f.vertices.insert(edge[1]);
    return f;
  };
  for (const EdgeEdgePair& p : pairs.edge_edge) {
    add(of_edge(a.edges[p.a], p.parameter_a), of_edge(b.edges[p.b], p.parameter_b));
  }
  std::vector<FeaturePair> list;
  for (const auto& [key, pair] : found) list.push_back(pair);
  return list;
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

/// Impacts of a and b, which may be the same.
std::vector<Impact> impacts_of(const MotionOfElements& a, const MotionOfElements& b,
                               const ElementImpactOptions& options) {
  std::vector<Impact> found;
  const auto add = [&](const ElementPair& pair, const ElementImpact& time) {
    if (time.status != ImpactStatus::clear) found.push_back({pair, time});
  };
  visit_vertex_faces(a.start, b.start, [&](VertexId v, TriangleId t) {
    add({ElementPair::Kind::vertex_face, v, t}, time_of_impact(a.vertex(v), b.face(t), options));
  });
  if (&a != &b) {
    visit_vertex_faces(b.start, a.start, [&](VertexId v, TriangleId t) {
      add({ElementPair::Kind::face_vertex, t, v}, time_of_impact(b.vertex(v), a.face(t), options));
    });
  }
  visit_edge_edges(a.start, b.start, [&](EdgeId i, EdgeId j) {
    add({ElementPair::Kind::edge_edge, i, j}, time_of_impact(a.edge(i), b.edge(j), options));
  });
  return found;
}

void check_pose(const Placed& placed) {
  LIMBER_REQUIRE(geometry::is_rigid(placed.pose), "limber::reference: a query needs rigid poses; one of a mesh is not");
}

}  // namespace

ElementPairs element_pairs(const Placed& a, const Placed& b, double margin) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::reference::element_pairs");
  check_pose(a), check_pose(b);
  return pairs_of(Elements(a), Elements(b), margin);
}

ElementPairs self_element_pairs(MeshView mesh, double margin) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::reference::self_element_pairs");
  const Elements elements({mesh});
  return pairs_of(elements, elements, margin);
}

std::vector<FeaturePair> feature_pairs(const Placed& a, const Placed& b, double margin) {
  const base::DefaultFloatEnvironment environment;
  const Elements of_a(a), of_b(b);
  return features_of(of_a, of_b, element_pairs(a, b, margin));
}

std::vector<FeaturePair> self_feature_pairs(MeshView mesh, double margin) {
  const base::DefaultFloatEnvironment environment;
  const Elements elements({mesh});
  return features_of(elements, elements, self_element_pairs(mesh, margin));
}

std::vector<Impact> impacts(const MovingMesh& a, const MovingMesh& b, const ElementImpactOptions& options) {
  return impacts_of(MotionOfElements(a), MotionOfElements(b), options);
}

std::vector<Impact> self_impacts(const MovingMesh& mesh, const ElementImpactOptions& options) {
  const MotionOfElements elements(mesh);
  return impacts_of(elements, elements, options);
}

}  // namespace limber::reference
