// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "geometry/primitives.h"
#include "limber/mesh.h"

/// Lists of items for each vertex of a mesh, a loop over its edges, and whether they close it.
namespace limber::mesh {

/// A list of items for each vertex, one after the other in one array (CSR).
template <typename Item>
class VertexLists {
 public:
  /// for_all(add) calls add(vertex, item) for every item. for_all is called twice, to count and to fill, and has to do
  /// the same both times. Lists keep the order in which items are added.
  template <typename ForAll>
  VertexLists(std::size_t vertex_count, const ForAll& for_all) : begin_(vertex_count + 2) {
    // First begin_[v + 2] counts the items of v. After the prefix sum, begin_[v + 1] is where the list of v begins, and
    // then the cursor at which items of v are filled in. At last it is where v's list ends and that of v + 1 begins.
    for_all([&](VertexId v, const Item&) { ++begin_[v + std::size_t{2}]; });
    for (std::size_t v = 2; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
    items_.resize(begin_.back());
    for_all([&](VertexId v, const Item& item) { items_[begin_[v + std::size_t{1}]++] = item; });
  }

  std::span<Item> of(VertexId v) { return std::span(items_).subspan(begin_[v], count(v)); }
  std::span<const Item> of(VertexId v) const { return std::span(items_).subspan(begin_[v], count(v)); }

 private:
  std::size_t count(VertexId v) const { return begin_[v + std::size_t{1}] - begin_[v]; }

  std::vector<std::size_t> begin_;
  std::vector<Item, base::UninitializedAllocator<Item>> items_;
};

/// One side of a triangle: a half-edge. An edge consists of all sides between its two vertices, whatever their
/// direction. The smaller vertex id is not stored: sides are listed at that vertex.
struct TriangleSide {
  VertexId high;  // the larger vertex id
  TriangleId triangle;
  std::uint32_t corner;  // of the triangle: the side leads from it to the next one
};

/// Calls visit(low, sides) for every edge, in the order of its smaller vertex id, `low`, then of its larger one. The
/// sides are in the order of triangles and corners. A side from a vertex to itself, of a triangle that repeats the id,
/// counts as an edge here: low is then sides[0].high. goes_on(i) is asked before the i-th triangle or vertex of a loop;
/// once it says no, it has to keep saying so, and not all edges are visited.
template <typename Visit, typename GoesOn>
void for_each_edge(std::span<const Corners> triangles, std::size_t vertex_count, const Visit& visit,
                   const GoesOn& goes_on) {
  VertexLists<TriangleSide> sides_of(vertex_count, [&](const auto& add) {
    for (TriangleId t = 0; t < triangles.size() && goes_on(t); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const VertexId v = triangles[t][k], w = triangles[t][geometry::next_corner[k]];
        add(std::min(v, w), TriangleSide{std::max(v, w), t, k});
      }
    }
  });
  for (VertexId low = 0; low < vertex_count && goes_on(low); ++low) {
    std::span<TriangleSide> sides = sides_of.of(low);
    std::sort(sides.begin(), sides.end(), [](const TriangleSide& s, const TriangleSide& t) {
      if (s.high != t.high) return s.high < t.high;
      return s.triangle != t.triangle ? s.triangle < t.triangle : s.corner < t.corner;
    });
    while (!sides.empty()) {
      std::size_t count = 1;
      while (count < sides.size() && sides[count].high == sides[0].high) ++count;
      visit(low, std::span<const TriangleSide>(sides.first(count)));
      sides = sides.subspan(count);
    }
  }
}
template <typename Visit>
void for_each_edge(std::span<const Corners> triangles, std::size_t vertex_count, const Visit& visit) {
  for_each_edge(triangles, vertex_count, visit, [](std::size_t) { return true; });
}

/// Whether every edge, by vertex ids, belongs to exactly two triangles, which run through it in opposite directions.
///
/// Errors   `not_closed` for the first triangle with an edge of which that is not so, naming the edge.
/// Cost     O(n log n) at worst, O(n) where few edges meet at a vertex; allocates 36 bytes a triangle and 8 a vertex.
Result<void> check_closed(const Mesh& mesh);

}  // namespace limber::mesh
