// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/math.h"

/// Signs of determinants without any rounding: what the predicates fall back on when their filter cannot decide.
namespace limber::geometry {

/// Sign of the determinant with rows b - a, c - a, d - a.
int exact_volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of (bx - ax) (cy - ay) - (by - ay) (cx - ax).
int exact_area_sign(double ax, double ay, double bx, double by, double cx, double cy);

}  // namespace limber::geometry
