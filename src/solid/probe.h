// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "limber/geometry.h"
#include "solid/exact_point.h"

/// Probes: points that are off both surfaces, though by infinitesimal amounts alone.
///
/// Each lies beside a triangle, on one of its sides. It is given by a base point in the triangle's plane and two
/// directions in that plane: the base is moved by an infinitesimal amount along the first, by a much smaller one along
/// the second, and by a smaller one still off the plane, along an axis of the world that is not parallel to the plane.
/// A ray from there along the same axis never meets an edge, and signs of exact determinants tell what it crosses.
///
/// Based on  Symbolic perturbation [EdelsbrunnerMuecke1990].
/// Differs   The perturbation has a meaning: it leads into a cell next to the base point.
namespace limber::solid {

/// The direction of an axis of the world, or against it.
struct AxisDirection {
  std::size_t axis;
  bool is_upward;
};

/// The axis along which a triangle has the largest shadow, in the direction that leads off its front (+1), where the
/// normal points, or off its back (-1). None if the triangle is degenerate.
std::optional<AxisDirection> direction_off(const Triangle& triangle, int side);

/// A probe beside a corner of a triangle, where the triangle's edge to the next corner begins.
class CornerProbe {
 public:
  /// Corners `first` and the two after it span the triangle.
  CornerProbe(const Triangle& t, std::size_t first, const AxisDirection& off)
      : corners_{t[first], t[(first + 1) % 3], t[(first + 2) % 3]}, off_(off) {}

  const AxisDirection& off() const { return off_; }
  /// Where the probe is, up to rounding() in each coordinate.
  const Vec3& position() const { return corners_[0]; }
  double rounding() const { return 0; }
  /// On which side of the line from a to b it is, seen along the axis; 0 only where a and b are one point, seen so.
  int side_of_line(const Vec3& a, const Vec3& b) const;
  /// On which side of the plane of a triangle it is; 0 only if it is the plane of its own triangle.
  int side_of_plane(const Triangle& t) const;

 private:
  std::array<Vec3, 3> corners_;
  AxisDirection off_;
};

/// A probe beside a cut: the segment in which another triangle crosses the probe's own.
class CutProbe {
 public:
  /// Moved from `base` along `along`, the direction of the cut, and then to that side of it on which `corner` is.
  CutProbe(const ExactPoint& base, const IntegerVec& along, const Vec3& corner, const AxisDirection& off)
      : base_(base), along_(along), corner_(corner), off_(off) {}

  const AxisDirection& off() const { return off_; }
  const Vec3& position() const { return base_.rounded(); }
  double rounding() const { return base_.rounding(); }
  int side_of_line(const Vec3& a, const Vec3& b) const;
  int side_of_plane(const Triangle& t) const;

 private:
  const ExactPoint& base_;
  const IntegerVec& along_;
  Vec3 corner_;
  AxisDirection off_;
};

/// Whether the ray of a probe, or its line, may meet a triangle, by the shadow of the triangle's box.
template <typename Probe>
bool is_in_shadow(const Probe& probe, const Triangle& t) {
  const Vec3& p = probe.position();
  const double off = probe.rounding();
  const auto is_beside = [&](std::size_t k) {
    return std::max({t.v0[k], t.v1[k], t.v2[k]}) < p[k] - off || std::min({t.v0[k], t.v1[k], t.v2[k]}) > p[k] + off;
  };
  const std::size_t axis = probe.off().axis;
  return !is_beside((axis + 1) % 3) && !is_beside((axis + 2) % 3);
}

/// What a triangle adds to the winding number of its surface around a probe, counted along the probe's ray.
template <typename Probe>
int winding_along(const Probe& probe, const Triangle& t) {
  if (!is_in_shadow(probe, t)) return 0;
  const int turn = probe.side_of_line(t.v0, t.v1);
  if (turn == 0 || probe.side_of_line(t.v1, t.v2) != turn || probe.side_of_line(t.v2, t.v0) != turn) return 0;
  const int side = probe.side_of_plane(t);
  if (side == 0) return 0;  // the ray leads off the plane that both are in
  // The normal points up where the corners turn left.
  const bool is_upward = probe.off().is_upward;
  if ((side == turn) == is_upward) return 0;
  return is_upward ? turn : -turn;
}

}  // namespace limber::solid
