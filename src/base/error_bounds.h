// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The error budget: constants that make bounds safe against rounding. Each has a row in docs/algorithms/numerics.md,
/// section "Error budget": its derivation, and the test that fails when it is made smaller. Filters that one file
/// derives by itself have their constants there, some under a name that is also used here.
///
/// u32 = 2^-24 and u = 2^-53 are the relative rounding errors of one operation in float32 and in float64.
namespace limber::base {

// --- rounding of float32; a constant that float64 code uses is a double ---

/// Relative error of a squared length formed by at most ten operations; and factors that cover it, upward and downward.
inline constexpr float squared_error = 0x1p-20F;
inline constexpr float squares_up = 1 + squared_error, squares_down = 1 - squared_error;
/// Error of |v|^2 - (n . v)^2, the squared length of the part of v across a stored normal n, as a part of |v|^2.
inline constexpr float across_error = 0x1.4p-20F;
/// At least the square root of 2 * across_error: the error of a sine whose square is off by that.
inline constexpr float sine_error = 0.0016F;

/// Covers that the normal of a slab and the directions of its sides have length 1 and are perpendicular only up to
/// rounding, and the rounding of sums along all three, as a part of the radius or of a squared length.
inline constexpr float sides_error = 0x1p-16F;

/// What projecting a node or a direction changes a length by, as a part of the magnitudes involved: some 20 u32.
inline constexpr float projection_error = 0x1p-19F;
/// What comparing a node or a leaf with a point changes a length by, as a part of the magnitudes involved: <= 10 u32.
inline constexpr float point_error = 0x1p-20F;

/// What placing a corner relative to another, and the few operations that follow, change a length by, as a part of the
/// leaf's extent.
inline constexpr float corner_error = 0x1p-21F;
/// The least that placing a corner is taken to change a length by, in units: shorter lengths have no square in float32.
inline constexpr float smallest_corner_error = 0x1p-60F;
/// What quantization moves a corner by, in steps: a coordinate by at most 0.52, so a corner by sqrt(3) * 0.52.
inline constexpr double quantization_error = 0.91;
/// What quantization and a few operations change a coordinate of the difference of two corners by, in steps: 2 * 0.52
/// and 0.02 make 1.06; 0.02 are room.
inline constexpr float corner_difference_error = 1.08F;

/// What rounding changes the cross product of two vectors in a plane by, as a part of s s': these are differences of
/// corners, whose coordinates are at most s and s', so their own are at most 2 s and 2 s'. Two products of at most
/// 4 s s' with 3 u32 each, for themselves and two differences: 24 u32. Their subtraction: 8 u32.
inline constexpr float sector_rounding_error = 0x1p-19F;
/// What rounding changes ee * pq - ep * eq by, formed from the inner products of three vectors, as a part of
/// ee * (pp + qq): 12.5 u32.
inline constexpr float edge_plane_error = 0x1p-20F;

/// What all of float32 changes a gap between two triangles of a pair of leaves by, scaled so that all numbers are about
/// 1 or less.
inline constexpr float leaf_pair_error = 0x1p-17F;

/// What float32 changes a coefficient of the cross product of two edges by, seen along an axis, where coordinates
/// relative to the center of a moving leaf are e < 2. A corner is off by 4 u32 e, one of the second leaf by 2 u32 more,
/// where the offset is added; an edge by 10 u32 e + 4 u32, and its coordinates are at most 2 e. That changes two
/// products by 2 * 2 * 2 e (10 u32 e + 4 u32) <= 384 u32. They, their difference and a mean of two round by 96 u32.
inline constexpr float moving_turn_error = 0x1p-15F;

/// Relative rounding of a number to float32: u32, with room.
inline constexpr double storage_error = 0x1p-22;
/// Added to errors in units, so that none is 0.
inline constexpr float smallest_error_units = 0x1p-100F;
/// Beyond this many units a node is treated as if it were everywhere: float32 could not square its numbers.
inline constexpr double max_units = 0x1p60;

// --- rounding of float64 ---

/// What subtracting two nearby points and scaling the difference changes a length by, as a part of the difference.
inline constexpr double offset_error = 0x1p-50;
/// What the difference of two coordinates is off by, as a part of the distance from the origin.
inline constexpr double relative_position_error = 0x1p-51;

/// Covers the rounding of lengths, of sums of a few of them, and of everything computed while bounds are fitted.
inline constexpr double outward = 1 + 0x1p-40;
/// Covers in lower bounds what `outward` covers in upper ones.
inline constexpr double inward = 1 - 0x1p-40;
/// Covers the rounding of one addition in a sum of many; and of what is added, if that is the root of a squared length.
inline constexpr double sum_up = 1 + 0x1p-50;

/// Placing a vertex in the world, and going from there to the other model's frame, changes a length by at most this
/// part of the magnitude of the query.
inline constexpr double placement_error = 0x1p-45;
/// Covers that the root's sphere is about another point than the origin of its node, and rounding.
inline constexpr double magnitude_up = 1.001;
/// Float32 normals of the roots, rotations that are only nearly orthonormal, and rounding, as a part of the lengths
/// involved.
inline constexpr double root_error = 0x1p-20;
/// Rotations that are orthonormal to 1e-9 only, in the poses of both models before and after a motion, and rounding, as
/// a part of the lengths involved.
inline constexpr double rigidity_error = 4e-8;
/// Rounding of the height of a vertex over a plane through another vertex, as a part of the largest coordinate of their
/// difference.
inline constexpr double fan_error = 0x1p-48;

// --- scenes: bounds of placed models ---

/// What rounding makes of the bounds of a placed model, of its placed vertices and of distances, as a part of the sum
/// of its translation, its coordinates and twice its radius.
inline constexpr double scene_bounds_error = 0x1p-44;
/// What rounding makes of distances between models, as a part of them.
inline constexpr double scene_distance_error = 0x1p-43;

// --- ties: pairs of triangles that are as far apart as the closest pair, up to rounding ---

/// The error of a gap along the search direction that is computed before triangles are placed, as a part of
/// placement_error times the magnitude.
inline constexpr double local_gap_error = 0x1p-4;
/// What rounding can make of a gap between placed triangles, and of the distance it is compared with, as a part of
/// their extent: 2 * 7 u for heights, 9 u for a direction of length 1 up to 5 u, 8 u for closest_points().
inline constexpr double gap_error = 0x1p-47;
/// What rounding usually makes of the gap of a pair with the same closest features as the best one, as a part of the
/// extent. No bound: pairs whose gap is off by more are compared, which costs time only.
inline constexpr double usual_gap_error = 0x1p-51;
/// The usual rounding of a gap that is computed before triangles are placed, as a part of local_gap_error. No bound.
inline constexpr double usual_local_gap_part = 0x1p-3;
/// Rounding of this part of the distance may decide which of many pairs that are equally close is the answer.
inline constexpr double tie_error = 0x1p-45;

// --- moving boxes and elements ---

/// What one operation rounds a gap or a time of moving boxes by, as a part of its size: u, with room.
inline constexpr double rounding_error = 0x1p-52;
/// Quotients below may have underflowed.
inline constexpr double tiny_time = 0x1p-1000;

/// The rounding error of det(u, v, w) and of its Bernstein coefficients, for the vectors of two moving elements
/// (motion/element_impact.h), as a part of the product of the largest coordinates of u, v and w at both ends of time.
/// A sum of 6 products of three coordinates, each off by 24 + 2 u; sums add 5 u, coefficients 3 u: 6 * 34 u < 2^-45.
inline constexpr double moving_volume_error = 0x1p-45;
/// The rounding error of a coordinate of a cross product of two of these vectors, as a part of the product of their
/// largest coordinates. 2 products, each off by 17 u; sums add 6 u, sums of three such coordinates 4 u: 44 u < 2^-47.
inline constexpr double moving_area_error = 0x1p-47;
/// Elements at a distance below this part of their extent are as good as touching: rounding of their corners at a time,
/// and of their closest points, changes distances by less.
inline constexpr double placed_elements_error = 0x1p-44;

}  // namespace limber::base
