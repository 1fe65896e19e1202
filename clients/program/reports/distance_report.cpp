// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/distance_report.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "command/text.h"
#include "limber/contacts.h"
#include "limber/points.h"
#include "reports/page_data.h"

namespace limber::program {
namespace {

/// A placed mesh whose long edges are divided where the distance to another model may differ between their ends: large
/// faces would otherwise show what their corners know. Edges are divided in the middle, and in all of their triangles.
struct DistanceMap {
  std::vector<Vec3> positions;          ///< in the world; those of the mesh come first
  std::vector<Corners> triangles;       ///< parts of one triangle of the mesh follow each other
  std::vector<std::uint32_t> parts_of;  ///< how many parts each triangle of the mesh has
  std::vector<double> distances;        ///< by vertex: to the closest point of the other model
};

/// An edge is short next to its distance from the other model if it is at most this part of it. Between its ends the
/// distance then differs from the interpolated one by at most half of that.
constexpr double short_part = 0.25;

/// One number for an edge, whichever end comes first.
std::uint64_t edge_key(VertexId v, VertexId w) { return std::uint64_t{std::min(v, w)} << 32U | std::max(v, w); }

/// The middle of each edge that is to be divided, by the ids of its ends.
class Middles {
 public:
  void add(VertexId v, VertexId w, VertexId middle) { middles_.emplace(edge_key(v, w), middle); }

  /// The middle, or `no_id` where the edge is not divided.
  VertexId find(VertexId v, VertexId w) const {
    const auto found = middles_.find(edge_key(v, w));
    return found == middles_.end() ? no_id : found->second;
  }

 private:
  std::unordered_map<std::uint64_t, VertexId> middles_;
};

/// The parts of a triangle whose edges have those middles: 1 to 4.
void append_parts(std::vector<Corners>& parts, const Corners& triangle, const Middles& middles) {
  auto [a, b, c] = triangle;
  VertexId ab = middles.find(a, b), bc = middles.find(b, c), ca = middles.find(c, a);
  // Turned so that the first edge is divided if one is, and the last one is not unless all are.
  for (int i = 0; i < 2 && (ab == no_id || (ca != no_id && bc == no_id)); ++i) {
    std::swap(a, b), std::swap(b, c);
    std::swap(ab, bc), std::swap(bc, ca);
  }
  if (ab == no_id) {
    parts.push_back({a, b, c});
  } else if (bc == no_id) {
    parts.insert(parts.end(), {Corners{a, ab, c}, Corners{ab, b, c}});
  } else if (ca == no_id) {
    parts.insert(parts.end(), {Corners{ab, b, bc}, Corners{a, ab, bc}, Corners{a, bc, c}});
  } else {
    parts.insert(parts.end(), {Corners{a, ab, ca}, Corners{ab, b, bc}, Corners{ca, bc, c}, Corners{ab, bc, ca}});
  }
}

/// An edge that is to be divided; those that need it most come first.
struct LongEdge {
  double excess = 0;
  VertexId v = 0, w = 0;

  std::uint64_t key() const { return edge_key(v, w); }
  bool operator<(const LongEdge& other) const {
    return excess != other.excess ? excess > other.excess : key() < other.key();
  }
};

/// Dividing an edge makes one triangle more of each that has it: as a rule two.
constexpr std::size_t parts_of_edge = 2;

class Refinement {
 public:
  Refinement(MeshView mesh, const Transform& pose, const Placed& other) : other_(other) {
    map_.positions.reserve(mesh.positions.size());
    for (const Vec3& p : mesh.positions) {
      map_.positions.push_back(pose(p));
      if (max_abs(map_.positions.back()) <= max_coordinate) continue;
      throw BadInput("--report: a pose moves a vertex beyond the largest coordinate of points, 2^200");
    }
    map_.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
    map_.parts_of.assign(mesh.triangles.size(), 1);
    measure();
  }

