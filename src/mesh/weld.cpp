// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/check.h"
#include "limber/mesh.h"

namespace limber {
namespace {

/// Spreads a position over 64 bits; equal positions, so also -0 and 0, give equal values. Coordinates of a grid differ
/// in high bits alone, so these are put onto the low ones first.
std::uint64_t hash_of_position(const Vec3& p) {
  std::uint64_t h = 0;
  for (const double coordinate : {p.x, p.y, p.z}) {
    const auto bits = std::bit_cast<std::uint64_t>(coordinate + 0.0);  // -0 + 0 is 0
    h = (h ^ bits ^ bits >> 32U) * 0x9e37'79b9'7f4a'7c15U;
    h ^= h >> 32U;
  }
  return h;
}

/// Hashing with linear probing; none when it needs more than `max_steps` steps, as for positions made to collide.
std::optional<Weld> weld_by_hashing(std::span<const Vec3> positions, std::size_t max_steps) {
  Weld result;
  result.welded_of.reserve(positions.size());
  std::vector<VertexId> table(std::bit_ceil(2 * positions.size() + 1), no_id);  // of welded vertices
  for (std::size_t v = 0; v < positions.size(); ++v) {
    std::size_t slot = hash_of_position(positions[v]) & (table.size() - 1);
    while (table[slot] != no_id && positions[result.first_of[table[slot]]] != positions[v]) {
      if (max_steps-- == 0) return {};
      slot = (slot + 1) & (table.size() - 1);
    }
    if (table[slot] == no_id) {
      table[slot] = static_cast<VertexId>(result.first_of.size());
      result.first_of.push_back(static_cast<VertexId>(v));
    }
    result.welded_of.push_back(table[slot]);
  }
  return result;
}

Weld weld_by_sorting(std::span<const Vec3> positions) {
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

}  // namespace

Weld weld(std::span<const Vec3> positions) {
  LIMBER_REQUIRE(positions.size() < no_id, "limber::weld: there are more positions than ids can count");
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3& p = positions[v];
    LIMBER_REQUIRE(!std::isnan(p.x) && !std::isnan(p.y) && !std::isnan(p.z),
                   ("limber::weld: vertex " + std::to_string(v) + " has a coordinate that is not a number").c_str());
  }
  // A table at most half full takes about one step for two positions; grids and scans stay below two.
  constexpr std::size_t steps_per_position = 16;
  if (std::optional<Weld> result = weld_by_hashing(positions, steps_per_position * positions.size() + 64)) {
    return std::move(*result);
  }
  return weld_by_sorting(positions);
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
