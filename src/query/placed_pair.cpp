// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "query/placed_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/check.h"
#include "core/rounding.h"
#include "math/rigid.h"

namespace limber::query {
namespace {

/// Infinity above what the kernels can square: they treat such a node as if it were everywhere. A finite number in its
/// place would make the node smaller than it is.
double or_infinite(double x) { return x < simd::furthest ? x : std::numeric_limits<double>::infinity(); }

/// The inverse of a matrix that is nearly a rotation; unlike the transpose, as exact as float64 allows.
Mat3 inverse_of(const Mat3& m) {
  const Vec3 c0 = cross(m.row1, m.row2), c1 = cross(m.row2, m.row0), c2 = cross(m.row0, m.row1);
  const double scale = 1 / dot(m.row0, c0);
  return transpose({c0 * scale, c1 * scale, c2 * scale});
}

Transform relative(const Transform& own, const Transform& other) {
  const Mat3 back = inverse_of(own.rotation);
  return {back * other.rotation, back * (other.translation - own.translation)};
}

double sum_of_sides(const Vec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// Of a ball around the model.
double root_radius(const tree::Tree& tree) {
  return tree.unit * static_cast<double>(tree.blocks[0].bounds.radius[0]) + tree.slack;
}

/// Distance of a point from a model, by the box or the slab of its root, given its place relative to the root's centre,
/// in its frame.
double root_gap(const tree::Tree& tree, const Vec3& point) {
  const simd::NodeBounds& n = tree.blocks[0].bounds;
  const Vec3 out = max(abs(point) - tree.unit * Vec3{n.half_x[0], n.half_y[0], n.half_z[0]}, Vec3{});
  const double height = dot(Vec3{n.normal_x[0], n.normal_y[0], n.normal_z[0]}, point);
  const double above = height - tree.unit * static_cast<double>(n.high[0]);
  const double below = tree.unit * static_cast<double>(n.low[0]) - height;
  return std::max({length(out), above, below}) - tree.slack;
}

/// An upper bound of the distance of any point of the placed model from the world's origin. A model that has drifted
/// may be many radii away from the origin of its root.
double reach_of_model(const Placed& placed) {
  const tree::Tree& tree = placed.model.tree();
  const double from_origin = tree.unit * static_cast<double>(tree.blocks[0].reach) + tree.slack;
  return sum_of_sides(placed.pose.translation) +
         (sum_of_sides(tree.blocks[0].origin) + std::max(2 * root_radius(tree), from_origin)) * 1.001;
}

}  // namespace

PlacedPair::PlacedPair(const Placed& a, const Placed& b)
    : is_placed_exactly_(a.pose == Transform{} && b.pose == Transform{}) {
  LIMBER_REQUIRE(a.model.is_committed(),
                 "limber: a query needs committed models; model a has moved vertices, or has been moved from");
  LIMBER_REQUIRE(b.model.is_committed(),
                 "limber: a query needs committed models; model b has moved vertices, or has been moved from");
  LIMBER_REQUIRE(math::is_rigid(a.pose),
                 "limber: a query needs rigid poses; the pose of model a is not (see is_rigid())");
  LIMBER_REQUIRE(math::is_rigid(b.pose),
                 "limber: a query needs rigid poses; the pose of model b is not (see is_rigid())");
  // Placing rounds each coordinate of a vertex or centre by some units of the magnitudes added (see
  // classic/queries.cpp); going to the other model's frame and along a heading adds as many again.
  error_ = 0x1p-45 * (reach_of_model(a) + reach_of_model(b));
  for (const auto& [placed, side] : {std::pair(&a, &sides_[0]), std::pair(&b, &sides_[1])}) {
    side->tree = &placed->model.tree();
    side->mesh = placed->model.mesh();
    side->pose = placed->pose;
    side->view.has_toward = false;
  }
}

void PlacedPair::prepare(Side s) {
  PlacedTree& side = sides_[index(s)];
  const PlacedTree& opposite = at(other(s));
  side.is_prepared = true;
  simd::View& view = side.view;
  const Transform from_other = relative(side.pose, opposite.pose);
  const Mat3 columns = transpose(from_other.rotation);
  const Vec3 all[4] = {columns.row0, columns.row1, columns.row2, from_other.translation};
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t k = 0; k < 4; ++k) view.from_other[c][k] = k < 3 ? all[c][k] : 0;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 4; ++k) {
      view.rotation[c][k] = static_cast<float>(view.from_other[c][k]);
      view.rotation_abs[c][k] = std::abs(view.rotation[c][k]);
    }
  }
  view.unit = side.tree->unit;
  view.per_unit = 1 / side.tree->unit;
  view.other_unit = opposite.tree->unit;
  view.ratio = static_cast<float>(or_infinite(view.other_unit * view.per_unit));
  view.error = error_ + slack();
  view.error_units = core::float_up(or_infinite(view.error * view.per_unit)) + 0x1p-100F;
}

