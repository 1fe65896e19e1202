// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Floating-point filters [Shewchuk1997]: the factors 4 and 8 of the error bounds below are rounded up from
//           those of its first stages, 3 + 16 e and 7 + 56 e.
// Differs   The point is rounded, which adds a term for each of its coordinates. What the filter cannot decide is
//           decided by integers: all coordinates are multiples of one power of two.
#include "solid/probe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/error_free.h"
#include "geometry/primitives.h"

namespace limber::solid {
namespace {

constexpr double epsilon = 0x1p-53;
constexpr double point_error = 0x1p-50;  // as a part of a coordinate; rounding it twice makes less than 2^-52
// What rounding near zero can add: 2^-1074 of a coordinate times a component of a normal, which is below 2^405.
constexpr double underflow_bound = 0x1p-660;

/// As a multiple of 2^unit. Pre: it is one.
IntegerVec whole(const Vec3& v, int unit) {
  const auto in_units = [unit](double x) { return base::Decoded(x).in<Integer>(unit); };
  return {in_units(v.x), in_units(v.y), in_units(v.z)};
}

IntegerVec minus(const IntegerVec& a, const IntegerVec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Integer dot_of(const IntegerVec& a, const IntegerVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

IntegerVec normal_of(const Triangle& t, int unit) {
  const IntegerVec a = whole(t.v0, unit), p = minus(whole(t.v1, unit), a), q = minus(whole(t.v2, unit), a);
  return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
}

int compare_doubles(double x, double y) { return (x > y ? 1 : 0) - (x < y ? 1 : 0); }

/// n / d * 2^unit, up to a part of 2^-52 of it, or the smallest double. Pre: d > 0.
double quotient(const Integer& n, const Integer& d, int unit) {
  if (n.is_zero()) return 0;
  const Integer size = abs(n);
  const int shift = 64 + static_cast<int>(msb(d)) - static_cast<int>(msb(size));
  const Integer q = shift >= 0 ? Integer((size << static_cast<unsigned>(shift)) / d)
                               : Integer(size / (d << static_cast<unsigned>(-shift)));
  const double rounded = std::ldexp(q.convert_to<double>(), unit - shift);
  return n.sign() > 0 ? rounded : -rounded;
}

}  // namespace

Estimate operator*(const Estimate& x, const Estimate& y) {
  const double value = x.value * y.value;
  const double error = std::abs(x.value) * y.error + x.error * std::abs(y.value) + x.error * y.error;
  return {value, 2 * error + 2 * epsilon * std::abs(value) + underflow_bound};
}

Estimate height_over(const Triangle& plane, const Vec3& p, double error_of_p) {
  const Vec3 a = plane.v1 - plane.v0, b = plane.v2 - plane.v0, r = p - plane.v0;
  const Vec3 size{std::abs(a.y * b.z) + std::abs(a.z * b.y), std::abs(a.z * b.x) + std::abs(a.x * b.z),
                  std::abs(a.x * b.y) + std::abs(a.y * b.x)};
  return {dot(cross(a, b), r), 8 * epsilon * dot(size, abs(r)) + error_of_p * dot(size, abs(p)) + underflow_bound};
}

ExactPoint::ExactPoint(const Vec3& v, int unit) : p_(whole(v, unit)), w_(1), unit_(unit), rounded_(v) {}

ExactPoint::ExactPoint(IntegerVec p, Integer w, int unit) : p_(std::move(p)), w_(std::move(w)), unit_(unit) {
  LIMBER_ASSERT(!w_.is_zero());
  if (w_.sign() < 0) {
    for (Integer& x : p_) x = -x;
    w_ = -w_;
  }
  for (std::size_t k = 0; k < 3; ++k) rounded_[k] = quotient(p_[k], w_, unit_);
  is_rounded_exactly_ =
      is_finite(rounded_) && *this == ExactPoint(rounded_, std::min(unit_, CommonUnit().include(rounded_).exponent()));
}

double ExactPoint::rounding() const {
  return is_rounded_exactly_ ? 0 : point_error * max_abs(rounded_) + std::numeric_limits<double>::min();
}

int ExactPoint::side_of_line(const Vec3& a, const Vec3& b, std::size_t axis) const {
  LIMBER_ASSERT(axis < 3);
  if (is_rounded_exactly_) return geometry::orient2d(a, b, rounded_, axis);
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double along_i = b[i] - a[i], along_j = b[j] - a[j];
  const double left = along_i * (rounded_[j] - a[j]), right = along_j * (rounded_[i] - a[i]);
  const double of_point = std::abs(along_i * rounded_[j]) + std::abs(along_j * rounded_[i]);
  const double bound = 4 * epsilon * (std::abs(left) + std::abs(right)) + point_error * of_point + underflow_bound;
  const int sign = Estimate{left - right, bound}.certain_sign();
  if (sign != 0) return sign;
  const int unit = std::min(unit_, CommonUnit().include(a).include(b).exponent());
  const IntegerVec p = numerators_in(unit), from = whole(a, unit), to = whole(b, unit);
  const Integer det = (to[i] - from[i]) * (p[j] - w_ * from[j]) - (to[j] - from[j]) * (p[i] - w_ * from[i]);
  return det.sign();
}

int ExactPoint::side_of_plane(const Triangle& t) const {
  if (is_rounded_exactly_) return geometry::orient3d(t.v0, t.v1, t.v2, rounded_);
  const int sign = height_estimate(t).certain_sign();
  if (sign != 0) return sign;
  return height(t, std::min(unit_, CommonUnit().include(t).exponent())).sign();
}

Estimate ExactPoint::height_estimate(const Triangle& t) const {
  return height_over(t, rounded_, is_rounded_exactly_ ? 0 : point_error);
}

Integer ExactPoint::height(const Triangle& t, int unit) const {
  const IntegerVec a = whole(t.v0, unit), p = numerators_in(unit);
  return dot_of(normal_of(t, unit), {p[0] - w_ * a[0], p[1] - w_ * a[1], p[2] - w_ * a[2]});
}

std::optional<ExactPoint> crossing(const ExactPoint& from, const ExactPoint& to, const Triangle& plane) {
  LIMBER_ASSERT(from.unit_ == to.unit_);
  const int unit = std::min(from.unit_, CommonUnit().include(plane).exponent());
  const Integer from_height = from.height(plane, unit), to_height = to.height(plane, unit);
  Integer w = from_height * to.w_ - to_height * from.w_;
  if (w.is_zero()) return std::nullopt;
  IntegerVec p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = from_height * to.p_[k] - to_height * from.p_[k];
  return ExactPoint(std::move(p), std::move(w), from.unit_);
}

IntegerVec direction(const ExactPoint& from, const ExactPoint& to) {
  LIMBER_ASSERT(from.unit_ == to.unit_);
  IntegerVec d;
  for (std::size_t k = 0; k < 3; ++k) d[k] = to.p_[k] * from.w_ - from.p_[k] * to.w_;
  return d;
}

int side_of_direction(const Vec3& a, const Vec3& b, const IntegerVec& direction, std::size_t axis) {
  LIMBER_ASSERT(axis < 3);
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const int left = compare_doubles(b[i], a[i]) * direction[j].sign();
  const int right = compare_doubles(b[j], a[j]) * direction[i].sign();
  if (left != right || left == 0) return compare_doubles(left, right);
  const int unit = CommonUnit().include(a).include(b).exponent();
  const IntegerVec along = minus(whole(b, unit), whole(a, unit));
  const Integer det = along[i] * direction[j] - along[j] * direction[i];
  return det.sign();
}

int side_of_direction(const Triangle& t, const IntegerVec& direction) {
  int least = 0, most = 0;  // signs of the terms of the inner product
  for (std::size_t k = 0; k < 3; ++k) {
    const int sign = direction[k].is_zero() ? 0 : geometry::orient2d(t.v0, t.v1, t.v2, k) * direction[k].sign();
    least = std::min(least, sign), most = std::max(most, sign);
  }
  if (least == 0 || most == 0) return least + most;
  return dot_of(normal_of(t, CommonUnit().include(t).exponent()), direction).sign();
}

std::optional<AxisDirection> direction_off(const Triangle& triangle, int side) {
  LIMBER_ASSERT(side == 1 || side == -1);
  const Vec3 normal = abs(cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0));
  std::size_t axis = normal.x >= normal.y ? (normal.x >= normal.z ? 0 : 2) : (normal.y >= normal.z ? 1 : 2);
  int turn = geometry::orient2d(triangle.v0, triangle.v1, triangle.v2, axis);
  if (turn == 0) {  // rounding has hidden the shape
    const std::optional<std::size_t> faithful = geometry::faithful_axis(triangle.v0, triangle.v1, triangle.v2);
    if (!faithful) return std::nullopt;
    axis = *faithful;
    turn = geometry::orient2d(triangle.v0, triangle.v1, triangle.v2, axis);
  }
  return AxisDirection{axis, turn == side};
}

}  // namespace limber::solid
