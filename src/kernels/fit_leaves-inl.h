// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::fit_leaves, and the normal of a slab: the mean normal of what it bounds.

#if defined(LIMBER_SIMD_FIT_LEAVES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIT_LEAVES_INL_H
#undef LIMBER_SIMD_FIT_LEAVES_INL_H
#else
#define LIMBER_SIMD_FIT_LEAVES_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <span>

#include "base/error_bounds.h"
#include "base/memory.h"
#include "kernels/slab_sides-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Areas below this have lost too many digits.
inline constexpr float smallest_area = 0x1p-120F;

/// A unit vector along `area`, or the direction in which the box is thinnest if the area is 0.
LIMBER_KERNEL Packet3 slab_normal(const Packet3& area, const Packet3& half) {
  const Packet zeros = zero(), ones = Packet::set(1);
  const Packet size = largest_abs(area);
  const Packet3 scaled = area * (ones / max(size, Packet::set(smallest_float)));
  const Packet3 normal = scaled * (ones / max(sqrt(dot(scaled, scaled)), Packet::set(0.5F)));
  const Mask x_is_thinner = half.x <= half.y;
  const Mask z_is_thinnest = half.z < min(half.x, half.y);
  Packet3 thinnest{select(x_is_thinner, ones, zeros), select(x_is_thinner, zeros, ones), zeros};
  thinnest = select(z_is_thinnest, Packet3{zeros, zeros, ones}, thinnest);
  return select(size > Packet::set(smallest_area), normal, thinnest);
}

/// The sum of vectors, each of them or its opposite, whichever is on the side of the sum of those before it.
LIMBER_KERNEL void sum_aligned(const float (&v)[3][width], float (&sum)[3]) {
  sum[0] = sum[1] = sum[2] = 0;
  for (std::uint32_t k = 0; k < width; ++k) {
    const float side = sum[0] * v[0][k] + sum[1] * v[1][k] + sum[2] * v[2][k];
    for (int axis = 0; axis < 3; ++axis) sum[axis] += side < 0 ? -v[axis][k] : v[axis][k];
  }
}

// Kernels::fit_leaves. The SIMD lanes are the leaves of a node, so nothing has to be summed up across lanes.
//
// Corners are float32 relative to one of their own leaf, so however small a leaf is, its numbers are as exact as it
// needs; every bound is enlarged by the rounding on the way.

// Against a division by 0.
inline constexpr float smallest_extent = 0x1p-100F;

/// The index of corner k of triangle j of a leaf.
LIMBER_KERNEL std::uint32_t corner_index(std::uint32_t k, std::uint32_t j) { return width * k + j; }

/// The corners of the leaves of a node, by axis, corner and leaf, in units.
struct alignas(64) CornerArrays {
  float v[3][3 * width * width];

  template <typename P = Packet>
  LIMBER_KERNEL Triple<P> at(std::uint32_t corner, std::uint32_t leaf) const {
    const std::uint32_t i = width * corner + leaf;
    return {P::load(v[0] + i), P::load(v[1] + i), P::load(v[2] + i)};
  }
};

/// The corners of the leaves of a node; leaves beyond the last repeat it.
struct NodeCorners {
  CornerArrays corners;                 // relative to origin[leaf]
  alignas(64) double origin[3][width];  // a corner of each leaf, model frame
};

