// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "limber/geometry.h"

/// Distances, separations and winding numbers in exact rational arithmetic, by other routes than the library's.
namespace limber::testing {

using Rational = mpq_class;
using RationalVec = std::array<Rational, 3>;

inline RationalVec rational(const Vec3& v) { return {Rational(v.x), Rational(v.y), Rational(v.z)}; }
inline RationalVec minus(const RationalVec& a, const RationalVec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Rational dot(const RationalVec& a, const RationalVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline RationalVec cross(const RationalVec& a, const RationalVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Rational determinant(const RationalVec& a, const RationalVec& b, const RationalVec& c) {
  return dot(a, cross(b, c));
}
inline RationalVec negative(const RationalVec& v) { return {-v[0], -v[1], -v[2]}; }

// --- distances: all pairs of faces, edges and corners as affine spaces, keeping the minimisers inside ---

/// Solves the symmetric positive semi-definite system m x = r of size n <= 4; nothing when it is singular.
inline std::optional<std::array<Rational, 4>> solve(std::array<std::array<Rational, 4>, 4> m, std::array<Rational, 4> r,
                                                    std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    while (pivot < n && m[pivot][k] == 0) ++pivot;
    if (pivot == n) return {};
    std::swap(m[k], m[pivot]);
    std::swap(r[k], r[pivot]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k || m[i][k] == 0) continue;
      const Rational f = m[i][k] / m[k][k];
      for (std::size_t j = k; j < n; ++j) m[i][j] -= f * m[k][j];
      r[i] -= f * r[k];
    }
  }
  for (std::size_t k = 0; k < n; ++k) r[k] /= m[k][k];
  return r;
}

/// The shortest vector from a point of one triangle to one of the other, without rounding. There is only one.
///
/// Every pair of sub-simplices is tried: if the closest points of their affine hulls are unique and have non-negative
/// weights, the distance is attained by points of the hulls; the minimum over all pairs is the true distance.
inline RationalVec closest_difference(const Triangle& a, const Triangle& b) {
  const std::array<RationalVec, 3> va{rational(a.v0), rational(a.v1), rational(a.v2)};
  const std::array<RationalVec, 3> vb{rational(b.v0), rational(b.v1), rational(b.v2)};
  std::optional<Rational> best;
  RationalVec best_between;
  for (unsigned mask_a = 1; mask_a < 8; ++mask_a) {
    for (unsigned mask_b = 1; mask_b < 8; ++mask_b) {
      std::array<RationalVec, 4> direction;  // towards a's points positive, b's negative
      std::size_t n = 0, n_a = 0;
      const auto first_of = [](unsigned mask) { return static_cast<std::size_t>((mask & 1) ? 0 : (mask & 2) ? 1 : 2); };
      const std::size_t a0 = first_of(mask_a), b0 = first_of(mask_b);
      for (std::size_t i = a0 + 1; i < 3; ++i) {
        if (mask_a & (1U << i)) direction[n++] = minus(va[i], va[a0]);
      }
      n_a = n;
      for (std::size_t i = b0 + 1; i < 3; ++i) {
        if (mask_b & (1U << i)) direction[n++] = minus(vb[b0], vb[i]);
      }
      const RationalVec start = minus(va[a0], vb[b0]);  // minimise |start + sum x_k direction_k|^2
      std::array<std::array<Rational, 4>, 4> m;
      std::array<Rational, 4> r;
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) m[i][j] = dot(direction[i], direction[j]);
        r[i] = -dot(direction[i], start);
      }
      const auto x = solve(m, r, n);
      if (!x) continue;  // not unique: a smaller pair attains the same minimum
      Rational sum_a = 0, sum_b = 0;
      bool inside = true;
      RationalVec between = start;
      for (std::size_t k = 0; k < n; ++k) {
        inside = inside && (*x)[k] >= 0;
        (k < n_a ? sum_a : sum_b) += (*x)[k];
        for (std::size_t axis = 0; axis < 3; ++axis) between[axis] += (*x)[k] * direction[k][axis];
      }
      if (!inside || sum_a > 1 || sum_b > 1) continue;
      const Rational d_sq = dot(between, between);
      if (!best || d_sq < *best) best = d_sq, best_between = between;
    }
  }
  return {-best_between[0], -best_between[1], -best_between[2]};
}

