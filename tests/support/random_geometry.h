// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "limber/geometry.h"
#include "limber/mesh.h"
#include "scenes/scenes.h"

/// Random triangles of the kinds that break geometry code, from a seeded generator.
namespace limber::testing {

using scenes::Rng;

/// How many cases a long test draws: the number in an environment variable, or the usual one.
inline std::uint64_t count_from(const char* variable, std::uint64_t usual) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::stoull(text) : usual;
}

/// The values of an enumeration that ends with `count`.
template <typename Kind>
std::vector<Kind> every_kind() {
  std::vector<Kind> kinds;
  for (int i = 0; i < static_cast<int>(Kind::count); ++i) kinds.push_back(static_cast<Kind>(i));
  return kinds;
}

inline Vec3 uniform_point(Rng& rng, double low = -1, double high = 1) {
  const double x = rng.uniform(low, high), y = rng.uniform(low, high), z = rng.uniform(low, high);
  return {x, y, z};
}

/// Integer coordinates 0 ... side - 1: every degeneracy happens often.
inline Vec3 lattice_point(Rng& rng, std::uint64_t side = 4) {
  const auto x = static_cast<double>(rng.below(side));
  const auto y = static_cast<double>(rng.below(side));
  const auto z = static_cast<double>(rng.below(side));
  return {x, y, z};
}

/// Each coordinate moved by up to `ulps` units in the last place.
inline Vec3 nudged(Rng& rng, Vec3 p, int ulps = 2) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto steps = static_cast<int>(rng.below(static_cast<std::uint64_t>(2 * ulps + 1))) - ulps;
    for (int i = 0; i < std::abs(steps); ++i) p[axis] = std::nextafter(p[axis], steps > 0 ? HUGE_VAL : -HUGE_VAL);
  }
  return p;
}

inline Vec3 point_on(const Triangle& t, double u, double v) { return t.v0 + u * (t.v1 - t.v0) + v * (t.v2 - t.v0); }

enum class PairKind {
  uniform,
  lattice,
  near_lattice,
  touching,
  sliver,
  coplanar,
  shared_edge,
  mixed_scale,
  far_away,
  tiny_coordinates,
  segment_like,
  one_line,
  needle,
  count
};

/// The name of a test that has a kind as its parameter.
inline void PrintTo(PairKind kind, std::ostream* out) {
  constexpr const char* names[] = {"uniform",      "lattice",     "near_lattice", "touching", "sliver",
                                   "coplanar",     "shared_edge", "mixed_scale",  "far_away", "tiny_coordinates",
                                   "segment_like", "one_line",    "needle"};
  *out << names[static_cast<std::size_t>(kind)];
}

inline Triangle uniform_triangle(Rng& rng) {
  const Vec3 v0 = uniform_point(rng), v1 = uniform_point(rng), v2 = uniform_point(rng);
  return {v0, v1, v2};
}

inline Triangle lattice_triangle(Rng& rng, std::uint64_t side = 4) {
  const Vec3 v0 = lattice_point(rng, side), v1 = lattice_point(rng, side), v2 = lattice_point(rng, side);
  return {v0, v1, v2};
}

inline Triangle nudged(Rng& rng, const Triangle& t, int ulps = 2) {
  const Vec3 v0 = nudged(rng, t.v0, ulps), v1 = nudged(rng, t.v1, ulps), v2 = nudged(rng, t.v2, ulps);
  return {v0, v1, v2};
}

/// A triangle with every corner mapped.
template <typename Map>
Triangle mapped(const Triangle& t, const Map& map) {
  return {map(t.v0), map(t.v1), map(t.v2)};
}

/// The extent of geometry.h.
inline double extent_of_pair(const Triangle& a, const Triangle& b) {
  double extent = 0;
  for (std::size_t i = 0; i < 3; ++i) extent = std::max({extent, max_abs(a[i] - a.v0), max_abs(b[i] - a.v0)});
  return extent;
}

inline double largest_coordinate(const Triangle& a, const Triangle& b) {
  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i) largest = std::max({largest, max_abs(a[i]), max_abs(b[i])});
  return largest;
}

/// The smallest height of a triangle, rounded.
inline double smallest_height_of(const Triangle& t) {
  const double longest = std::max({length(t.v1 - t.v0), length(t.v2 - t.v1), length(t.v0 - t.v2)});
  return longest == 0 ? 0 : length(cross(t.v1 - t.v0, t.v2 - t.v0)) / longest;
}

/// A point at p, a few units in the last place away, or a little more.
inline Vec3 near_point(Rng& rng, const Vec3& p) {
  const std::uint64_t kind = rng.below(3);
  if (kind == 0) return p;
  if (kind == 1) return nudged(rng, p);
  return p + std::ldexp(1.0, -static_cast<int>(rng.below(60))) * uniform_point(rng);
}

