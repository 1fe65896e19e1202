// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace limber::motion
