// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh_of_soup.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

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
  // Vertices within the tolerance are so along any direction. Along this one few others are: it is normal to no
  // plane that is usual in models.
  constexpr Vec3 direction = {0.36, 0.48, 0.8};
  std::vector<std::pair<double, VertexId>> along;
  double slack = tolerance_;
  for (VertexId v = 0; v < positions.size(); ++v) {
    if (equal_to_[v] != v) continue;
    const Vec3& p = positions[v];
    along.emplace_back(dot(direction, p), v);
    slack = std::max(slack, tolerance_ + 1e-14 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z)));  // of rounding
  }
  std::sort(along.begin(), along.end());
  std::vector<std::size_t> place(positions.size());
  for (std::size_t i = 0; i < along.size(); ++i) place[along[i].second] = i;
  joined_to_ = equal_to_;
  for (VertexId v = 0; v < positions.size(); ++v) {
    joined_to_[v] = joined_to_[equal_to_[v]];
    if (equal_to_[v] != v) continue;
    const auto try_to_join = [&](VertexId u) {
      if (u < joined_to_[v] && joined_to_[u] == u && part_of_vertex[u] == part_of_vertex[v] &&
          are_together(positions[u], positions[v], tolerance_)) {
        joined_to_[v] = u;
      }
    };
    const double here = along[place[v]].first;
    for (std::size_t i = place[v]; i-- > 0 && here - along[i].first <= slack;) try_to_join(along[i].second);
    for (std::size_t i = place[v] + 1; i < along.size() && along[i].first - here <= slack; ++i) {
      try_to_join(along[i].second);
    }
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