  /// Divides every long edge once, or as many of the longest as there is room for, which are none in the end. Returns
  /// whether there was one.
  bool divide(double shortest_edge, std::size_t most_triangles) {
    std::vector<LongEdge> edges = long_edges(shortest_edge);
    const std::size_t room = (most_triangles - map_.triangles.size()) / parts_of_edge;
    if (edges.size() > room) {
      std::nth_element(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(room), edges.end());
      edges.resize(room);
    }
    if (edges.empty()) return false;
    Middles middles;
    for (const LongEdge& edge : edges) {
      middles.add(edge.v, edge.w, static_cast<VertexId>(map_.positions.size()));
      map_.positions.push_back((map_.positions[edge.v] + map_.positions[edge.w]) * 0.5);
    }
    std::vector<Corners> parts;
    std::vector<std::uint32_t> parts_of;
    std::size_t t = 0;
    for (const std::uint32_t count : map_.parts_of) {
      const std::size_t before = parts.size();
      for (std::uint32_t i = 0; i < count; ++i, ++t) append_parts(parts, map_.triangles[t], middles);
      parts_of.push_back(static_cast<std::uint32_t>(parts.size() - before));
    }
    map_.triangles = std::move(parts);
    map_.parts_of = std::move(parts_of);
    measure();
    return true;
  }

  DistanceMap take() { return std::move(map_); }

 private:
  /// Asks for the distances of vertices that have none yet.
  void measure() {
    const std::span<const Vec3> fresh = std::span(map_.positions).subspan(map_.distances.size());
    std::vector<PointResult> found(fresh.size());
    closest_point_many(other_, fresh, found);
    for (const PointResult& result : found) map_.distances.push_back(result.closest->distance);
  }

  /// How many times an edge is as long as it should be at most.
  double excess(VertexId v, VertexId w, double shortest_edge) const {
    const double edge = length(map_.positions[v] - map_.positions[w]);
    const double nearest = (map_.distances[v] + map_.distances[w] - edge) / 2;  // no point of the edge is nearer
    const double longest = std::max(shortest_edge, short_part * nearest);
    return edge > longest ? edge / longest : 0;
  }

  std::vector<LongEdge> long_edges(double shortest_edge) const {
    std::vector<LongEdge> edges;
    for (const Corners& triangle : map_.triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const VertexId v = triangle[i], w = triangle[(i + 1) % 3];
        const double by = excess(v, w, shortest_edge);
        if (by > 1) edges.push_back({by, v, w});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const LongEdge& a, const LongEdge& b) { return a.key() < b.key(); });
    const auto same = [](const LongEdge& a, const LongEdge& b) { return a.key() == b.key(); };
    edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
    return edges;
  }

  Placed other_;
  DistanceMap map_;
};

/// The map of a model. Edges are divided until they are short next to their distance from the other model, or shorter
/// than `shortest_edge`, or until there is no room left below about `most_triangles`. The longest get the room first.
///
/// Errors   BadInput where a vertex as placed is above `max_coordinate`.
/// Pre      most_triangles is at least the number of the mesh's triangles.
/// Cost     One closest point for each vertex, on the threads of the calling oneTBB arena.
DistanceMap distance_map(MeshView mesh, const Transform& pose, const Placed& other, double shortest_edge,
                         std::size_t most_triangles) {
  Refinement refinement(mesh, pose, other);
  while (refinement.divide(shortest_edge, most_triangles)) continue;
  return refinement.take();
}

/// Meshes of more triangles are shown as they are; what a page of smaller ones may grow to.
constexpr std::size_t most_triangles = 100'000;
/// Edges shorter than this part of the diagonal of the smaller model's box are not divided for the map.
constexpr double shortest_edge_part = 1.0 / 256;

double diagonal_of(const Box& box) { return length(box.high - box.low); }

/// The triangles of each model that intersect the other, and how many pairs of them there are.
struct Intersections {
  std::size_t pair_count = 0;
  IntersectingTriangles triangles;
  std::optional<Vec3> normal;  ///< of the deepest pair, from A to B
};

/// Which triangles of two models have been named.
class MarkedTriangles {
 public:
  MarkedTriangles(const Placed& a, const Placed& b)
      : a_(a.model().mesh().triangles().size()), b_(b.model().mesh().triangles().size()) {}

  void mark(TriangleId a, TriangleId b) { a_[a] = b_[b] = true; }
  IntersectingTriangles triangles() const { return {ids_of(a_), ids_of(b_)}; }

 private:
  static std::vector<TriangleId> ids_of(const std::vector<bool>& is_marked) {
    std::vector<TriangleId> ids;
    for (TriangleId t = 0; t < is_marked.size(); ++t) {
      if (is_marked[t]) ids.push_back(t);
    }
    return ids;
  }