LIMBER_KERNEL void gather(const Vec3* positions, std::span<const bvh::Leaf> leaves, std::uint32_t count,
                          double per_unit, NodeCorners& gathered) {
  const auto position = [&](VertexId id) { return &positions[id].x; };
  // Positions are prefetched for the next node. Their ids have to be in a cache by then, so leaves are prefetched
  // for the one after it. At the end, where there are no more leaves, those at hand are prefetched: branches cost more.
  const auto leaves_ahead = [&](std::size_t nodes) { return (nodes + 1) * count <= leaves.size() ? nodes * count : 0; };
  const std::size_t one_ahead = leaves_ahead(1), two_ahead = leaves_ahead(2);
  // In the order of load_points(): by corner and triangles, then leaf, then triangle; four numbers each.
  constexpr std::uint32_t at_once = corners_at_once;
  alignas(64) float scaled[4 * 3 * width * width];
  for (std::uint32_t k = 0; k < width; ++k) {
    const bvh::Leaf& leaf = leaves[std::min(k, count - 1)];
    const double* const origin = position(leaf.vertices[0][0]);
    for (int axis = 0; axis < 3; ++axis) gathered.origin[axis][k] = origin[axis];
    base::prefetch((&leaf)[two_ahead]);
    for (std::uint32_t j = 0; j < width; j += 2) __builtin_prefetch(position((&leaf)[one_ahead].vertices[j][2]));
    const double* origins[at_once];
    for (const double*& from : origins) from = origin;
    const PointScaler scaler(origins, per_unit);
    for (std::uint32_t j = 0; j < width; j += at_once) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        const double* points[at_once];
        for (std::uint32_t i = 0; i < at_once; ++i) points[i] = position(leaf.vertices[j + i][c]);
        scaler.scale(points, scaled + 4 * (width * corner_index(c, j) + at_once * k));
      }
    }
  }
  for (std::uint32_t i = 0; i < 3 * width * width; i += WidePacket::lanes) {
    Triple<WidePacket> p;
    load_points(scaled + 4 * i, p.x, p.y, p.z);
    p.x.store(gathered.corners.v[0] + i), p.y.store(gathered.corners.v[1] + i), p.z.store(gathered.corners.v[2] + i);
  }
}

/// Boxes of the leaves, and the sums of the area vectors of their triangles and of two edges of each, all on one side.
struct BoxesAndAreas {
  alignas(64) float low[3][width], high[3][width], area[3][width], edge[3][width];
};

template <bool with_sides>
LIMBER_KERNEL void find_boxes_and_areas(const CornerArrays& corners, BoxesAndAreas& found) {
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    Triple<WidePacket> lows = corners.at<WidePacket>(0, i), highs = lows;
    for (std::uint32_t c = corners_at_once; c < 3 * width; c += corners_at_once) {
      const Triple<WidePacket> p = corners.at<WidePacket>(c, i);
      lows = min3(lows, p), highs = max3(highs, p);
    }
    const Packet3 low{smaller_half(lows.x), smaller_half(lows.y), smaller_half(lows.z)};
    const Packet3 high{larger_half(highs.x), larger_half(highs.y), larger_half(highs.z)};
    // Relative to the leaf's extent, so that products of tiny edges do not vanish.
    const Packet extent = max(largest_abs(low), largest_abs(high));
    const Packet scale = Packet::set(1) / max(extent, Packet::set(smallest_extent));
    // Two sums, of every other triangle each.
    const WidePacket none = duplicated(zero()), scales = duplicated(scale);
    Triple<WidePacket> sums[2 / corners_at_once];
    for (Triple<WidePacket>& sum : sums) sum = {none, none, none};
    Triple<WidePacket> edge_sums[2 / corners_at_once];  // likewise
    for (Triple<WidePacket>& edges : edge_sums) edges = {none, none, none};
    for (std::uint32_t j = 0; j < width; j += corners_at_once) {
      Triple<WidePacket>& sum = sums[j % 2 / corners_at_once];
      const Triple<WidePacket> p = corners.at<WidePacket>(corner_index(0, j), i);
      const Triple<WidePacket> edge_b = (corners.at<WidePacket>(corner_index(1, j), i) - p) * scales;
      const Triple<WidePacket> edge_c = (corners.at<WidePacket>(corner_index(2, j), i) - p) * scales;
      sum = sum + aligned(cross(edge_b, edge_c), sum);
      Triple<WidePacket>& edges = edge_sums[j % 2 / corners_at_once];
      if (with_sides) edges = edges + aligned(edge_b, edges), edges = edges + aligned(edge_c, edges);
    }
    const Packet3 even{first_of(sums[0].x), first_of(sums[0].y), first_of(sums[0].z)};
    const Triple<WidePacket>& last = sums[2 / corners_at_once - 1];
    const Packet3 odd{last_of(last.x), last_of(last.y), last_of(last.z)};
    const Packet3 sum = even + aligned(odd, even);
    store3(low, found.low, i), store3(high, found.high, i);
    store3(sum * (extent * extent), found.area, i);
    if (!with_sides) continue;
    const Triple<WidePacket>&first_edges = edge_sums[0], &last_edges = edge_sums[2 / corners_at_once - 1];
    const Packet3 even_edges{first_of(first_edges.x), first_of(first_edges.y), first_of(first_edges.z)};
    const Packet3 odd_edges{last_of(last_edges.x), last_of(last_edges.y), last_of(last_edges.z)};
    store3((even_edges + aligned(odd_edges, even_edges)) * extent, found.edge, i);
  }
}