inline Rational squared_distance(const Triangle& a, const Triangle& b) {
  const RationalVec between = closest_difference(a, b);
  return dot(between, between);
}

/// Whether a sphere holds a point, without rounding.
inline bool exactly_inside(const Sphere& sphere, const Vec3& p) {
  const RationalVec d = minus(rational(p), rational(sphere.center));
  return dot(d, d) <= Rational(sphere.radius) * Rational(sphere.radius);
}

/// How far b has to move along `axis`, in units of the axis, until it is not behind a.
inline Rational overlap_along(const RationalVec& axis, const Triangle& a, const Triangle& b) {
  Rational end = dot(axis, rational(a.v0)), start = dot(axis, rational(b.v0));
  for (std::size_t i = 1; i < 3; ++i) {
    end = std::max(end, dot(axis, rational(a[i])));
    start = std::min(start, dot(axis, rational(b[i])));
  }
  return end - start;
}

// --- how far triangles have to move along a direction until they meet no more: all pairs of corners, edges and faces
// that may be the last to meet ---

/// The x with x[0] a + x[1] b + x[2] c = r; nothing if there is not exactly one.
inline std::optional<RationalVec> combination(const RationalVec& a, const RationalVec& b, const RationalVec& c,
                                              const RationalVec& r) {
  const Rational d = determinant(a, b, c);
  if (d == 0) return {};
  return RationalVec{determinant(r, b, c) / d, determinant(a, r, c) / d, determinant(a, b, r) / d};
}

/// The largest s at which a meets b moved by s * d; nothing if they never meet.
class RationalSweep {
 public:
  explicit RationalSweep(const Vec3& direction) : d_(rational(direction)) {}

  void compare(const Triangle& a, const Triangle& b) {
    for (std::size_t i = 0; i < 3; ++i) {
      const RationalVec p = rational(a[i]), q = rational(b[i]);
      corner_and_face(p, b, d_), corner_and_face(q, a, negative(d_));
      for (std::size_t k = 0; k < 3; ++k) {
        const RationalVec r = rational(b[k]);
        corners(minus(p, r));
        corner_and_edge(minus(p, r), minus(rational(b[(k + 1) % 3]), r), d_);
        const RationalVec o = rational(a[k]);
        corner_and_edge(minus(q, o), minus(rational(a[(k + 1) % 3]), o), negative(d_));
        edges(minus(p, r), minus(rational(a[(i + 1) % 3]), p), minus(rational(b[(k + 1) % 3]), r));
      }
    }
  }

  const std::optional<Rational>& last() const { return last_; }

 private:
  void consider(const Rational& s) {
    if (!last_ || s > *last_) last_ = s;
  }
  /// p = a point of the face + s * d.
  void corner_and_face(const RationalVec& p, const Triangle& face, const RationalVec& d) {
    const RationalVec o = rational(face.v0);
    const auto x = combination(minus(rational(face.v1), o), minus(rational(face.v2), o), d, minus(p, o));
    if (x && (*x)[0] >= 0 && (*x)[1] >= 0 && (*x)[0] + (*x)[1] <= 1) consider((*x)[2]);
  }
  /// apart = v * edge + s * d.
  void corner_and_edge(const RationalVec& apart, const RationalVec& edge, const RationalVec& d) {
    const RationalVec normal = cross(edge, d);
    const Rational size = dot(normal, normal);
    if (size == 0 || dot(apart, normal) != 0) return;
    const Rational v = dot(cross(apart, d), normal) / size, s = dot(cross(edge, apart), normal) / size;
    if (v >= 0 && v <= 1) consider(s);
  }
  /// apart = s * d.
  void corners(const RationalVec& apart) {
    const RationalVec across = cross(apart, d_);
    if (dot(across, across) == 0) consider(dot(apart, d_) / dot(d_, d_));
  }
  /// apart + u * e = v * f + s * d.
  void edges(const RationalVec& apart, const RationalVec& e, const RationalVec& f) {
    const auto x = combination(negative(e), f, d_, apart);
    if (x && (*x)[0] >= 0 && (*x)[0] <= 1 && (*x)[1] >= 0 && (*x)[1] <= 1) consider((*x)[2]);
  }