  std::vector<bool> a_, b_;
};

Intersections intersections_of(const Placed& a, const Placed& b) {
  MarkedTriangles marked(a, b);
  Intersections found;
  double deepest = -1;
  const auto visit = [&](const Contact& contact) {
    marked.mark(contact.triangle_a, contact.triangle_b);
    if (contact.depth > deepest) {
      deepest = contact.depth;
      found.normal = contact.normal;
    }
    return true;
  };
  found.pair_count = visit_contacts(a, b, 0, visit).count;
  found.triangles = marked.triangles();
  return found;
}

Json json_of_model(const std::string& name, const PlacedModel& model, const Placed& other, double shortest_edge,
                   const std::vector<TriangleId>& intersecting) {
  const Mesh& mesh = model.model.mesh();
  const DistanceMap map =
      distance_map(mesh, model.pose, other, shortest_edge, std::max(most_triangles, mesh.triangles().size()));
  const MeshView shown{map.positions, map.triangles};
  const Box box = box_of(shown);
  const PageTriangles triangles(shown);
  Json json = {{"name", shown_name(name)},
               {"triangles", mesh.triangles().size()},
               {"vertices", mesh.positions().size()},
               {"faces", model.model.face_count()},
               {"closed", model.model.is_closed()},
               {"low", to_json(box.low)},
               {"high", to_json(box.high)},
               {"positions", quantized(triangles.in_order(shown.positions))},
               {"corners", base64_of(triangles.corners)},
               {"distances", quantized(triangles.in_order(std::span<const double>(map.distances)))},
               {"intersecting", increasing_ids(intersecting)}};
  if (map.triangles.size() > mesh.triangles().size()) {
    Bytes parts;
    for (const std::uint32_t count : map.parts_of) append_count(parts, count);
    json["parts"] = base64_of(parts);
  }
  return json;
}

/// The corners of the triangles that the closest points lie on.
Json json_of_witness_corners(const Pair& pair, const std::optional<FoundWitness>& witness) {
  if (!witness) return nullptr;
  Json json = Json::array();
  for (const auto& [model, id] :
       {std::pair(pair.a(), witness->witness.triangle_a), std::pair(pair.b(), witness->witness.triangle_b)}) {
    const Triangle triangle = model.model.mesh().triangle(id);
    Json corners = Json::array();
    for (std::size_t i = 0; i < 3; ++i) corners.push_back(to_json(model.pose(triangle[i])));
    json.push_back(corners);
  }
  return json;
}

}  // namespace

IntersectingTriangles intersecting_triangles_of(const Placed& a, const Placed& b) {
  MarkedTriangles marked(a, b);
  visit_intersections(a, b, [&](const TrianglePair& pair) {
    marked.mark(pair.a, pair.b);
    return true;
  });
  return marked.triangles();
}

Json distance_report(const PlacedArguments& arguments, const Pair& pair, const DistanceQuestion& question,
                     const DistanceAnswer& answer) {
  const Placed a = pair.a(), b = pair.b();
  Intersections found;
  if (answer.result.status == DistanceStatus::collision) found = intersections_of(a, b);
  const double shortest_edge =
      shortest_edge_part * std::min(diagonal_of(pair.a().model.box()), diagonal_of(pair.b().model.box()));
  Json json;
  append_answer(json, answer);
  append_work(json, answer.result.stats, pair.build_us(), answer.elapsed_us);
  json["min_clearance"] = to_json(question.min_clearance);
  json["max_distance"] =
      std::isfinite(question.options.max_distance) ? Json(question.options.max_distance) : Json(nullptr);
  json["relative_error"] = question.options.relative_error;
  json["absolute_error"] = question.options.absolute_error;
  json["tolerance"] = question.tolerances.overlap;
  json["mesh_error"] = question.tolerances.mesh_error;
  json["intersections"] = found.pair_count;
  json["contact_normal"] = found.normal ? to_json(*found.normal) : Json(nullptr);
  json["witness_corners"] = json_of_witness_corners(pair, answer.witness);
  json["models"] = {json_of_model(arguments.a, pair.a(), b, shortest_edge, found.triangles.a),
                    json_of_model(arguments.b, pair.b(), a, shortest_edge, found.triangles.b)};
  return json;
}

}  // namespace limber::program