/// The radius of corners about a center, and the intervals of their heights over it along a slab's normal and along two
/// directions in its plane.
struct Extent {
  Packet radius, low, high;
  Packet side_low[2], side_high[2];
};

LIMBER_KERNEL void half_sizes(const Extent& e, Packet (&half)[3]) {
  const Packet one_half = Packet::set(0.5F);
  half[0] = one_half * (e.high - e.low);
  for (int k = 0; k < 2; ++k) half[k + 1] = one_half * (e.side_high[k] - e.side_low[k]);
}

/// Computes an extent, corner by corner.
template <bool with_sides>
struct ExtentFit {
  static constexpr int axis_count = with_sides ? 3 : 1;
  Triple<WidePacket> shift;  // the center, relative to what corners are relative to
  Triple<WidePacket> axes[axis_count];
  WidePacket farthest_sq = duplicated(zero());
  WidePacket low[axis_count], high[axis_count];

  LIMBER_KERNEL ExtentFit(const Packet3& center, const Packet3& normal, Packet turn) : shift(duplicated(center)) {
    axes[0] = duplicated(normal);
    if constexpr (with_sides) {
      const Packet3 side = in_plane(normal, turn);
      axes[1] = duplicated(side), axes[2] = duplicated(cross(normal, side));
    }
    for (WidePacket& x : low) x = duplicated(Packet::set(far_off));
    for (WidePacket& x : high) x = duplicated(Packet::set(-far_off));
  }

  LIMBER_KERNEL void add(const Triple<WidePacket>& corner) {
    const Triple<WidePacket> d = corner - shift;
    farthest_sq = max(farthest_sq, dot(d, d));
    for (int k = 0; k < axis_count; ++k) {
      const WidePacket height = dot(axes[k], d);
      low[k] = min(low[k], height), high[k] = max(high[k], height);
    }
  }
  /// `error` is at least what corners and shift are off by.
  LIMBER_KERNEL Extent extent(Packet error) const {
    const Packet radius = sqrt(larger_half(farthest_sq)) * Packet::set(base::squares_up) + (error + error);
    const Packet tilt = (error + error) + radius * Packet::set(base::corner_error);
    const auto lowest = [&](int k) { return smaller_half(low[k]) - tilt; };
    const auto highest = [&](int k) { return larger_half(high[k]) + tilt; };
    Extent found{radius, lowest(0), highest(0), {}, {}};
    for (int k = 1; k < axis_count; ++k) found.side_low[k - 1] = lowest(k), found.side_high[k - 1] = highest(k);
    return found;
  }
};

/// Stores the corners as fractions of the radius of their leaf.
LIMBER_KERNEL void quantize(const CornerArrays& corners, const bvh::ChildBounds& bounds, const float (&shift)[3][width],
                            std::uint32_t count, bvh::Leaf* leaves) {
  bvh::QuantizedTriangles unused;  // for slots without a leaf
  bvh::QuantizedTriangles* to[width];
  for (std::uint32_t k = 0; k < width; ++k) to[k] = k < count ? &leaves[k].corners : &unused;
  WidePacket scale[width / Packet::lanes];
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    scale[i / Packet::lanes] = duplicated(Packet::set(bvh::max_quantized) / Packet::load(bounds.radius + i));
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      // A row has one triangle of each leaf; a packet is a part of a row, or two rows.
      Int16Tile tile;
      for (std::uint32_t i = 0; i < width * width; i += WidePacket::lanes) {
        const WidePacket center = duplicated(Packet::load(shift[axis] + i % width));
        const WidePacket p = WidePacket::load(corners.v[axis] + width * corner_index(k, 0) + i);
        tile.put(i, (p - center) * scale[i % width / Packet::lanes]);
      }
      std::int16_t* columns[width];
      for (std::uint32_t leaf = 0; leaf < width; ++leaf) columns[leaf] = to[leaf]->corner[3 * k + axis];
      tile.store_columns(columns);
    }
  }
}

