// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
// Based on [Meisters1975]: a simple polygon that is no triangle has two ears.
// Differs  Corners may lie on straight lines and be visited twice, as by a cut that leads to a hole. Positions equal to
//          a corner of the ear do not spoil it; every other one on its border does, so no corner ends inside an edge.
//          Where the face comes to one of its edges from inside, no ear may be left: edge and corner part the face.
#include "io/mesh_of_soup.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "limber/geometry.h"
#include "limber/io.h"

namespace limber::io {
namespace {

/// The sum of the normals of a face's fan, each as long as the triangle is large. Its length is scaled.
Vec3 newell_normal(std::span<const Vec3> positions, std::span<const std::uint32_t> face) {
  const Vec3 origin = positions[face[0]];
  double extent = 0;
  for (const std::uint32_t corner : face) {
    const Vec3 arm = positions[corner] - origin;
    extent = std::max({extent, std::abs(arm.x), std::abs(arm.y), std::abs(arm.z)});
  }
  if (extent == 0) return {};
  const auto arm_to = [&, scale = -std::ilogb(extent)](std::uint32_t corner) {
    const Vec3 arm = positions[corner] - origin;
    return Vec3{std::scalbn(arm.x, scale), std::scalbn(arm.y, scale), std::scalbn(arm.z, scale)};
  };
  Vec3 normal;
  for (std::size_t i = 2; i < face.size(); ++i) normal = normal + cross(arm_to(face[i - 1]), arm_to(face[i]));
  return normal;
}

}  // namespace

int PolygonTriangles::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  return direction_ * orient2d(positions_[face_[a]], positions_[face_[b]], positions_[face_[c]], axis_);
}

std::span<const std::uint32_t> PolygonTriangles::split(std::span<const std::uint32_t> face, std::size_t number) {
  triangles_.clear();
  face_ = face;
  const auto count = static_cast<std::uint32_t>(face.size());
  bool is_fan = true;
  if (count > 3) {
    const Vec3 normal = newell_normal(positions_, face);
    axis_ = std::abs(normal.x) > std::abs(normal.y) ? 0 : 1;
    if (std::abs(normal.z) >= std::abs(normal[axis_])) axis_ = 2;
    direction_ = normal[axis_] > 0 ? 1 : normal[axis_] < 0 ? -1 : 0;
    for (std::uint32_t i = 2; i < count && is_fan; ++i) is_fan = turn(0, i - 1, i) >= 0;
  }
  if (!is_fan) {
    cut_ears();
    if (test_count_ > mesh_file_limits::corner_tests) {
      throw BadResult(
          {ErrorCode::too_large, "face " + std::to_string(number) + " takes too long to split into triangles", number});
    }
  } else {
    for (std::uint32_t i = 2; i < count; ++i) triangles_.insert(triangles_.end(), {0, i - 1, i});
  }
  LIMBER_ASSERT(triangles_.size() == 3 * (std::max<std::size_t>(count, 2) - 2));
  return triangles_;
}

bool PolygonTriangles::are_equal(std::uint32_t a, std::uint32_t b) const {
  const Vec3 &p = positions_[face_[a]], &q = positions_[face_[b]];
  const std::size_t u = (axis_ + 1) % 3, w = (axis_ + 2) % 3;
  return p[u] == q[u] && p[w] == q[w];
}

bool PolygonTriangles::covers_nothing(std::uint32_t corner) const {
  const std::uint32_t a = prev_[corner], c = next_[corner];
  return are_equal(a, corner) || are_equal(corner, c) || are_equal(c, a);
}

bool PolygonTriangles::is_ear(std::uint32_t corner) {
  if (covers_nothing(corner)) return true;
  if (!is_convex_[corner]) return false;
  const std::uint32_t a = prev_[corner], b = corner, c = next_[corner];
  const Vec3 &p_a = positions_[face_[a]], &p_b = positions_[face_[b]], &p_c = positions_[face_[c]];
  const Vec3 low = min(min(p_a, p_b), p_c), high = max(max(p_a, p_b), p_c);
  const std::size_t u = (axis_ + 1) % 3, w = (axis_ + 2) % 3;
  for (std::uint32_t d = next_[c]; d != a; d = next_[d]) {
    ++test_count_;
    const Vec3& p = positions_[face_[d]];
    if (p[u] < low[u] || p[u] > high[u] || p[w] < low[w] || p[w] > high[w]) continue;
    // Where the face comes back to a corner of the ear, it may go on inside of it.
    const std::uint32_t same = are_equal(d, a) ? a : are_equal(d, b) ? b : are_equal(d, c) ? c : d;
    if (same != d) {
      // Between two visits with the same edges there may be nothing of the face.
      if (same == b && are_equal(prev_[d], c) && are_equal(next_[d], a)) return false;
      const std::uint32_t before = same == a ? c : same == b ? a : b, after = same == a ? b : same == b ? c : a;
      const auto is_between = [&](std::uint32_t q) { return turn(before, same, q) > 0 && turn(same, after, q) > 0; };
      if (is_between(prev_[d]) || is_between(next_[d])) return false;
      continue;
    }
    if (is_convex_[d]) continue;
    if (turn(a, b, d) >= 0 && turn(b, c, d) >= 0 && turn(c, a, d) >= 0) return false;
  }
  return true;
}

