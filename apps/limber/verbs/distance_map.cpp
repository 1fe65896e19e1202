// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/distance_map.h"

#include <algorithm>
#include <span>
#include <unordered_map>

#include "command/bad_input.h"

namespace limber::program {
namespace {

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
  for (int turn = 0; turn < 2 && (ab == no_id || (ca != no_id && bc == no_id)); ++turn) {
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
    closest_points(other_, fresh, found);
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

}  // namespace

DistanceMap distance_map(MeshView mesh, const Transform& pose, const Placed& other, double shortest_edge,
                         std::size_t most_triangles) {
  Refinement refinement(mesh, pose, other);
  while (refinement.divide(shortest_edge, most_triangles)) continue;
  return refinement.take();
}

}  // namespace limber::program