/// A segment as a triangle: a corner comes twice, or lies nearly between the two others.
inline Triangle segment_like_triangle(Rng& rng, const Vec3& from, const Vec3& to) {
  const std::uint64_t kind = rng.below(4);
  const Vec3 between = kind == 0 ? from : kind == 1 ? to : from + rng.uniform() * (to - from);
  const Vec3 corners[3] = {from, kind == 3 ? near_point(rng, between) : between, to};
  const std::size_t first = rng.below(3);
  return {corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]};
}

/// Two segments as triangles, which nearly meet: at their ends, nearly parallel, or across.
inline std::pair<Triangle, Triangle> segment_like_pair(Rng& rng) {
  const auto some_point = [&] { return rng.below(2) == 0 ? uniform_point(rng) : lattice_point(rng); };
  const Vec3 p = some_point(), q = some_point(), middle = near_point(rng, p + rng.uniform() * (q - p));
  const Triangle a = segment_like_triangle(rng, p, q);
  const std::uint64_t kind = rng.below(3);
  if (kind == 0) {
    const Vec3 near_p = near_point(rng, p), near_q = near_point(rng, q);
    return {a, segment_like_triangle(rng, near_p, near_q)};
  }
  const Vec3 sideways = std::ldexp(1.0, -static_cast<int>(rng.below(60))) * uniform_point(rng);
  const Vec3 along = kind == 1 ? (q - p) + sideways : uniform_point(rng);
  const double part = rng.below(2) == 0 ? 0 : rng.uniform();
  return {a, segment_like_triangle(rng, middle - part * along, middle + (1 - part) * along)};
}

/// Two triangles with a corner each at the origin or next to it, as thin as doubles allow.
inline std::pair<Triangle, Triangle> needle_pair(Rng& rng) {
  const auto tiny = [&] {
    const std::uint64_t kind = rng.below(4);
    if (kind == 0) return 0.0;
    // Any, or such that its square is next to the smallest doubles.
    return std::ldexp(1.0, -static_cast<int>(kind == 1 ? 500 + rng.below(50) : rng.below(1075)));
  };
  const auto some_needle = [&] {
    const Vec3 along = rng.below(2) == 0 ? lattice_point(rng) : uniform_point(rng);
    const Vec3 aside = rng.below(2) == 0 ? lattice_point(rng) : uniform_point(rng);
    const double part = rng.below(3) == 0 ? 0 : rng.below(2) == 0 ? 1 / 3.0 : rng.uniform();
    const Vec3 corners[3] = {Vec3{}, along, part * along + tiny() * aside};
    const std::size_t first = rng.below(3);
    return Triangle{corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]};
  };
  const Triangle a = some_needle(), b = some_needle();
  const Vec3 by = tiny() * uniform_point(rng);
  return {a, {b.v0 + by, b.v1 + by, b.v2 + by}};
}

