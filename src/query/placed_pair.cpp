// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "query/placed_pair.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/rounding.h"

namespace limber::query {
namespace {

using tree::Block;
using tree::NodeId;

// Beyond this many units a node is treated as if it were everywhere: float32 could not square the numbers.
constexpr double furthest = 0x1p60;

/// Everything float32 does with numbers of a magnitude changes a length by less than this part of it: some 20 roundings
/// of 2^-24 each, in every direction.
constexpr float doubt = 0x1p-19F;

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

void store(const Vec3& v, float* f) {
  f[0] = static_cast<float>(v.x), f[1] = static_cast<float>(v.y), f[2] = static_cast<float>(v.z);
}
void store(const Mat3& m, float* f) { store(m.row0, f), store(m.row1, f + 3), store(m.row2, f + 6); }

float dot3(const float* a, float x, float y, float z) { return a[0] * x + a[1] * y + a[2] * z; }
float abs_dot3(const float* a, float x, float y, float z) {
  return std::abs(a[0]) * x + std::abs(a[1]) * y + std::abs(a[2]) * z;
}

double sum_of_sides(const Vec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

double root_radius(const tree::Tree& tree) { return tree.unit * static_cast<double>(tree.blocks[0].bounds.radius[0]); }

/// Distance of a point from the box or the slab of a root, given its place relative to the root's centre, in its frame.
double root_gap(const tree::Tree& tree, const Vec3& point) {
  const simd::NodeBounds& n = tree.blocks[0].bounds;
  const Vec3 out = max(abs(point) - tree.unit * Vec3{n.half_x[0], n.half_y[0], n.half_z[0]}, Vec3{});
  const double height = dot(Vec3{n.normal_x[0], n.normal_y[0], n.normal_z[0]}, point);
  const double above = height - tree.unit * static_cast<double>(n.high[0]);
  const double below = tree.unit * static_cast<double>(n.low[0]) - height;
  return std::max({length(out), above, below});
}

/// At least how far the placed model is from the world's origin.
double reach_of_model(const Placed& placed) {
  const tree::Tree& tree = placed.model.tree();
  const double radius = root_radius(tree);
  return sum_of_sides(placed.pose.translation) + (sum_of_sides(tree.blocks[0].origin) + 2 * radius) * 1.001;
}

}  // namespace

PlacedPair::PlacedPair(const Placed& a, const Placed& b) {
  LIMBER_ASSERT(is_rigid(a.pose));
  LIMBER_ASSERT(is_rigid(b.pose));
  // Placing rounds each coordinate of a vertex or centre by some units of the magnitudes added (see
  // classic/queries.cpp); going to the other model's frame and along a heading adds as many again.
  error_ = 0x1p-45 * (reach_of_model(a) + reach_of_model(b));
  for (const auto& [placed, side] : {std::pair(&a, &sides_[0]), std::pair(&b, &sides_[1])}) {
    side->tree = &placed->model.tree();
    side->mesh = placed->model.mesh();
    side->pose = placed->pose;
    side->per_unit = 1 / side->tree->unit;
  }
}

void PlacedPair::prepare(Side s) {
  PlacedTree& side = sides_[index(s)];
  if (side.is_prepared) return;
  const PlacedTree& opposite = at(other(s));
  side.is_prepared = true;
  side.from_other = relative(side.pose, opposite.pose);
  store(side.from_other.rotation, side.rotation);
  side.ratio = static_cast<float>(std::min(opposite.tree->unit * side.per_unit, furthest));
  side.error_units = core::float_up(std::min(error_ * side.per_unit, furthest)) + 0x1p-100F;
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

Heading PlacedPair::heading(const Vec3& from_a_to_b) const {
  LIMBER_ASSERT(std::abs(length_sq(from_a_to_b) - 1) < 0x1p-40);
  const PlacedTree &a = at(Side::a), &b = at(Side::b);
  Heading h;
  h.known = true;
  h.in_a = transpose(a.pose.rotation) * from_a_to_b;
  h.in_b = transpose(b.pose.rotation) * from_a_to_b;
  store(h.in_a, h.out_of_a);
  store(-h.in_b, h.out_of_b);
  h.offset = dot(from_a_to_b, b.pose.translation - a.pose.translation);
  return h;
}

simd::Facing PlacedPair::facing(Side s, const Block& block, NodeId node) {
  prepare(s);
  const PlacedTree &own = at(s), &opposite = at(other(s));
  const Block& from = opposite.tree->blocks[tree::block_of(node)];
  const std::uint32_t k = tree::lane_of(node);
  const simd::NodeBounds& n = from.bounds;
  simd::Facing f{};
  for (int axis = 0; axis < 3; ++axis) {
    f.normal[axis] = dot3(own.rotation + 3 * axis, n.normal_x[k], n.normal_y[k], n.normal_z[k]);
  }
  const Vec3 center = (own.from_other(tree::model_center(*opposite.tree, node)) - block.origin) * own.per_unit;
  const double magnitude = std::abs(center.x) + std::abs(center.y) + std::abs(center.z);
  const float radius = n.radius[k] * own.ratio;
  if (!(magnitude < furthest) || !(static_cast<double>(radius) < furthest)) {
    constexpr auto everywhere = static_cast<float>(4 * furthest);
    f.radius = f.half[0] = f.half[1] = f.half[2] = f.high = everywhere;
    f.low = -everywhere;
    return f;
  }
  store(center, f.center);
  const float error = (static_cast<float>(magnitude) + block.reach + radius) * doubt + own.error_units;
  f.radius = radius + error;
  for (int axis = 0; axis < 3; ++axis) {
    const float half = abs_dot3(own.rotation + 3 * axis, n.half_x[k], n.half_y[k], n.half_z[k]) * own.ratio;
    f.half[axis] = std::min(half, radius) + error;
  }
  f.low = n.low[k] * own.ratio - error;
  f.high = n.high[k] * own.ratio + error;
  return f;
}

double PlacedPair::reach(Side s, NodeId node, const Heading& heading) const {
  const PlacedTree& own = at(s);
  const simd::NodeBounds& n = own.tree->blocks[tree::block_of(node)].bounds;
  const std::uint32_t k = tree::lane_of(node);
  const float* const out = heading.out_of(s);
  const float x = n.normal_x[k], y = n.normal_y[k], z = n.normal_z[k], radius = n.radius[k];
  const float cosine = dot3(out, x, y, z), cosine_abs = std::abs(cosine);
  const float height = cosine > 0 ? n.high[k] : -n.low[k];
  const float u = y * out[2] - z * out[1], v = z * out[0] - x * out[2], w = x * out[1] - y * out[0];
  const float rim = std::sqrt(std::max(0.0F, radius * radius - height * height) * (u * u + v * v + w * w));
  const float ball = radius * cosine_abs > height ? height * cosine_abs + rim : radius;
  const float box = abs_dot3(out, n.half_x[k], n.half_y[k], n.half_z[k]);
  return static_cast<double>(std::min(ball, box) + radius * doubt) * own.tree->unit;
}

double PlacedPair::leaf_reach(Side s, NodeId node, std::uint32_t leaf, const Heading& heading,
                              const simd::Kernels& kernels) const {
  const PlacedTree& own = at(s);
  const double radius = own.tree->blocks[tree::block_of(node)].bounds.radius[tree::lane_of(node)];
  const double steps = kernels.leaf_support(own.tree->leaves[leaf].corners, heading.out_of(s));
  const double step = radius / static_cast<double>(simd::quantum);
  return (steps * step + 0.87 * step + radius * static_cast<double>(doubt)) * own.tree->unit;
}

simd::Toward PlacedPair::toward(Side s, const Block& block, NodeId node, double reach, const Heading& heading,
                                double cut) const {
  const PlacedTree &own = at(s), &opposite = at(other(s));
  const bool from_a = s == Side::a;
  const Vec3 to_other = from_a ? heading.in_a : -heading.in_b, back = from_a ? -heading.in_b : heading.in_a;
  simd::Toward t{};
  std::copy(heading.out_of(s), heading.out_of(s) + 3, t.normal);
  const double facing_reach = dot(back, tree::model_center(*opposite.tree, node)) + reach;
  const double gap = heading.offset - facing_reach - dot(to_other, block.origin) - cut - error_;
  t.gap = core::float_down(std::clamp(gap * own.per_unit, -furthest, furthest)) - block.reach * doubt;
  t.cut = core::float_up(std::min(cut * own.per_unit, furthest));
  return t;
}

simd::LeafPair PlacedPair::leaf_pair(NodeId a, NodeId b, const Heading& heading, double cut, double& scale) {
  prepare(Side::a);
  const PlacedTree &ta = at(Side::a), &tb = at(Side::b);
  const Vec3 center_a = tree::model_center(*ta.tree, a), center_b = tree::model_center(*tb.tree, b);
  const double radius_a =
      ta.tree->unit * static_cast<double>(ta.tree->blocks[tree::block_of(a)].bounds.radius[tree::lane_of(a)]);
  const double radius_b =
      tb.tree->unit * static_cast<double>(tb.tree->blocks[tree::block_of(b)].bounds.radius[tree::lane_of(b)]);
  const Vec3 offset = ta.from_other(center_b) - center_a;
  const double size = std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z) + radius_a + radius_b + error_;
  scale = std::ldexp(1.0, -std::ilogb(size));  // all coordinates below 2
  LIMBER_ASSERT(size * scale >= 1 && size * scale < 2);

  simd::LeafPair p{};
  const double step_a = radius_a * scale / static_cast<double>(simd::quantum);
  const double step_b = radius_b * scale / static_cast<double>(simd::quantum);
  p.step_a = static_cast<float>(step_a), p.step_b = static_cast<float>(step_b);
  std::copy(ta.rotation, ta.rotation + 9, p.a_from_b);
  store(offset * scale, p.offset);
  const double steps = 0.87 * (step_a + step_b);  // sqrt(3) / 2 of a step, each
  p.error = core::float_up(steps + error_ * scale) + 0x1p-17F;
  p.cut = core::float_up(std::min(cut * scale, furthest));
  p.has_toward = heading.known;
  if (!heading.known) return p;
  std::copy(heading.out_of_a, heading.out_of_a + 3, p.toward_a);
  store(heading.in_b, p.toward_b);
  const double between = heading.offset + dot(heading.in_b, center_b) - dot(heading.in_a, center_a);
  const double rounding = (radius_a + radius_b) * static_cast<double>(doubt);
  p.gap = core::float_down(std::clamp((between - cut - error_ - rounding) * scale - steps, -furthest, furthest));
  return p;
}

}  // namespace limber::query
