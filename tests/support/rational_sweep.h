// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "support/rational_distance.h"

/// How far triangles have to move along a direction until they meet no more, in rational arithmetic and by another
/// route than the library's: all pairs of corners, edges and faces that may be the last to meet.
namespace limber::testing {

inline RationalVec cross(const RationalVec& a, const RationalVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Rational determinant(const RationalVec& a, const RationalVec& b, const RationalVec& c) {
  return dot(a, cross(b, c));
}
inline RationalVec negative(const RationalVec& v) { return {-v[0], -v[1], -v[2]}; }

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

}  // namespace limber::testing
