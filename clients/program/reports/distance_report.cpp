// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/study.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
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

/// An edge by the ids of its ends, the lesser first.
using Edge = std::pair<VertexId, VertexId>;

/// The middle of each edge that is to be divided.
using Middles = std::map<Edge, VertexId>;

/// The parts of a triangle whose edges have those middles: 1 to 4.
void append_parts(std::vector<Corners>& parts, const Corners& triangle, const Middles& middles) {
  const auto middle_of = [&](VertexId v, VertexId w) {
    const auto found = middles.find(std::minmax(v, w));
    return found == middles.end() ? no_id : found->second;
  };
  auto [a, b, c] = triangle;
  VertexId ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
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

/// An edge that is to be divided, and minus how many times it is as long as it should be at most: what is smaller needs
/// it more.
using LongEdge = std::pair<double, Edge>;

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
    if (edges.size() > room) edges.resize(room);
    if (edges.empty()) return false;
    Middles middles;
    for (const auto& [excess, edge] : edges) {
      middles.emplace(edge, static_cast<VertexId>(map_.positions.size()));
      map_.positions.push_back((map_.positions[edge.first] + map_.positions[edge.second]) * 0.5);
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
        const auto [v, w] = std::minmax(triangle[i], triangle[(i + 1) % 3]);
        const double by = excess(v, w, shortest_edge);
        if (by > 1) edges.push_back({-by, {v, w}});
      }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
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

/// Gives the model of a page, which stands in the world then, its distances from the other.
void append_distances(Json& json, const PlacedModel& model, const Placed& other, double shortest_edge) {
  const Mesh& mesh = model.model.mesh();
  const DistanceMap map =
      distance_map(mesh, model.pose, other, shortest_edge, std::max(most_triangles, mesh.triangles().size()));
  const MeshView shown{map.positions, map.triangles};
  const Box box = box_of(shown);
  const PageTriangles triangles(shown);
  json["low"] = to_json(box.low);
  json["high"] = to_json(box.high);
  json["positions"] = quantized(triangles.in_order(shown.positions));
  json["corners"] = base64_of(triangles.corners);
  json["distances"] = quantized(triangles.in_order(std::span<const double>(map.distances)));
  if (map.triangles.size() == mesh.triangles().size()) return;
  Bytes ends;
  for (const std::uint32_t count : map.parts_of) append_count(ends, count);
  json["parts"] = base64_of(ends);
}

/// The corners of a placed model's triangle.
Json corners_of(const PlacedModel& model, TriangleId id) {
  const Triangle triangle = model.model.mesh().triangle(id);
  return {to_json(model.pose(triangle.v0)), to_json(model.pose(triangle.v1)), to_json(model.pose(triangle.v2))};
}

}  // namespace

Json distance_report(const PlacedArguments& arguments, const Pair& pair, const DistanceQuestion& question,
                     const DistanceAnswer& answer) {
  const PlacedModel a = pair.a(), b = pair.b();
  Study study(StudyKind::pair, question,
              {{shown_name(arguments.a), arguments.a, &a.model, a.pose},
               {shown_name(arguments.b), arguments.b, &b.model, b.pose}});
  study.add(0, {0, 1}, answer, std::nullopt);
  Json json = study.to_json();
  const Placed placed_a = a, placed_b = b;
  const double shortest_edge = shortest_edge_part * std::min(diagonal_of(a.model.box()), diagonal_of(b.model.box()));
  append_distances(json["models"][0], a, placed_b, shortest_edge);
  append_distances(json["models"][1], b, placed_a, shortest_edge);
  json["parts"]["poses"] = Json::array({poses_json(std::array{Transform{}}), poses_json(std::array{Transform{}})});
  Json extra;
  append_work(extra, answer.result.stats, pair.build_us(), answer.elapsed_us);
  extra["intersections"] = 0;
  extra["contact_normal"] = extra["witness_corners"] = nullptr;
  if (answer.result.status == DistanceStatus::collision) {
    std::optional<Contact> deepest;
    extra["intersections"] = visit_contacts(placed_a, placed_b, 0, [&](const Contact& contact) {
                               if (!deepest || contact.depth > deepest->depth) deepest = contact;
                               return true;
                             }).count;
    if (deepest) extra["contact_normal"] = to_json(deepest->normal);
  }
  if (answer.witness) {
    const Witness& found = answer.witness->witness;
    extra["witness_corners"] = {corners_of(a, found.triangle_a), corners_of(b, found.triangle_b)};
  }
  json["pair"] = std::move(extra);
  return json;
}

}  // namespace limber::program
