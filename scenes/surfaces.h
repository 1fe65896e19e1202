// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "limber/geometry.h"
#include "limber/mesh.h"

/// What scenes are put together from. All these surfaces are closed and face outward.
namespace limber::scenes {

/// The surfaces of boxes along the axes, 12 triangles each.
Mesh boxes(const std::vector<Box>& all);

/// All parts as one mesh, each vertex moved by `pose`, which may also stretch: any map that keeps the orientation.
Mesh together(const std::vector<Mesh>& parts, const Transform& pose = {});

/// A polygon, counter-clockwise as seen from where the next ring is. One point alone is the tip of a cone.
using Ring = std::vector<Vec3>;
enum class Ends { capped, joined };

/// The surface from ring to ring. Fans around first points cap the ends, or the last ring is joined with the first.
///
/// Pre      Two rings at least, all of as many points; the first and the last may be tips if the ends are capped.
Mesh loft(const std::vector<Ring>& rings, Ends ends);

/// A circle around the z axis, with its first point at `angle`; a tip for a radius of 0.
Ring circle(std::uint32_t sides, double radius, double z, double angle = 0);

/// Circles around points of curve(t), at equal steps of t from 0 to 1. With joined ends there is none at 1.
///
/// Pre      No tangent is parallel to the z axis. The curve goes on a little before 0 and after 1.
std::vector<Ring> circles_along(const std::function<Vec3(double t)>& curve, std::uint32_t segments, std::uint32_t sides,
                                double radius, Ends ends = Ends::capped);

struct ProfilePoint {
  double radius, z;
};

/// What a profile sweeps around the z axis, each of its segments in as many `pieces`. The solid is at the left of the
/// profile, radius to the right and z upward.
Mesh lathe(const std::vector<ProfilePoint>& profile, std::uint32_t sides, std::uint32_t pieces = 1);

}  // namespace limber::scenes
