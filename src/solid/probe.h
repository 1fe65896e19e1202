// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "base/check.h"
#include "geometry/integers.h"
#include "geometry/primitives.h"
#include "limber/geometry.h"

/// Points where edges and planes of placed triangles cross, and exact decisions about them.
namespace limber::solid {

using geometry::CommonUnit;
using geometry::Integer;
using IntegerVec = std::array<Integer, 3>;

/// A number, up to an error.
struct Estimate {
  double value, error;

  /// The sign of the number; 0 if the error leaves it open.
  int certain_sign() const { return std::abs(value) > error && std::isfinite(error) ? (value > 0 ? 1 : -1) : 0; }
  friend Estimate operator*(const Estimate& x, const Estimate& y);
};

/// How far a point, of which each coordinate may be off by a part `error_of_p`, is over the plane of a triangle: the
/// determinant of orient3d().
Estimate height_over(const Triangle& plane, const Vec3& p, double error_of_p = 0);

/// The point p / w * 2^unit, where w > 0. Beside it stands a rounded one, so that most signs need no big integers.
class ExactPoint {
 public:
  /// Pre: the unit is at most that of `v`.
  ExactPoint(const Vec3& v, int unit);

  const Vec3& rounded() const { return rounded_; }
  /// A bound of what rounding has changed a coordinate by; 0 if it has changed nothing.
  double rounding() const;
  bool operator==(const ExactPoint& other) const {
    const int unit = std::min(unit_, other.unit_);
    const IntegerVec p = numerators_in(unit), q = other.numerators_in(unit);
    return p[0] * other.w_ == q[0] * w_ && p[1] * other.w_ == q[1] * w_ && p[2] * other.w_ == q[2] * w_;
  }
  /// Which of two points is first along an axis: -1 for this one, 0 if they are equal there. Pre: both have one unit.
  int compare(const ExactPoint& other, std::size_t axis) const {
    LIMBER_ASSERT(axis < 3 && unit_ == other.unit_);
    const double off = rounding() + other.rounding();
    const int sign = Estimate{rounded_[axis] - other.rounded_[axis], 2 * off}.certain_sign();
    if (sign != 0 || off == 0) return sign;
    return (p_[axis] * other.w_ - other.p_[axis] * w_).sign();
  }

  /// On which side of the line from a to b the point is, seen along an axis: as orient2d().
  int side_of_line(const Vec3& a, const Vec3& b, std::size_t axis) const;
  /// On which side of the plane of a triangle the point is: as orient3d().
  int side_of_plane(const Triangle& t) const;
  Estimate height_estimate(const Triangle& t) const;
  /// How far the point is over a plane, as a multiple of some positive number that depends on the unit alone, and w.
  /// Pre: `unit` is at most that of the point and of the triangle.
  Integer height(const Triangle& t, int unit) const;

  /// The point in which the line through two points crosses the plane of a triangle; none if it is parallel to it. Pre:
  /// both points have the same unit, and the triangle is not degenerate.
  friend std::optional<ExactPoint> crossing(const ExactPoint& from, const ExactPoint& to, const Triangle& plane);
  /// A positive multiple of the difference of two points. Pre: both have the same unit.
  friend IntegerVec direction(const ExactPoint& from, const ExactPoint& to);

 private:
  ExactPoint(IntegerVec p, Integer w, int unit);
  /// The numerators in another unit. Pre: it is at most that of the point.
  IntegerVec numerators_in(int unit) const {
    LIMBER_ASSERT(unit <= unit_);
    const auto shift = static_cast<unsigned>(unit_ - unit);
    return {p_[0] << shift, p_[1] << shift, p_[2] << shift};
  }

  IntegerVec p_;
  Integer w_;
  int unit_;
  Vec3 rounded_;
  bool is_rounded_exactly_ = true;
};

/// To which side of the line from a to b a direction leads, seen along an axis: +1 to the left.
int side_of_direction(const Vec3& a, const Vec3& b, const IntegerVec& direction, std::size_t axis);
/// To which side of the plane of a triangle a direction leads: +1 to that of its normal.
int side_of_direction(const Triangle& t, const IntegerVec& direction);

/// Probes: points that are off both surfaces, though by infinitesimal amounts alone.
///
/// Each lies beside a triangle, on one of its sides. It is given by a base point in the triangle's plane and two
/// directions in that plane: the base is moved by an infinitesimal e along the first, by e^2 along the second, and by
/// e^3 off the plane, along an axis of the world that is not parallel to it. A ray from there along the same axis never
/// meets an edge. Exact signs tell what it crosses: that of the base or, where that is 0, that of the first direction,
/// and so on. This is symbolic perturbation [EdelsbrunnerMuecke1990], with a meaning: it leads into a cell.

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
  int side_of_line(const Vec3& a, const Vec3& b) const {
    return first_side([&](const Vec3& corner) { return geometry::orient2d(a, b, corner, off_.axis); });
  }
  /// On which side of the plane of a triangle it is; 0 only if it is the plane of its own triangle.
  int side_of_plane(const Triangle& t) const {
    return first_side([&](const Vec3& corner) { return geometry::orient3d(t.v0, t.v1, t.v2, corner); });
  }

 private:
  template <typename SideOf>
  int first_side(const SideOf& side_of) const {
    for (const Vec3& corner : corners_) {
      if (const int side = side_of(corner); side != 0) return side;
    }
    return 0;
  }

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
  int side_of_line(const Vec3& a, const Vec3& b) const {
    if (const int side = base_.side_of_line(a, b, off_.axis); side != 0) return side;
    const int side_along = side_of_direction(a, b, along_, off_.axis);
    return side_along != 0 ? side_along : geometry::orient2d(a, b, corner_, off_.axis);
  }
  int side_of_plane(const Triangle& t) const {
    if (const int side = base_.side_of_plane(t); side != 0) return side;
    const int side_along = side_of_direction(t, along_);
    return side_along != 0 ? side_along : geometry::orient3d(t.v0, t.v1, t.v2, corner_);
  }

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
