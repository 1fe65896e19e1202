// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/geometry.h"

/// Predicates of geometry.h in integer arithmetic without rounding, by another method than the library's.
namespace limber::fuzz {

/// Whether two closed triangles, degenerate or not, share a point.
bool exactly_intersect(const Triangle& a, const Triangle& b);

/// As limber::orient3d() and limber::orient2d().
int exact_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
int exact_orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis);

}  // namespace limber::fuzz
