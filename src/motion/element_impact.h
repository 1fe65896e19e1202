// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "base/check.h"
#include "limber/motion.h"

namespace limber::motion {

/// Two moving elements: a vertex and a face, or two edges.
///
/// Both kinds touch where w = s u + r v has a solution with parameters s and r within limits. The three vectors move
/// linearly. Let a, b, c, d be corners 0 to 3:
///
///   vertex a, face b, c, d       u = c - b, v = d - b, w = a - b; s >= 0, r >= 0, s + r <= 1
///
///   edges a to b and c to d      u = b - a, v = c - d, w = c - a; s and r in [0, 1], and c - r v is on the second edge
struct MovingElements {
  enum class Kind { vertex_face, edge_edge };

  Kind kind;
  /// [time][corner], at the start and at the end: the vertex and the corners of the face, or the ends of both edges.
  Vec3 corners[2][4];

  static MovingElements of(const MovingPoint& p, const MovingTriangle& t) {
    return {Kind::vertex_face, {{p.start, t.start.v0, t.start.v1, t.start.v2}, {p.end, t.end.v0, t.end.v1, t.end.v2}}};
  }
  static MovingElements of(const MovingSegment& a, const MovingSegment& b) {
    return {Kind::edge_edge,
            {{a.start.p0, a.start.p1, b.start.p0, b.start.p1}, {a.end.p0, a.end.p1, b.end.p0, b.end.p1}}};
  }
};

/// The width to which times are narrowed: the spacing of doubles between 1/2 and 1. Shorter pieces are not halved.
inline constexpr double time_resolution = 0x1p-53;

/// The three vectors of MovingElements at a time. Where det(u, v, w) is 0 the elements are in one plane; divided by
/// |u x v| it is the distance of the vertex from the plane of the face, or that of the lines of the edges.
struct Vectors {
  Vec3 u, v, w;
};

inline Vectors operator+(const Vectors& a, const Vectors& b) { return {a.u + b.u, a.v + b.v, a.w + b.w}; }
inline Vectors operator-(const Vectors& a, const Vectors& b) { return {a.u - b.u, a.v - b.v, a.w - b.w}; }
inline Vectors operator*(double s, const Vectors& a) { return {s * a.u, s * a.v, s * a.w}; }

inline Vectors vectors_of(MovingElements::Kind kind, const Vec3 (&p)[4]) {
  if (kind == MovingElements::Kind::vertex_face) return {p[2] - p[1], p[3] - p[1], p[0] - p[1]};
  return {p[1] - p[0], p[2] - p[3], p[2] - p[0]};
}

/// The coefficients of det(u, v, w) in Bernstein form over a piece of time.
struct BernsteinVolume {
  double c[4];

  BernsteinVolume(const Vectors& begin, const Vectors& end) {
    const Vec3 at_begin = cross(begin.v, begin.w), at_end = cross(end.v, end.w);
    const Vec3 mixed = cross(begin.v, end.w) + cross(end.v, begin.w);
    c[0] = dot(begin.u, at_begin), c[1] = (dot(end.u, at_begin) + dot(begin.u, mixed)) / 3;
    c[2] = (dot(begin.u, at_end) + dot(end.u, mixed)) / 3, c[3] = dot(end.u, at_end);
  }

  /// If all have one sign, the least of their sizes; else 0 or less.
  double least_size() const {
    const double least = std::min({c[0], c[1], c[2], c[3]}), most = std::max({c[0], c[1], c[2], c[3]});
    return std::max(least, -most);
  }
  double largest_size() const { return std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2]), std::abs(c[3])}); }
};

/// Throws std::invalid_argument, naming `function`, unless something holds.
inline void require(bool holds, const char* function, const char* what) {
  LIMBER_REQUIRE(holds, (std::string(function) + ": " + what).c_str());
}
/// Unless the options are what their comments say.
void check(const ElementImpactOptions& options, const char* function);

/// time_of_impact() of two elements. Pre: the coordinates and options are in range.
ElementImpact impact_of(const MovingElements& elements, const ElementImpactOptions& options);

/// The answer of filter_impact().
struct FilterResult {
  enum class Verdict {
    clear,    ///< the elements do not touch up to the largest time
    contact,  ///< the first contact, not at the start, is in [lower, upper]; between these times the coplanarity
              ///< polynomial has one root, and opposite signs at both
    unknown,  ///< the filter cannot tell
  };
  Verdict verdict = Verdict::unknown;
  double lower = 0, upper = 0;  ///< mean something for `contact` only
};

/// Decides most pairs in float64 with bounds on all rounding: by axes along which the elements are apart, by signs of
/// the coplanarity polynomial, and by signs of the parameters of the point in which the elements would meet.
///
/// Pre: those of time_of_impact().
/// Source   docs/algorithms/impact.md.
FilterResult filter_impact(const MovingElements& elements, const ElementImpactOptions& options);

/// Continuous collision of two elements without any rounding: what time_of_impact() falls back on where its filter
/// cannot decide. docs/algorithms/impact.md proves it.

/// The first contact, as time_of_impact() promises it for min_separation 0.
///
/// Pre: the coordinates and options are in range.
ElementImpact exact_impact(const MovingElements& elements, const ElementImpactOptions& options);

/// Narrows [lower, upper] around the one time between them at which the elements are in one plane, to the width that
/// time_of_impact() promises.
///
/// Pre: lower < upper; the coplanarity polynomial has opposite signs at both, and one root between them.
void narrow_exactly(const MovingElements& elements, double time_error, double& lower, double& upper);

/// narrow_exactly() with a time_error of 0, by Newton's method in double-double arithmetic: the two neighboring
/// multiples of 2^-53 around the root of the coplanarity polynomial. Nothing if that is not enough to tell them.
///
/// Pre      There is one root from `lower` to `upper`, both in [0, 1].
std::optional<ElementImpact> narrow_precisely(const MovingElements& elements, double lower, double upper);

/// The first time at which two elements are within a distance of each other, as time_of_impact() promises it.
///
/// Pre: those of time_of_impact(), and options.min_separation > 0.
/// Source   docs/algorithms/impact.md, "With a separation".
ElementImpact separation_impact(const MovingElements& elements, const ElementImpactOptions& options);

/// Whether the same bounds show, with little effort, that two elements do not touch up to a time. Never true where they
/// do.
///
/// Pre: those of time_of_impact().
bool are_certainly_apart(const MovingElements& elements, double max_time);

}  // namespace limber::motion
