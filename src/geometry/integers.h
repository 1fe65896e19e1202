// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include <boost/multiprecision/cpp_int.hpp>

#include "base/error_free.h"
#include "limber/geometry.h"

/// Coordinates as integers, for what is decided exactly.
namespace limber::geometry {

/// Up to 512 bits are stored in place; more are allocated.
using Integer = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<512, 0, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked>,
    boost::multiprecision::et_off>;

/// A power of two that all coordinates are multiples of, as its exponent: the largest that is not above 2^most.
class CommonUnit {
 public:
  explicit CommonUnit(int most = 0) : exponent_(most) {}
  CommonUnit& include(const Vec3& v) {
    for (const double x : {v.x, v.y, v.z}) exponent_ = std::min(exponent_, base::Decoded(x).exponent);
    return *this;
  }
  CommonUnit& include(const Triangle& t) { return include(t.v0).include(t.v1).include(t.v2); }
  int exponent() const { return exponent_; }

 private:
  int exponent_;
};

}  // namespace limber::geometry
