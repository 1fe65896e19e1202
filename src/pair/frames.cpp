// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/frames.h"

#include <cmath>

#include "base/error_bounds.h"
#include "base/rounding.h"
#include "geometry/rigid.h"

namespace limber::pair {
namespace {

Transform relative(const Transform& own, const Transform& other) {
  const Mat3 back = geometry::inverse_of(own.rotation);
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
  t.ratio = static_cast<float>(base::or_infinite(t.other_unit * t.per_unit));
  t.error = placed_.error() + placed_.slack();
  t.error_units = base::float_up(base::or_infinite(t.error * t.per_unit)) + base::smallest_error_units;
}

Transform Frames::a_from_b() {
  const auto& columns = of(Side::a).from_other;
  const auto column = [&](std::size_t c) { return Vec3{columns[c][0], columns[c][1], columns[c][2]}; };
  return {transpose(Mat3{column(0), column(1), column(2)}), column(3)};
}

}  // namespace limber::pair
