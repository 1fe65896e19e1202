// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "limber/mesh.h"
#include "limber/solids.h"
#include "support/random_geometry.h"

/// Closed surfaces whose relation is known without geometry: they consist of cells of a lattice.
namespace limber::testing {

constexpr int lattice_side = 6;

/// How often a surface winds around each cell of a lattice.
using CellWindings = std::array<int, lattice_side * lattice_side * lattice_side>;

inline std::size_t cell_index(int x, int y, int z) {
  return static_cast<std::size_t>((z * lattice_side + y) * lattice_side + x);
}

/// An axis-aligned box of cells; with a minus sign, its surface is turned inside out.
struct CellBox {
  std::array<int, 3> low, high;
  int sign;
};

struct CellSolid {
  CellWindings windings{};
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  /// Rectangles of the surface: an axis, a place on it, and a range of the two next axes.
  struct Rectangle {
    std::array<int, 3> low, high;
  };
  std::vector<Rectangle> rectangles;
};

/// Adds a rectangle of n x m squares as triangles, with diagonals drawn at random.
inline void add_rectangle(Rng& rng, CellSolid& solid, std::size_t axis, int at, const std::array<int, 3>& low,
                          const std::array<int, 3>& high, bool is_upward, int step,
                          std::map<std::array<int, 3>, VertexId>& ids) {
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const auto id = [&](int u, int v) {
    std::array<int, 3> p{};
    p[axis] = at, p[i] = u, p[j] = v;
    const auto [found, is_new] = ids.try_emplace(p, static_cast<VertexId>(solid.positions.size()));
    if (is_new) {
      solid.positions.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    }
    return found->second;
  };
  const auto next = [&](int x, int end) { return step == 0 ? end : std::min(x + step, end); };
  for (int u = low[i]; u < high[i]; u = next(u, high[i])) {
    for (int v = low[j]; v < high[j]; v = next(v, high[j])) {
      const int u1 = next(u, high[i]), v1 = next(v, high[j]);
      std::array<VertexId, 4> c{id(u, v), id(u1, v), id(u1, v1), id(u, v1)};
      if (!is_upward) std::swap(c[1], c[3]);
      if (rng.below(2) == 0) std::rotate(c.begin(), c.begin() + 1, c.end());
      solid.triangles.push_back({c[0], c[1], c[2]});
      solid.triangles.push_back({c[2], c[3], c[0]});
    }
  }
  CellSolid::Rectangle r{low, high};
  r.low[axis] = r.high[axis] = at;
  solid.rectangles.push_back(r);
}

inline void add_box(Rng& rng, CellSolid& solid, const CellBox& box, int step) {
  std::map<std::array<int, 3>, VertexId> ids;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    add_rectangle(rng, solid, axis, box.low[axis], box.low, box.high, box.sign < 0, step, ids);
    add_rectangle(rng, solid, axis, box.high[axis], box.low, box.high, box.sign > 0, step, ids);
  }
  for (int z = box.low[2]; z < box.high[2]; ++z) {
    for (int y = box.low[1]; y < box.high[1]; ++y) {
      for (int x = box.low[0]; x < box.high[0]; ++x) solid.windings[cell_index(x, y, z)] += box.sign;
    }
  }
}

inline CellBox random_box(Rng& rng, int side = lattice_side) {
  CellBox box{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto a = static_cast<int>(rng.below(static_cast<std::uint64_t>(side) + 1));
    auto b = static_cast<int>(rng.below(static_cast<std::uint64_t>(side)));
    if (b >= a) ++b;
    box.low[k] = std::min(a, b), box.high[k] = std::max(a, b);
  }
  box.sign = rng.below(4) == 0 ? -1 : 1;
  return box;
}

/// Some boxes, each a component: they overlap, touch and cancel as they come.
inline CellSolid boxes_of_cells(Rng& rng, std::size_t most) {
  CellSolid solid;
  const std::uint64_t count = 1 + rng.below(most);
  const int side = 2 + static_cast<int>(rng.below(lattice_side - 1));
  const int step = rng.below(3) == 0 ? 1 + static_cast<int>(rng.below(2)) : 0;
  for (std::uint64_t i = 0; i < count; ++i) add_box(rng, solid, random_box(rng, side), step);
  return solid;
}

/// The boundary of some cells, whose triangles share vertices where they share an edge of one cell. Cells that touch in
/// an edge alone do not share it.
class CellBoundary {
 public:
  explicit CellBoundary(const CellWindings& cells) : cells_(cells) {}

  CellSolid surface(Rng& rng) {
    for (int z = 0; z < lattice_side; ++z) {
      for (int y = 0; y < lattice_side; ++y) {
        for (int x = 0; x < lattice_side; ++x) add_squares({x, y, z});
      }
    }
    parent_.resize(4 * squares_.size());
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    for (const auto& [edge, uses] : edges_) join(uses);
    return triangulated(rng);
  }

