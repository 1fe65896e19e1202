// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/placed_pair.h"

#include <algorithm>
#include <cmath>

#include "base/access.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/rounding.h"
#include "bvh/root_bounds.h"
#include "geometry/local_frame.h"
#include "model/model_impl.h"

namespace limber::pair {
namespace {

// Vertices that are outside of the bounds by at most this part of the magnitude cannot make it much too large.
constexpr double small_slack = 1. / 16;

}  // namespace

PlacedPair::PlacedPair(const Placed& a, const Placed& b)
    : sides_{{&require_ready(a, "limber", "model a of a query").tree, Access::impl(a.model()).mesh, a.pose},
             {&require_ready(b, "limber", "model b of a query").tree, Access::impl(b.model()).mesh, b.pose}},
      is_placed_exactly_(a.pose == Transform{} && b.pose == Transform{}) {
  const double size = bvh::magnitude(tree(Side::a), a.pose) + bvh::magnitude(tree(Side::b), b.pose);
  error_ = base::placement_error * size;
  is_error_tight_ = !is_placed_exactly_ && slack() <= small_slack * size;
}

Triangle PlacedPair::placed(Side s, const Triangle& local) const {
  if (is_placed_exactly_) return local;
  const Transform& pose = at(s).pose;
  return {pose(local.v0), pose(local.v1), pose(local.v2)};
}

double PlacedPair::root_bound(double enough) const {
  const PlacedTree &a = at(Side::a), &b = at(Side::b);
  const Vec3 between =
      b.pose(bvh::slot_center(*b.tree, bvh::root_slot)) - a.pose(bvh::slot_center(*a.tree, bvh::root_slot));
  const double radius_a = bvh::root_radius(*a.tree), radius_b = bvh::root_radius(*b.tree);
  const double rounding = (bvh::sum_of_coordinates(between) + radius_a + radius_b) * base::root_error + error_;
  double best = geometry::safe_length(between) - radius_a - radius_b;
  if (best - rounding >= enough) return best - rounding;
  // The sphere of one next to the box and the slab of the other.
  best = std::max(best, bvh::root_gap(*a.tree, transpose(a.pose.rotation) * between) - radius_b);
  best = std::max(best, bvh::root_gap(*b.tree, transpose(b.pose.rotation) * -between) - radius_a);
  return std::max(0.0, best - rounding);
}

double PlacedPair::max_displacement(const Transform& before, double error_before, const Transform& after) const {
  const bvh::Tree &a = tree(Side::a), &b = tree(Side::b);
  const Vec3 center = bvh::slot_center(b, bvh::root_slot), center_a = bvh::slot_center(a, bvh::root_slot);
  const Mat3 &from = before.rotation, &to = after.rotation;
  const Vec3 center_before = before(center), center_after = after(center);
  // The difference of two rotations stretches a vector by at most its Frobenius norm over the root of 2.
  const double turned = std::sqrt(
      0.5 * (length_sq(to.row0 - from.row0) + length_sq(to.row1 - from.row1) + length_sq(to.row2 - from.row2)));
  const double size = geometry::safe_length(center_before - center_a) + geometry::safe_length(center_after - center_a) +
                      bvh::sum_of_coordinates(center) + bvh::root_radius(a) + bvh::root_radius(b);
  return base::distance_up(center_before, center_after) + turned * bvh::root_radius(b) + base::rigidity_error * size +
         2 * (error_before + error_);
}

}  // namespace limber::pair