/// Two triangles of a kind; see the switch.
inline std::pair<Triangle, Triangle> random_pair(Rng& rng, PairKind kind) {
  switch (kind) {
    case PairKind::lattice: {
      const Triangle a = lattice_triangle(rng), b = lattice_triangle(rng);
      return {a, b};
    }
    case PairKind::near_lattice: {
      const Triangle a = nudged(rng, lattice_triangle(rng)), b = nudged(rng, lattice_triangle(rng));
      return {a, b};
    }
    case PairKind::touching: {  // a corner of b lies on a up to rounding
      const Triangle a = uniform_triangle(rng);
      const double u = rng.uniform(), v = rng.uniform() * (1 - u);
      const Vec3 p = uniform_point(rng), q = uniform_point(rng);
      return {a, {nudged(rng, point_on(a, u, v), 1), p, q}};
    }
    case PairKind::sliver: {  // third corners almost on the line of the others
      Triangle a = uniform_triangle(rng), b = uniform_triangle(rng);
      const double height = std::ldexp(1.0, -static_cast<int>(rng.below(60)));
      a.v2 = a.v0 + rng.uniform() * (a.v1 - a.v0) + height * uniform_point(rng);
      b.v2 = b.v0 + rng.uniform() * (b.v1 - b.v0) + height * uniform_point(rng);
      return {a, b};
    }
    case PairKind::coplanar: {  // in one oblique plane up to rounding
      const Triangle plane = uniform_triangle(rng);
      const auto in_plane = [&] {
        const double u = rng.uniform(-1, 1), v = rng.uniform(-1, 1);
        return point_on(plane, u, v);
      };
      const Vec3 a0 = in_plane(), a1 = in_plane(), a2 = in_plane(), b0 = in_plane(), b1 = in_plane(), b2 = in_plane();
      return {{a0, a1, a2}, {b0, b1, b2}};
    }
    case PairKind::shared_edge: {
      const Triangle a = uniform_triangle(rng);
      const Vec3 shared = rng.below(2) == 0 ? a.v1 : nudged(rng, a.v1, 1);
      const Vec3 near_v0 = nudged(rng, a.v0, 1), other = uniform_point(rng);
      return {a, {shared, near_v0, other}};
    }
    case PairKind::mixed_scale: {  // one up to 2^400 times smaller than the other, at a point of it
      const Triangle a = uniform_triangle(rng),
                     shape = rng.below(2) == 0 ? lattice_triangle(rng) : uniform_triangle(rng);
      const double scale = std::ldexp(1.0, -static_cast<int>(rng.below(400)));
      const double u = rng.below(3) == 0 ? 0 : rng.uniform(), v = rng.below(3) == 0 ? 0 : rng.uniform() * (1 - u);
      // At the origin the small one keeps all of its digits.
      const Vec3 at = point_on(a, u, v);
      const Triangle big = rng.below(2) == 0 ? a : Triangle{a.v0 - at, a.v1 - at, a.v2 - at};
      const Vec3 place = big.v0 == a.v0 ? at : Vec3{};
      return {big, {place + scale * shape.v0, place + scale * shape.v1, place + scale * shape.v2}};
    }
    case PairKind::far_away: {  // close to each other, far from the origin
      const double offset = std::ldexp(1.0, static_cast<int>(rng.below(45)));
      const Vec3 at = offset * uniform_point(rng);
      const auto [a, b] = random_pair(rng, rng.below(2) == 0 ? PairKind::lattice : PairKind::touching);
      return {{a.v0 + at, a.v1 + at, a.v2 + at}, {b.v0 + at, b.v1 + at, b.v2 + at}};
    }
    case PairKind::tiny_coordinates: {  // noise down to the smallest doubles in place of zeros
      auto [a, b] = random_pair(rng, rng.below(2) == 0 ? PairKind::lattice : PairKind::near_lattice);
      for (Vec3* corner : {&a.v0, &a.v1, &a.v2, &b.v0, &b.v1, &b.v2}) {
        if (rng.below(3) != 0) continue;
        (*corner)[rng.below(3)] = std::ldexp(rng.uniform(-1, 1), -static_cast<int>(rng.below(1074)));
      }
      return {a, b};
    }
    case PairKind::segment_like:
      return segment_like_pair(rng);
    case PairKind::one_line: {  // all six corners almost on one line
      const Vec3 at = uniform_point(rng), along = uniform_point(rng);
      const auto sliver = [&] {
        // Any, or such that the normal is barely known.
        const std::uint64_t bits = rng.below(2) == 0 ? rng.below(60) : 40 + rng.below(10);
        const double height = std::ldexp(1.0, -static_cast<int>(bits));
        const auto corner = [&] {
          const double part = rng.uniform(-2, 2);
          return at + part * along + height * uniform_point(rng);
        };
        const Vec3 v0 = corner(), v1 = corner(), v2 = corner();
        return Triangle{v0, v1, v2};
      };
      const Triangle a = sliver(), b = sliver();
      return {a, b};
    }
    case PairKind::needle:
      return needle_pair(rng);
    default: {
      const Triangle a = uniform_triangle(rng), b = uniform_triangle(rng);
      return {a, b};
    }
  }
}

inline Mesh soup(const std::vector<Triangle>& triangles) {
  std::vector<Vec3> positions;
  std::vector<Corners> corners;
  for (const Triangle& t : triangles) {
    const auto v = static_cast<VertexId>(positions.size());
    positions.insert(positions.end(), {t.v0, t.v1, t.v2});
    corners.push_back({v, v + 1, v + 2});
  }
  return Mesh::create(std::move(positions), std::move(corners)).value();
}

/// The mesh with every position mapped.
template <typename Map>
Mesh mapped(const Mesh& mesh, const Map& map) {
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) p = map(p);
  return Mesh::create(std::move(positions), mesh.triangles()).value();
}

/// Two meshes as one.
inline Mesh joined(const Mesh& a, const Mesh& b) {
  std::vector<Vec3> positions = a.positions();
  std::vector<Corners> triangles = a.triangles();
  const auto first = static_cast<VertexId>(positions.size());
  positions.insert(positions.end(), b.positions().begin(), b.positions().end());
  for (const Corners& c : b.triangles()) triangles.push_back({first + c[0], first + c[1], first + c[2]});
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// Moves every vertex of a model, and commits.
template <typename Model, typename Map>
void deform(Model& model, const Map& map) {
  std::vector<Vec3> positions = model.mesh().positions();
  for (Vec3& p : positions) p = map(p);
  model.move_all(positions).value();
  model.commit();
}

inline Transform random_pose(Rng& rng, double range) {
  const Mat3 rotation = scenes::random_rotation(rng);
  return {rotation, uniform_point(rng, -range, range)};
}

}  // namespace limber::testing