Triangle PlacedPair::triangle(Side s, TriangleId t) const {
  const Triangle model = at(s).mesh.triangle(t);
  const Transform& pose = at(s).pose;
  return {pose(model.v0), pose(model.v1), pose(model.v2)};
}

double PlacedPair::root_bound() const {
  const PlacedTree &a = at(Side::a), &b = at(Side::b);
  const Vec3 between =
      b.pose(tree::model_center(*b.tree, tree::root)) - a.pose(tree::model_center(*a.tree, tree::root));
  const double radius_a = root_radius(*a.tree), radius_b = root_radius(*b.tree);
  double best = length(between) - radius_a - radius_b;
  // The ball of one next to the box and the slab of the other.
  best = std::max(best, root_gap(*a.tree, transpose(a.pose.rotation) * between) - radius_b);
  best = std::max(best, root_gap(*b.tree, transpose(b.pose.rotation) * -between) - radius_a);
  // Float32 normals, nearly orthonormal rotations, float64 rounding.
  const double slack = (sum_of_sides(between) + radius_a + radius_b) * 0x1p-20 + error_;
  return std::max(0.0, best - slack);
}

void PlacedPair::pay(double steps) const {
  for (const Side s : {Side::a, Side::b}) {
    const tree::Tree& t = tree(s);
    if (t.paid == nullptr || t.slack == 0) continue;
    const double share = steps * (t.slack / slack());
    t.paid->fetch_add(static_cast<std::uint64_t>(share / tree::part_of_step), std::memory_order_relaxed);
  }
}

Transform PlacedPair::a_from_b() {
  const auto& columns = view(Side::a).from_other;
  const auto column = [&](std::size_t c) { return Vec3{columns[c][0], columns[c][1], columns[c][2]}; };
  return {transpose(Mat3{column(0), column(1), column(2)}), column(3)};
}

double PlacedPair::most_moved(const Transform& before, double error_before, const Transform& after) const {
  const tree::Tree &a = tree(Side::a), &b = tree(Side::b);
  const Vec3 center = tree::model_center(b, tree::root), center_a = tree::model_center(a, tree::root);
  const Mat3 &from = before.rotation, &to = after.rotation;
  const Vec3 was = before(center), is = after(center);
  // A difference of two rotations stretches by its Frobenius norm over the root of 2.
  const double turned = std::sqrt(
      0.5 * (length_sq(to.row0 - from.row0) + length_sq(to.row1 - from.row1) + length_sq(to.row2 - from.row2)));
  // 1e-8 of all lengths covers rotations that are orthonormal to 1e-9 only, in either model's pose, and the rounding of
  // all of this.
  const double size =
      length(was - center_a) + length(is - center_a) + sum_of_sides(center) + root_radius(a) + root_radius(b);
  return core::distance_up(was, is) + turned * root_radius(b) + 1e-8 * size + 2 * (error_before + error_);
}

void PlacedPair::aim(const Vec3& from_a_to_b) {
  LIMBER_ASSERT(std::abs(length_sq(from_a_to_b) - 1) < 0x1p-40);
  const Vec3 out_of_a = transpose(at(Side::a).pose.rotation) * from_a_to_b;
  const Vec3 out_of_b = transpose(at(Side::b).pose.rotation) * -from_a_to_b;
  simd::View &a = sides_[0].view, &b = sides_[1].view;
  a.has_toward = b.has_toward = true;
  for (std::size_t k = 0; k < 3; ++k) {
    a.toward[k] = out_of_a[k], b.toward[k] = out_of_b[k];
    a.normal[k] = b.other_normal[k] = static_cast<float>(out_of_a[k]);
    b.normal[k] = a.other_normal[k] = static_cast<float>(out_of_b[k]);
  }
  offset_ = dot(from_a_to_b, at(Side::b).pose.translation - at(Side::a).pose.translation);
}

double PlacedPair::gap_along(TriangleId a, TriangleId b) const {
  LIMBER_ASSERT(is_aimed());
  const auto support = [](const PlacedTree& side, TriangleId id) {
    const Triangle t = side.mesh.triangle(id);
    const Vec3 out{side.view.toward[0], side.view.toward[1], side.view.toward[2]};
    return std::max({dot(out, t.v0), dot(out, t.v1), dot(out, t.v2)});
  };
  return offset_ - support(at(Side::a), a) - support(at(Side::b), b);
}

}  // namespace limber::query
