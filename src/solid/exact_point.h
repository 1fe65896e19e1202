// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "geometry/integers.h"
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
  int certain_sign() const;
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
  bool operator==(const ExactPoint& other) const;
  /// Which of two points is first along an axis: -1 for this one, 0 if they are equal there. Pre: both have one unit.
  int compare(const ExactPoint& other, std::size_t axis) const;

  /// On which side of the line from a to b the point is, seen along an axis: as orient2d().
  int side_of_line(const Vec3& a, const Vec3& b, std::size_t axis) const;
  /// On which side of the plane of a triangle the point is: as orient3d().
  int side_of_plane(const Triangle& t) const;
  Estimate height_estimate(const Triangle& t) const;
  /// How far the point is over a plane, as a multiple of some positive number that depends on the unit alone, and w.
  /// Pre: `unit` is at most that of the point and of the triangle.
  Integer height(const Triangle& t, int unit) const;

 private:
  friend std::optional<ExactPoint> crossing(const ExactPoint& from, const ExactPoint& to, const Triangle& plane);
  friend IntegerVec direction(const ExactPoint& from, const ExactPoint& to);

  ExactPoint(IntegerVec p, Integer w, int unit);
  /// The numerators in another unit. Pre: it is at most that of the point.
  IntegerVec numerators_in(int unit) const;
  int exact_side_of_line(const Vec3& a, const Vec3& b, std::size_t axis) const;

  IntegerVec p_;
  Integer w_;
  int unit_;
  Vec3 rounded_;
  bool is_rounded_exactly_ = true;
};

/// The point in which the line through two points crosses the plane of a triangle; none if it is parallel to it.
///
/// Pre      Both points have the same unit. The triangle is not degenerate.
std::optional<ExactPoint> crossing(const ExactPoint& from, const ExactPoint& to, const Triangle& plane);

/// A positive multiple of the difference of two points. Pre: both have the same unit.
IntegerVec direction(const ExactPoint& from, const ExactPoint& to);

/// To which side of the line from a to b a direction leads, seen along an axis: +1 to the left.
int side_of_direction(const Vec3& a, const Vec3& b, const IntegerVec& direction, std::size_t axis);
/// To which side of the plane of a triangle a direction leads: +1 to that of its normal.
int side_of_direction(const Triangle& t, const IntegerVec& direction);

}  // namespace limber::solid
