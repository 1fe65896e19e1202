// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <deque>
#include <limits>
#include <set>
#include <vector>

#include "reference/reference.h"

namespace limber::reference {
namespace {

using EdgeEnds = std::vector<std::set<VertexId>>;  // the other end of each edge, by vertex

EdgeEnds edge_ends_of(MeshView mesh) {
  EdgeEnds ends(mesh.positions.size());
  for (const Corners& corners : mesh.triangles) {
    for (const VertexId v : corners) ends[v].insert(corners.begin(), corners.end());
  }
  return ends;
}

constexpr std::uint32_t unreached = std::numeric_limits<std::uint32_t>::max();

/// How many edges each vertex is away from one.
std::vector<std::uint32_t> path_lengths(const EdgeEnds& ends, VertexId from) {
  std::vector<std::uint32_t> lengths(ends.size(), unreached);
  lengths[from] = 0;
  std::deque<VertexId> waiting{from};
  for (; !waiting.empty(); waiting.pop_front()) {
    const VertexId v = waiting.front();
    for (const VertexId w : ends[v]) {
      if (lengths[w] == unreached) lengths[w] = lengths[v] + 1, waiting.push_back(w);
    }
  }
  return lengths;
}

}  // namespace

std::vector<TrianglePair> near_pairs(MeshView mesh, std::uint32_t edges) {
  const EdgeEnds ends = edge_ends_of(mesh);
  std::vector<TrianglePair> pairs;
  for (TriangleId i = 0; i < mesh.triangles.size(); ++i) {
    std::set<TriangleId> near;
    for (const VertexId from : mesh.triangles[i]) {
      const std::vector<std::uint32_t> lengths = path_lengths(ends, from);
      for (TriangleId j = i + 1; j < mesh.triangles.size(); ++j) {
        for (const VertexId v : mesh.triangles[j]) {
          if (lengths[v] != unreached && lengths[v] <= edges) near.insert(j);
        }
      }
    }
    for (const TriangleId j : near) pairs.push_back({i, j});
  }
  return pairs;
}

}  // namespace limber::reference
