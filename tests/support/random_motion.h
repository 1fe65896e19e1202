// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <ostream>

#include "limber/motion.h"

#include "support/random_geometry.h"

/// Random moving pairs of elements of the kinds that break continuous collision, from a seeded generator.
namespace limber::testing {

/// A vertex and the corners of a face, or the ends of two edges, at the start and at the end.
struct MovingCorners {
  Vec3 start[4], end[4];
};

enum class MotionKind {
  uniform,
  crossing,
  lattice,
  small_lattice,
  near_lattice,
  in_a_plane,
  on_a_line,
  still,
  touching_at_start,
  touching_at_end,
  touch_and_leave,
  common_vertex,
  parallel_edges,
  degenerate,
  mixed_scale,
  far_away,
  tiny_coordinates,
  all_scales,
  count
};

inline void PrintTo(MotionKind kind, std::ostream* out) {
  constexpr const char* names[] = {
      "uniform",        "crossing",   "lattice",           "small_lattice",   "near_lattice",     "in_a_plane",
      "on_a_line",      "still",      "touching_at_start", "touching_at_end", "touch_and_leave",  "common_vertex",
      "parallel_edges", "degenerate", "mixed_scale",       "far_away",        "tiny_coordinates", "all_scales"};
  *out << names[static_cast<std::size_t>(kind)];
}

inline void scale_by(MovingCorners& m, double factor) {
  for (Vec3& p : m.start) p *= factor;
  for (Vec3& p : m.end) p *= factor;
}

/// Some point in the face or on the first edge; weights are multiples of 1/16, so sums of lattice points are exact.
inline Vec3 point_of_element(Rng& rng, const Vec3 (&p)[4], bool is_face) {
  const double s = static_cast<double>(rng.below(5)) / 4;
  if (!is_face) return p[0] + s * (p[1] - p[0]);
  const double r = static_cast<double>(rng.below(5)) / 4 * (1 - s);
  return p[1] + s * (p[2] - p[1]) + r * (p[3] - p[1]);
}

/// Moves corner 0 of a vertex and face, or the whole first edge, so that the elements touch.
inline void make_touch(Rng& rng, Vec3 (&p)[4], bool is_face) {
  if (is_face) {
    p[0] = point_of_element(rng, p, true);
    return;
  }
  const Vec3 other = p[2] + static_cast<double>(rng.below(5)) / 4 * (p[3] - p[2]);
  const Vec3 shift = other - point_of_element(rng, p, false);
  p[0] += shift, p[1] += shift;
}

inline MovingCorners random_motion(Rng& rng, MotionKind kind, bool is_face) {
  MovingCorners m;
  const auto lattice = [&](std::uint64_t side) {
    for (int i = 0; i < 4; ++i) m.start[i] = lattice_point(rng, side), m.end[i] = lattice_point(rng, side);
  };
  const auto uniform = [&] {
    for (int i = 0; i < 4; ++i) m.start[i] = uniform_point(rng), m.end[i] = uniform_point(rng);
  };
  const auto lattice_or_uniform = [&](std::uint64_t side) { rng.below(2) == 0 ? lattice(side) : uniform(); };
  const auto flatten = [&](bool to_a_line) {
    const double a = static_cast<double>(rng.below(3)) - 1, b = static_cast<double>(rng.below(3)) - 1;
    const auto flat = [&](const Vec3& p) {
      return to_a_line ? Vec3{p.x, a * p.x, b * p.x} : Vec3{p.x, p.y, a * p.x + b * p.y};
    };
    for (Vec3& p : m.start) p = flat(p);
    for (Vec3& p : m.end) p = flat(p);
  };
  switch (kind) {
    case MotionKind::uniform:
      uniform();
      break;
    case MotionKind::crossing: {
      // One element flies by the other, and both change little.
      uniform();
      const Vec3 travel = 4 * uniform_point(rng);
      for (int i = 0; i < 4; ++i) {
        m.end[i] = m.start[i] + 0.1 * m.end[i];
        const bool is_moved = is_face ? i == 0 : i < 2;
        if (is_moved) m.start[i] -= travel, m.end[i] += travel;
      }
      break;
    }
    case MotionKind::lattice:
      lattice(8);
      break;
    case MotionKind::small_lattice:
      lattice(3);
      break;
    case MotionKind::near_lattice:
      lattice(4);
      for (Vec3& p : m.start) p = nudged(rng, p);
      for (Vec3& p : m.end) p = nudged(rng, p);
      break;
    case MotionKind::in_a_plane:
      if (rng.below(2) == 0) {
        lattice(5);
        flatten(false);
      } else {
        uniform();
        for (int i = 0; i < 4; ++i) m.start[i].z = m.end[i].z = 0.3;
      }
      break;
    case MotionKind::on_a_line:
      lattice(6);
      flatten(true);
      break;
    case MotionKind::still:
      lattice_or_uniform(3);
      for (int i = 0; i < 4; ++i) m.end[i] = m.start[i];
      if (rng.below(2) == 0) m.end[0] += lattice_point(rng, 3);
      break;
    case MotionKind::touching_at_start:
      lattice(5);
      make_touch(rng, m.start, is_face);
      break;
    case MotionKind::touching_at_end:
      lattice(5);
      make_touch(rng, m.end, is_face);
      break;
    case MotionKind::touch_and_leave: {
      // Let t go from -1 to 1. A vertex at (p t, 0, 0) is -k p t^2 above a face that tilts, with corners (x, y, k x t).
      // The determinant of an edge from (-4 + p t, q t) to (4 + r t, -q t), and one that stands upright at the origin,
      // is proportional to -q (p + r) t^2. Both are mapped by a linear map.
      const auto some = [&] { return static_cast<double>(rng.below(5)) - 2; };
      const Vec3 x{some(), some(), some()}, y{some(), some(), some()}, z{some(), some(), some()},
          at{some(), some(), some()};
      const double k = some(), p = some(), q = some(), r = some();
      const auto place = [&](double t, Vec3(&to)[4]) {
        const auto map = [&](double a, double b, double c) { return 8 * at + a * x + b * y + c * z; };
        if (is_face) {
          to[0] = map(p * t, 0, 0);
          to[1] = map(-4, -4, -4 * k * t), to[2] = map(4, -4, 4 * k * t), to[3] = map(q, 4, q * k * t);
        } else {
          to[0] = map(-4 + p * t, q * t, 0), to[1] = map(4 + r * t, -q * t, 0);
          to[2] = map(0, 0, -4), to[3] = map(0, 0, 4);
        }
      };
      place(-1, m.start), place(1, m.end);
      break;
    }
    case MotionKind::common_vertex:
      lattice_or_uniform(4);
      if (rng.below(2) == 0) {
        m.start[0] = m.start[3];
      } else {
        m.end[0] = m.end[3];
      }
      break;
    case MotionKind::parallel_edges: {
      lattice(5);
      const Vec3 direction = lattice_point(rng, 3);
      m.start[1] = m.start[0] + direction, m.start[3] = m.start[2] + 2 * direction;
      if (rng.below(2) == 0) m.end[1] = m.end[0] + direction, m.end[3] = m.end[2] - direction;
      break;
    }
    case MotionKind::degenerate:
      lattice(4);
      m.start[3] = m.start[2];
      if (rng.below(2) == 0) m.end[3] = m.end[2];
      if (rng.below(2) == 0) m.start[1] = m.start[2], m.end[1] = m.end[2];
      break;
    case MotionKind::mixed_scale: {
      uniform();
      const double small = std::ldexp(1.0, -static_cast<int>(rng.below(60)));
      for (int i = 1; i < 4; ++i) {
        m.start[i] = m.start[0] + small * (m.start[i] - m.start[0]);
        m.end[i] = m.end[0] + small * (m.end[i] - m.end[0]);
      }
      if (rng.below(2) == 0) make_touch(rng, m.end, is_face);
      break;
    }
    case MotionKind::far_away: {
      lattice(5);
      const Vec3 offset = std::ldexp(1.0, 20 + static_cast<int>(rng.below(34))) * uniform_point(rng);
      for (Vec3& p : m.start) p += offset;
      for (Vec3& p : m.end) p += offset;
      break;
    }
    case MotionKind::tiny_coordinates:
      lattice_or_uniform(4);
      scale_by(m, std::ldexp(1.0, -1000 - static_cast<int>(rng.below(75))));
      break;
    case MotionKind::all_scales:
      lattice(4);
      for (int i = 0; i < 4; ++i) {
        m.start[i] *= std::ldexp(1.0, static_cast<int>(rng.below(1270)) - 1072);
        m.end[i] *= std::ldexp(1.0, static_cast<int>(rng.below(1270)) - 1072);
      }
      break;
    case MotionKind::count:
      break;
  }
  return m;
}

inline ElementImpact impact_of(const MovingCorners& m, bool is_face, const ElementImpactOptions& options = {}) {
  const auto& [s, e] = m;
  if (is_face) {
    return time_of_impact(MovingPoint{s[0], e[0]}, MovingTriangle{{s[1], s[2], s[3]}, {e[1], e[2], e[3]}}, options);
  }
  return time_of_impact(MovingSegment{{s[0], s[1]}, {e[0], e[1]}}, MovingSegment{{s[2], s[3]}, {e[2], e[3]}}, options);
}

}  // namespace limber::testing