/// A bound without its extent.
struct BoundFrame {
  float center[3], half[3];
  Packet3 normal;
  Packet turn;
  float error;  // at least what corners are off by
};

/// That of all leaves together; their origins are at `in_node`, relative to the origin of the node.
template <bool with_sides>
LIMBER_KERNEL BoundFrame frame_of_all(const BoxesAndAreas& found, const float (&in_node)[3][width]) {
  BoundFrame frame;
  float low[3], high[3], area[3], extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Packet lowest = Packet::set(far_off), highest = Packet::set(-far_off);
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Packet origin = Packet::load(in_node[axis] + i);
      lowest = min(lowest, Packet::load(found.low[axis] + i) + origin);
      highest = max(highest, Packet::load(found.high[axis] + i) + origin);
    }
    low[axis] = -largest(zero() - lowest), high[axis] = largest(highest);
    extent = std::max({extent, std::abs(low[axis]), std::abs(high[axis])});
  }
  frame.error = extent * base::corner_error + base::smallest_corner_error;
  sum_aligned(found.area, area);
  for (int axis = 0; axis < 3; ++axis) {
    const float center = 0.5F * low[axis] + 0.5F * high[axis];
    frame.center[axis] = center;
    frame.half[axis] = std::max(high[axis] - center, center - low[axis]) + frame.error;
  }
  frame.normal = slab_normal(broadcast(area), broadcast(frame.half));
  frame.turn = zero();
  if (with_sides) {
    float edge[3];
    sum_aligned(found.edge, edge);
    frame.turn = turn_along(frame.normal, broadcast(edge));
  }
  return frame;
}

template <bool with_sides>
LIMBER_KERNEL bvh::MergedBounds bound_of(const BoundFrame& frame, const Extent& all) {
  bvh::MergedBounds whole;
  alignas(64) float n[3][width];
  store3(frame.normal, n, 0);
  for (int axis = 0; axis < 3; ++axis) {
    whole.center[axis] = frame.center[axis], whole.half[axis] = frame.half[axis], whole.normal[axis] = n[axis][0];
  }
  whole.radius = largest(all.radius), whole.high = largest(all.high), whole.low = -largest(zero() - all.low);
  if (with_sides) {
    float low[2], high[2];
    for (int k = 0; k < 2; ++k) low[k] = -largest(zero() - all.side_low[k]), high[k] = largest(all.side_high[k]);
    set_sides(frame.turn, low, high, whole);
  } else {
    set_no_sides(whole);
  }
  return whole;
}

/// base::to_24_bits().
LIMBER_KERNEL Doubles to_24_bits(Doubles x) {
  const Doubles high = x * Doubles::set(0x1p29 + 1);
  return or_zero(high - (high - x), x, 0x1p-100);
}