bool PolygonTriangles::cut_touching(std::uint32_t& corner, std::uint32_t& left) {
  struct Ring {
    std::uint32_t first, last, size;  // with the touching corner, which is in both rings
  };
  const std::size_t u = (axis_ + 1) % 3, w = (axis_ + 2) % 3;
  std::uint32_t a = corner;
  for (std::uint32_t edge = 0; edge < left; ++edge, a = next_[a]) {
    const std::uint32_t b = next_[a];
    const Vec3 low = min(positions_[face_[a]], positions_[face_[b]]);
    const Vec3 high = max(positions_[face_[a]], positions_[face_[b]]);
    std::uint32_t size = 2;
    for (std::uint32_t d = next_[b]; d != a; d = next_[d], ++size) {
      if (++test_count_ > mesh_file_limits::corner_tests) return false;
      const Vec3& p = positions_[face_[d]];
      if (is_convex_[d] || p[u] < low[u] || p[u] > high[u] || p[w] < low[w] || p[w] > high[w]) continue;
      if (turn(a, b, d) != 0 || are_equal(d, a) || are_equal(d, b)) continue;
      const int before = turn(a, b, prev_[d]), after = turn(a, b, next_[d]);
      const bool is_spike = prev_[d] == b || next_[d] == a;  // there and back
      if (before < 0 || after < 0 || (before + after == 0 && !is_spike)) continue;
      triangles_.insert(triangles_.end(), {a, b, d});
      Ring smaller = {b, prev_[d], size}, larger = {next_[d], a, left - size + 1};
      if (smaller.size > larger.size) std::swap(smaller, larger);
      const auto close = [&](const Ring& ring) {
        next_[d] = ring.first, prev_[d] = ring.last;
        prev_[ring.first] = next_[ring.last] = d;
        is_convex_[d] = turn(ring.last, d, ring.first) > 0;
      };
      close(smaller);
      cut_ring(d, smaller.size);
      close(larger);
      corner = d, left = larger.size;
      return true;
    }
  }
  return false;
}

void PolygonTriangles::cut_ears() {
  const auto left = static_cast<std::uint32_t>(face_.size());
  next_.resize(left);
  prev_.resize(left);
  is_convex_.resize(left);
  for (std::uint32_t i = 0; i < left; ++i) {
    next_[i] = i + 1 < left ? i + 1 : 0;
    prev_[i] = i > 0 ? i - 1 : left - 1;
    is_convex_[i] = turn(prev_[i], i, next_[i]) > 0;
  }
  cut_ring(0, left);
}

void PolygonTriangles::cut_ring(std::uint32_t corner, std::uint32_t left) {
  for (std::uint32_t passed = 0; left > 2 && test_count_ <= mesh_file_limits::corner_tests;) {
    // A face that neither crosses nor touches itself always has an ear. Without one some corner is cut off.
    if (left > 3 && passed < left && !is_ear(corner)) {
      corner = next_[corner];
      ++passed;
      ++test_count_;
      continue;
    }
    if (left > 3 && passed == left && cut_touching(corner, left)) {
      passed = 0;
      continue;
    }
    const std::uint32_t before = prev_[corner], after = next_[corner];
    triangles_.insert(triangles_.end(), {before, corner, after});
    next_[before] = after;
    prev_[after] = before;
    is_convex_[before] = turn(prev_[before], before, after) > 0;
    is_convex_[after] = turn(before, after, next_[after]) > 0;
    // A corner that covers no area is cut at once: its edges go both ways, so other ears would seem to cross them.
    // Otherwise the search skips the next corner, so that ears are less narrow.
    corner = covers_nothing(before) ? before : covers_nothing(after) ? after : next_[after];
    passed = 0;
    --left;
  }
}

}  // namespace limber::io