 private:
  using Place = std::array<int, 3>;
  struct Square {
    std::array<Place, 4> corners;
    Place cell;
  };
  struct Use {
    std::size_t square, corner;  // the edge from it to the next one
  };

  bool is_full(const Place& p) const {
    for (const int x : p) {
      if (x < 0 || x >= lattice_side) return false;
    }
    return cells_[cell_index(p[0], p[1], p[2])] != 0;
  }
  void add_squares(const Place& cell) {
    if (!is_full(cell)) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int up : {0, 1}) {
        Place beside = cell, at = cell;
        beside[axis] += up == 1 ? 1 : -1, at[axis] += up;
        if (is_full(beside)) continue;
        Square square{{at, at, at, at}, cell};
        const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
        ++square.corners[1][i], ++square.corners[2][i], ++square.corners[2][j], ++square.corners[3][j];
        if (up == 0) std::swap(square.corners[1], square.corners[3]);
        for (std::size_t k = 0; k < 4; ++k) {
          edges_[std::minmax(square.corners[k], square.corners[(k + 1) % 4])].push_back({squares_.size(), k});
        }
        squares_.push_back(square);
      }
    }
  }
  std::size_t find(std::size_t i) const {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }
  /// Neighbors run through their edge in opposite directions.
  void join(const Use& p, const Use& q) {
    parent_[find(4 * p.square + p.corner)] = find(4 * q.square + (q.corner + 1) % 4);
    parent_[find(4 * p.square + (p.corner + 1) % 4)] = find(4 * q.square + q.corner);
  }
  void join(const std::vector<Use>& uses) {
    for (std::size_t i = 0; i < uses.size(); ++i) {
      for (std::size_t k = i + 1; k < uses.size(); ++k) {
        if (uses.size() == 2 || squares_[uses[i].square].cell == squares_[uses[k].square].cell) join(uses[i], uses[k]);
      }
    }
  }
  CellSolid triangulated(Rng& rng) const {
    CellSolid solid;
    solid.windings = cells_;
    std::map<std::size_t, VertexId> ids;
    for (std::size_t s = 0; s < squares_.size(); ++s) {
      std::array<VertexId, 4> c{};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [found, is_new] = ids.try_emplace(find(4 * s + k), static_cast<VertexId>(solid.positions.size()));
        const Place& p = squares_[s].corners[k];
        if (is_new) {
          solid.positions.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
        }
        c[k] = found->second;
      }
      if (rng.below(2) == 0) std::rotate(c.begin(), c.begin() + 1, c.end());
      solid.triangles.push_back({c[0], c[1], c[2]});
      solid.triangles.push_back({c[2], c[3], c[0]});
      CellSolid::Rectangle r{squares_[s].corners[0], squares_[s].corners[0]};
      for (const Place& p : squares_[s].corners) {
        for (std::size_t k = 0; k < 3; ++k) r.low[k] = std::min(r.low[k], p[k]), r.high[k] = std::max(r.high[k], p[k]);
      }
      solid.rectangles.push_back(r);
    }
    return solid;
  }

  CellWindings cells_;
  std::vector<Square> squares_;
  std::map<std::pair<Place, Place>, std::vector<Use>> edges_;
  std::vector<std::size_t> parent_;
};

/// Cells drawn at random out of a few boxes, and their boundary.
inline CellSolid random_cells(Rng& rng) {
  CellWindings cells{};
  const int side = 2 + static_cast<int>(rng.below(2));
  const auto at = [&] { return static_cast<int>(rng.below(static_cast<std::uint64_t>(side))); };
  const std::uint64_t full = 1 + rng.below(4);  // of four
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) cells[cell_index(x, y, z)] = rng.below(4) < full ? 1 : 0;
    }
  }
  cells[cell_index(at(), at(), at())] = 1;
  return CellBoundary(cells).surface(rng);
}

/// What is known of two solids of cells.
inline SolidRelation relation_of_cells(const CellSolid& a, const CellSolid& b, bool& surfaces_meet) {
  bool both = false, a_alone = false, b_alone = false;
  for (std::size_t i = 0; i < a.windings.size(); ++i) {
    const bool in_a = a.windings[i] != 0, in_b = b.windings[i] != 0;
    both = both || (in_a && in_b), a_alone = a_alone || (in_a && !in_b), b_alone = b_alone || (in_b && !in_a);
  }
  surfaces_meet = false;
  for (const auto& r : a.rectangles) {
    for (const auto& s : b.rectangles) {
      bool meet = true;
      for (std::size_t k = 0; k < 3; ++k) meet = meet && r.low[k] <= s.high[k] && s.low[k] <= r.high[k];
      surfaces_meet = surfaces_meet || meet;
    }
  }
  if (!both) return surfaces_meet ? SolidRelation::touching : SolidRelation::apart;
  if (a_alone) return b_alone ? SolidRelation::overlapping : SolidRelation::b_inside_a;
  return b_alone ? SolidRelation::a_inside_b : SolidRelation::equal;
}

}  // namespace limber::testing