template <bool with_sides>
LIMBER_KERNEL bvh::MergedBounds fit_leaves(const Vec3* positions, double unit, bvh::Node& node,
                                           std::span<bvh::Leaf> leaves) {
  const double per_unit = 1 / unit;
  NodeCorners gathered;
  gather(positions, leaves, node.child_count, per_unit, gathered);
  BoxesAndAreas found;
  find_boxes_and_areas<with_sides>(gathered.corners, found);

  // The origins of the leaves in the node; and their centers, relative to the node and relative to the leaf's origin.
  node.origin = {gathered.origin[0][0], gathered.origin[1][0], gathered.origin[2][0]};
  alignas(64) float in_node[3][width], shift[3][width], stored[3][width];
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const Doubles from = Doubles::set(gathered.origin[axis][0]);
    for (std::uint32_t k = 0; k < width; k += Doubles::lanes) {
      const Doubles offset = (Doubles::load(gathered.origin[axis] + k) - from) * Doubles::set(per_unit);
      const Doubles box_center =
          Doubles::set(0.5) * (Doubles::from_floats(found.low[axis] + k) + Doubles::from_floats(found.high[axis] + k));
      const Doubles center = to_24_bits(offset + box_center);
      offset.store_rounded(in_node[axis] + k);
      center.store_rounded(stored[axis] + k);
      (center - offset).store_rounded(shift[axis] + k);
    }
  }
  const BoundFrame frame = frame_of_all<with_sides>(found, in_node);
  const Packet lowest = Packet::set(-far_off), highest = Packet::set(far_off);
  Extent all{zero(), highest, lowest, {highest, highest}, {lowest, lowest}};
  bvh::ChildBounds& n = node.bounds;
  Packet farthest = zero();
  unsigned elongated = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 low = load3(found.low, i), high = load3(found.high, i), center = load3(shift, i);
    const Packet extent = max(max(largest_abs(low), largest_abs(high)), largest_abs(center));
    const Packet3 in_units = load3(stored, i);
    const Packet error = extent * Packet::set(base::corner_error) +
                         largest_abs(in_units) * Packet::set(static_cast<float>(base::offset_error)) +
                         Packet::set(base::smallest_corner_error);
    const Packet3 half = max3(high - center, center - low) + Packet3{error, error, error};
    const Packet3 normal = slab_normal(load3(found.area, i), half);
    const Packet turn = with_sides ? turn_along(normal, load3(found.edge, i)) : zero();
    ExtentFit<with_sides> own(center, normal, turn);
    ExtentFit<with_sides> common(broadcast(frame.center) - load3(in_node, i), frame.normal, frame.turn);
    for (std::uint32_t c = 0; c < 3 * width; c += corners_at_once) {
      const Triple<WidePacket> corner = gathered.corners.at<WidePacket>(c, i);
      own.add(corner), common.add(corner);
    }
    const Extent fitted = own.extent(error), some = common.extent(Packet::set(frame.error));
    all.radius = max(all.radius, some.radius), all.low = min(all.low, some.low), all.high = max(all.high, some.high);
    for (int k = 0; with_sides && k < 2; ++k) {
      all.side_low[k] = min(all.side_low[k], some.side_low[k]);
      all.side_high[k] = max(all.side_high[k], some.side_high[k]);
    }
    in_units.x.store(n.center_x + i), in_units.y.store(n.center_y + i), in_units.z.store(n.center_z + i);
    half.x.store(n.half_x + i), half.y.store(n.half_y + i), half.z.store(n.half_z + i);
    normal.x.store(n.normal_x + i), normal.y.store(n.normal_y + i), normal.z.store(n.normal_z + i);
    fitted.radius.store(n.radius + i), fitted.low.store(n.low + i), fitted.high.store(n.high + i);
    Packet along_slab[3] = {zero(), zero(), zero()};
    if (with_sides) half_sizes(fitted, along_slab);
    const Mask is_long = with_sides ? is_elongated(along_slab, half) : normal.x > Packet::set(far_off);  // nowhere
    elongated |= bits(is_long) << i;
    turn.store_int16(node.sides.turn + i);
    store_sides(fitted.side_low, fitted.side_high, fitted.radius, is_long, i, node.sides);
    farthest = max(farthest, sqrt(dot(in_units, in_units)) * Packet::set(base::squares_up) + fitted.radius);
  }
  node.radius = (largest(farthest) + base::smallest_corner_error) * base::squares_up;
  node.elongated_slots = elongated & bvh::used_slots(node);
  quantize(gathered.corners, n, shift, node.child_count, leaves.data());
  return bound_of<with_sides>(frame, all);
}

LIMBER_KERNEL bvh::MergedBounds fit_leaves(const Vec3* positions, double unit, bvh::Node& node,
                                           std::span<bvh::Leaf> leaves, bool sides) {
  return sides ? fit_leaves<true>(positions, unit, node, leaves) : fit_leaves<false>(positions, unit, node, leaves);
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
