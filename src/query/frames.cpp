// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "query/frames.h"

#include <cmath>
#include <limits>

#include "core/error_bounds.h"
#include "core/rounding.h"

namespace limber::query {

double or_infinite(double units) { return units < core::max_units ? units : std::numeric_limits<double>::infinity(); }

Mat3 inverse_of(const Mat3& m) {
  const Vec3 c0 = cross(m.row1, m.row2), c1 = cross(m.row2, m.row0), c2 = cross(m.row0, m.row1);
  const double scale = 1 / dot(m.row0, c0);
  return transpose({c0 * scale, c1 * scale, c2 * scale});
}

namespace {

Transform relative(const Transform& own, const Transform& other) {
  const Mat3 back = inverse_of(own.rotation);
  return {back * other.rotation, back * (other.translation - own.translation)};
}

}  // namespace

void Frames::compute(Side s) {
  is_known_[index(s)] = true;
  simd::FrameTransform& t = transforms_[index(s)];
  const Transform from_other = relative(placed_.pose(s), placed_.pose(other(s)));
  const Mat3 columns = transpose(from_other.rotation);
  const Vec3 all[4] = {columns.row0, columns.row1, columns.row2, from_other.translation};
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t k = 0; k < 4; ++k) t.from_other[c][k] = k < 3 ? all[c][k] : 0;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 4; ++k) {
      t.rotation[c][k] = static_cast<float>(t.from_other[c][k]);
      t.rotation_abs[c][k] = std::abs(t.rotation[c][k]);
    }
  }
  t.unit = placed_.tree(s).unit;
  t.per_unit = 1 / t.unit;
  t.other_unit = placed_.tree(other(s)).unit;
  t.ratio = static_cast<float>(or_infinite(t.other_unit * t.per_unit));
  t.error = placed_.error() + placed_.drift();
  t.error_units = core::float_up(or_infinite(t.error * t.per_unit)) + core::smallest_error_units;
}

Transform Frames::a_from_b() {
  const auto& columns = of(Side::a).from_other;
  const auto column = [&](std::size_t c) { return Vec3{columns[c][0], columns[c][1], columns[c][2]}; };
  return {transpose(Mat3{column(0), column(1), column(2)}), column(3)};
}

}  // namespace limber::query
