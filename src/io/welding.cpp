// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/welding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/check.h"

namespace limber::io {
namespace {

bool is_before(const Vec3& p, const Vec3& q) { return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z); }

/// Takes the vertices that are before or behind the first of their group out of it. Those of one group that are neither
/// before nor behind each other form a group of their own.
template <typename Before>
void regroup(std::vector<VertexId>& first_of, const Before& is_before) {
  std::vector<VertexId> parted;
  for (VertexId v = 0; v < first_of.size(); ++v) {
    if (is_before(v, first_of[v]) || is_before(first_of[v], v)) parted.push_back(v);
  }
  std::sort(parted.begin(), parted.end(), [&](VertexId a, VertexId b) {
    if (first_of[a] != first_of[b]) return first_of[a] < first_of[b];
    if (is_before(a, b) || is_before(b, a)) return is_before(a, b);
    return a < b;
  });
  VertexId old_group = no_id, first = no_id;
  for (const VertexId v : parted) {
    if (first_of[v] != old_group || is_before(first, v)) first = v;
    old_group = first_of[v];
    first_of[v] = first;
  }
}

/// The part of the first face that names a vertex; no_id where none does.
std::vector<std::uint32_t> parts_of_vertices(const Soup& soup) {
  std::vector<std::uint32_t> part_of_vertex(soup.positions.size(), no_id);
  for (std::size_t f = soup.part_of_face.size(); f-- > 0;) {
    for (const std::uint32_t corner : soup.faces[f]) part_of_vertex[corner] = soup.part_of_face[f];
  }
  return part_of_vertex;
}

/// A cube of space, and a part whose vertices are in it.
struct Cell {
  std::array<double, 3> cube;
  std::uint32_t part;
  bool operator==(const Cell&) const = default;
  bool operator<(const Cell& other) const { return std::tie(cube, part) < std::tie(other.cube, other.part); }
};

/// The cubes that a cube of space around a position, of twice the tolerance, reaches into, each once.
std::vector<Cell> cells_around(const Vec3& p, double tolerance, std::uint32_t part) {
  const auto cube_of = [&](double coordinate) { return std::floor(coordinate / (4 * tolerance)); };
  std::array<std::vector<double>, 3> reached;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Far from the origin, where neighbors in float64 are farther apart than cubes, all three differ.
    reached[axis] = {cube_of(p[axis] - tolerance), cube_of(p[axis]), cube_of(p[axis] + tolerance)};
    reached[axis].erase(std::unique(reached[axis].begin(), reached[axis].end()), reached[axis].end());
  }
  std::vector<Cell> cells;
  for (const double x : reached[0]) {
    for (const double y : reached[1]) {
      for (const double z : reached[2]) cells.push_back({{x, y, z}, part});
    }
  }
  return cells;
}

}  // namespace

bool are_together(const Vec3& p, const Vec3& q, double tolerance) {
  return p == q || std::hypot(p.x - q.x, p.y - q.y, p.z - q.z) <= tolerance;
}

Welding::Welding(const Soup& first_frame, const ReadOptions& options) : tolerance_(options.weld_tolerance) {
  const std::vector<Vec3>& positions = first_frame.positions;
  equal_to_.resize(positions.size());
  std::iota(equal_to_.begin(), equal_to_.end(), VertexId{0});
  if (!options.weld) return;
  const Weld equal = weld(positions);
  for (VertexId& v : equal_to_) v = equal.first_of[equal.welded_of[v]];
  std::vector<std::uint32_t> part_of_vertex(positions.size(), 0);
  if (options.parts) {
    part_of_vertex = parts_of_vertices(first_frame);
    regroup(equal_to_, [&](VertexId a, VertexId b) { return part_of_vertex[a] < part_of_vertex[b]; });
  }
  if (tolerance_ > 0) join_near(positions, part_of_vertex);
}

void Welding::join_near(std::span<const Vec3> positions, std::span<const std::uint32_t> part_of_vertex) {
  const auto own_cell = [&](VertexId v) {
    const Vec3& p = positions[v];
    const double edge = 4 * tolerance_;
    return Cell{{std::floor(p.x / edge), std::floor(p.y / edge), std::floor(p.z / edge)}, part_of_vertex[v]};
  };
  std::vector<Cell> cells;
  for (VertexId v = 0; v < positions.size(); ++v) {
    if (equal_to_[v] == v) cells.push_back(own_cell(v));
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const auto index_of = [&](const Cell& cell) {
    return static_cast<std::size_t>(std::lower_bound(cells.begin(), cells.end(), cell) - cells.begin());
  };

  // Mesh vertices are farther apart than the tolerance, so a cell lists few.
  std::vector<VertexId> last_in_cell(cells.size(), no_id), one_before(positions.size(), no_id);
  joined_to_ = equal_to_;
  for (VertexId v = 0; v < positions.size(); ++v) {
    if (equal_to_[v] != v) {
      joined_to_[v] = joined_to_[equal_to_[v]];
      continue;
    }
    for (const Cell& cell : cells_around(positions[v], tolerance_, part_of_vertex[v])) {
      const std::size_t index = index_of(cell);
      if (index == cells.size() || cells[index] != cell) continue;
      for (VertexId u = last_in_cell[index]; u != no_id; u = one_before[u]) {
        if (u < joined_to_[v] && are_together(positions[u], positions[v], tolerance_)) joined_to_[v] = u;
      }
    }
    if (joined_to_[v] == v) one_before[v] = std::exchange(last_in_cell[index_of(own_cell(v))], v);
  }
}

bool Welding::joins_any() const {
  const std::vector<VertexId>& first_of = joined_to_.empty() ? equal_to_ : joined_to_;
  for (VertexId v = 0; v < first_of.size(); ++v) {
    if (first_of[v] != v) return true;
  }
  return false;
}

void Welding::part(std::span<const Vec3> frame) {
  LIMBER_ASSERT(frame.size() == equal_to_.size());
  regroup(equal_to_, [&](VertexId a, VertexId b) { return is_before(frame[a], frame[b]); });
  for (VertexId v = 0; v < joined_to_.size(); ++v) {
    if (equal_to_[v] != v) {
      joined_to_[v] = joined_to_[equal_to_[v]];
    } else if (!are_together(frame[v], frame[joined_to_[v]], tolerance_)) {
      joined_to_[v] = v;
    }
  }
}

Weld Welding::result() const {
  const std::vector<VertexId>& first_of = joined_to_.empty() ? equal_to_ : joined_to_;
  Weld result;
  result.welded_of.reserve(first_of.size());
  for (VertexId v = 0; v < first_of.size(); ++v) {
    const bool is_first = first_of[v] == v;
    result.welded_of.push_back(is_first ? static_cast<VertexId>(result.first_of.size())
                                        : result.welded_of[first_of[v]]);
    if (is_first) result.first_of.push_back(v);
  }
  return result;
}

}  // namespace limber::io