  RationalVec d_;
  std::optional<Rational> last_;
};

/// That of two sets of triangles: 0 where they do not meet at any s >= 0. Pairs are left out if they are apart across
/// the direction by far more than rounding, or cannot meet later than another one by that much.
inline Rational rational_separation(const std::vector<Triangle>& a, const std::vector<Triangle>& b, const Vec3& d) {
  const Vec3 x = std::abs(d.x) < 0.6 ? cross(d, Vec3{1, 0, 0}) : cross(d, Vec3{0, 1, 0}), axes[] = {x, cross(d, x), d};
  const auto box_of = [&](const Triangle& t) {
    const auto seen = [&](const Vec3& p) { return Vec3{dot(axes[0], p), dot(axes[1], p), dot(axes[2], p)}; };
    return Box{min(min(seen(t.v0), seen(t.v1)), seen(t.v2)), max(max(seen(t.v0), seen(t.v1)), seen(t.v2))};
  };
  struct Pair {
    double bound;
    const Triangle *a, *b;
  };
  std::vector<Pair> pairs;
  for (const Triangle& t : a) {
    const Box of_t = box_of(t);
    for (const Triangle& u : b) {
      const Box of_u = box_of(u);
      const double slack = 0x1p-40 * (max_abs(of_t.low) + max_abs(of_t.high) + max_abs(of_u.low) + max_abs(of_u.high));
      const Vec3 over = max(of_t.low - of_u.high, of_u.low - of_t.high);
      if (over.x <= slack && over.y <= slack) {
        pairs.push_back({(of_t.high.z - of_u.low.z + slack) / dot(d, d) * (1 + 0x1p-40), &t, &u});
      }
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) { return p.bound > q.bound; });
  RationalSweep sweep(d);
  for (const Pair& pair : pairs) {
    if (pair.bound < 0 || (sweep.last() && *sweep.last() > pair.bound)) break;
    sweep.compare(*pair.a, *pair.b);
  }
  return sweep.last() && *sweep.last() > 0 ? *sweep.last() : Rational(0);
}

// --- winding numbers of closed surfaces: a ray in a direction of no axis, and another one where that meets an edge ---

/// Along one ray; nothing where the ray meets an edge, or the line it lies on does.
inline std::optional<int> winding_along_ray(const std::vector<Triangle>& triangles, const Vec3& point,
                                            const Vec3& direction) {
  const RationalVec p = rational(point), d = rational(direction);
  int winding_number = 0;
  for (const Triangle& t : triangles) {
    const RationalVec a = minus(rational(t.v0), p), b = minus(rational(t.v1), p), c = minus(rational(t.v2), p);
    const int ab = sgn(determinant(d, a, b)), bc = sgn(determinant(d, b, c)), ca = sgn(determinant(d, c, a));
    if (ab * bc < 0 || bc * ca < 0 || ca * ab < 0) continue;
    if (ab == 0 || bc == 0 || ca == 0) return std::nullopt;
    // d passes through the triangle where the origin sees its back, and -d where it sees its front.
    const int back = sgn(determinant(a, b, c));
    if (back == ab) winding_number += ab;
  }
  return winding_number;
}

/// Pre: the point is not on the surface.
inline int rational_winding(const std::vector<Triangle>& triangles, const Vec3& point) {
  for (double x = 1;; x += 1) {
    const std::optional<int> found = winding_along_ray(triangles, point, {x, 1 / (x + 0.37), 0.71 / x});
    if (found) return *found;
  }
}

}  // namespace limber::testing
