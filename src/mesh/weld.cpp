// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/check.h"
#include "limber/mesh.h"

namespace limber {

Weld weld(std::span<const Vec3> positions) {
  LIMBER_REQUIRE(positions.size() < no_id, "limber::weld: there are more positions than ids can count");
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3& p = positions[v];
    LIMBER_REQUIRE(!std::isnan(p.x) && !std::isnan(p.y) && !std::isnan(p.z),
                   ("limber::weld: vertex " + std::to_string(v) + " has a coordinate that is not a number").c_str());
  }
  std::vector<VertexId> order(positions.size());
  std::iota(order.begin(), order.end(), VertexId{0});
  std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) {
    const Vec3 &p = positions[a], &q = positions[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  });
  std::vector<VertexId> first_of(positions.size());  // the first vertex at the same position
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_new = i == 0 || positions[order[i]] != positions[order[i - 1]];
    first_of[order[i]] = is_new ? order[i] : first_of[order[i - 1]];
  }
  Weld result;
  result.welded_of.resize(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const bool is_first = first_of[v] == v;
    result.welded_of[v] = is_first ? static_cast<VertexId>(result.first_of.size()) : result.welded_of[first_of[v]];
    if (is_first) result.first_of.push_back(static_cast<VertexId>(v));
  }
  return result;
}

WeldedMesh weld(const Mesh& mesh) {
  LIMBER_REQUIRE(!mesh.triangles().empty(), "limber::weld: the mesh has been moved from");
  Weld vertices = weld(mesh.positions());
  std::vector<Vec3> positions;
  positions.reserve(vertices.first_of.size());
  for (const VertexId v : vertices.first_of) positions.push_back(mesh.positions()[v]);
  std::vector<Corners> triangles = mesh.triangles();
  for (Corners& corners : triangles) {
    for (VertexId& v : corners) v = vertices.welded_of[v];
  }
  LIMBER_ASSERT(vertices.welded_of.size() == mesh.positions().size());
  return {Mesh::create(std::move(positions), std::move(triangles)).value(), std::move(vertices)};
}

}  // namespace limber
