// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Slab cut balls [LarssonAkenineMoller2009]: a ball cut by the slab that its content keeps to.
// Differs   A box shares the centre. The two lowest levels are fitted to corners, the levels above to the bounds below.
//           The origin of a block is a corner below it, so that differences of origins and corners are as exact as they
//           are small, wherever the mesh is.
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"
#include "core/rounding.h"
#include "simd/kernels.h"
#include "tree/changes.h"
#include "tree/divide.h"
#include "tree/node.h"

namespace limber::tree {
namespace {

/// A bound of everything below a block, in units, relative to the block's origin.
struct Bound {
  Vec3 center, half;
  double radius;
  Vec3 normal;  // entries are float32 numbers
  double low, high;

  bool operator==(const Bound&) const = default;
};

/// Covers the float64 rounding of everything below.
constexpr double outward = 1 + 0x1p-40;

Vec3 to_24_bits(const Vec3& v) { return {core::to_24_bits(v.x), core::to_24_bits(v.y), core::to_24_bits(v.z)}; }

Vec3 vec3(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Bound from(const simd::WholeBound& b) {
  return {vec3(b.center), vec3(b.half), b.radius, vec3(b.normal), b.low, b.high};
}

Bound lane_of_block(const Block& block, std::uint32_t k) {
  const simd::NodeBounds& n = block.bounds;
  return {local_center(block, k),
          {n.half_x[k], n.half_y[k], n.half_z[k]},
          n.radius[k],
          {n.normal_x[k], n.normal_y[k], n.normal_z[k]},
          n.low[k],
          n.high[k]};
}

/// How far a bound whose centre is at `d` reaches from the origin: as a ball, or by its slab and the ball across it.
double furthest(const Bound& b, const Vec3& d) {
  const double height = dot(b.normal, d), distance_sq = length_sq(d);
  const double along = std::max(std::abs(height + b.low), std::abs(height + b.high));
  const double across = std::sqrt(std::max(0.0, distance_sq - height * height) + distance_sq * 0x1p-20) + b.radius;
  return std::min(std::sqrt(distance_sq) + b.radius, std::sqrt(along * along + across * across) * (1 + 0x1p-20));
}

/// The root's ball around what is two levels below the root, `block` being its children; in units, as enclose(). A ball
/// around balls around balls grows by a quarter on a model that is a ball, and many queries end at the roots.
double root_radius(const Tree& tree, const Block& block, const Bound& root) {
  double radius = 0;
  for (std::uint32_t k = 0; k < block.count; ++k) {
    const Block& child = tree.blocks[block.first_child + k];
    const Vec3 shift = (child.origin - block.origin) * (1 / tree.unit) - root.center;
    for (std::uint32_t j = 0; j < child.count; ++j) {
      const Bound lane = lane_of_block(child, j);
      radius = std::max(radius, furthest(lane, lane.center + shift));
    }
  }
  return std::min(root.radius, radius * outward + 0x1p-40 * (max_abs(root.center) + max_abs(root.half)));
}

/// Stores a bound that is relative to `origin` in a lane, rounded outward.
void store(Block& block, std::uint32_t lane, const Vec3& origin, const Bound& b, double per_unit) {
  const Vec3 offset = (origin - block.origin) * per_unit;
  const Vec3 center = offset + b.center, stored = to_24_bits(center);
  // How far the stored centre is from the bound's, at most.
  const Vec3 off = center - stored;
  const double shift = (std::abs(off.x) + std::abs(off.y) + std::abs(off.z)) * outward + max_abs(offset) * 0x1p-50;
  // By more than rounding to float32 takes away.
  const auto grown = [&](double x) { return static_cast<float>(x + shift + (std::abs(x) + shift) * 0x1p-22); };
  simd::NodeBounds& n = block.bounds;
  n.center_x[lane] = static_cast<float>(stored.x);
  n.center_y[lane] = static_cast<float>(stored.y);
  n.center_z[lane] = static_cast<float>(stored.z);
  n.radius[lane] = grown(b.radius);
  n.half_x[lane] = grown(b.half.x), n.half_y[lane] = grown(b.half.y), n.half_z[lane] = grown(b.half.z);
  n.normal_x[lane] = static_cast<float>(b.normal.x);
  n.normal_y[lane] = static_cast<float>(b.normal.y);
  n.normal_z[lane] = static_cast<float>(b.normal.z);
  // The slab's heights are rounded relative to the ball, not to themselves.
  const double doubt = b.radius * 0x1p-22;
  n.low[lane] = -grown(doubt - b.low), n.high[lane] = grown(doubt + b.high);
}

void find_reach(Block& block) {
  double reach = 0;
  for (std::uint32_t k = 0; k < block.count; ++k) {
    reach = std::max(reach, length(local_center(block, k)) + static_cast<double>(block.bounds.radius[k]));
  }
  block.reach = core::float_up(reach * outward);
}

class Fitting {
 public:
  Fitting(Tree& tree, MeshView mesh) : tree_(tree), positions_(mesh.positions.data()), kernels_(simd::kernels()) {}

  /// Fits a block whose children are blocks, fitted already unless they are on the lowest level.
  void fit_upper(Block& block, bool children_are_lowest) const {
    for (std::uint32_t k = 0; k < block.count; ++k) {
      Block& child = tree_.blocks[block.first_child + k];
      const Bound bound = children_are_lowest ? fit_lowest(child) : fit_higher(child);
      if (k == 0) block.origin = child.origin;
      store(block, k, child.origin, bound, 1 / tree_.unit);
      mark_coincident(block, k, is_coincident(child, children_are_lowest));
    }
    find_reach(block);
  }

  /// Everything, bottom up.
  void fit_all() const {
    const std::size_t lowest = tree_.level_begin.size() - 2;
    if (lowest == 0) fit_lowest(tree_.blocks[0]);
    for (std::size_t level = lowest; level-- > 0;) {
      const std::uint32_t begin = tree_.level_begin[level], end = tree_.level_begin[level + 1];
      core::parallel_for(end - begin, 16,
                         [&](std::size_t i) { fit_upper(tree_.blocks[begin + i], level + 1 == lowest); });
    }
  }

  /// A block whose corners or lanes have changed, and the lane it hangs from. Returns whether that has changed.
  bool refit(std::uint32_t b, bool is_lowest) const {
    Block& block = tree_.blocks[b];
    if (!is_lowest) find_reach(block);
    const Bound bound = is_lowest ? fit_lowest(block) : fit_higher(block);
    if (b == 0) return false;
    Block& parent = tree_.blocks[block_of(block.parent)];
    const std::uint32_t lane = lane_of(block.parent);
    if (lane == 0 && has_left(block, parent)) {
      fit_upper(parent, is_lowest);
      return true;
    }
    const Bound before = lane_of_block(parent, lane);
    store(parent, lane, block.origin, bound, 1 / tree_.unit);
    const bool was_coincident = (parent.coincident >> lane & 1) != 0, is_now = is_coincident(block, is_lowest);
    mark_coincident(parent, lane, is_now);
    // The root also goes by the lanes two levels below it. Coincident triangles may have moved too little to be seen in
    // the bounds, and no longer coincide with those beside them.
    return before != lane_of_block(parent, lane) || &parent == below_root() || was_coincident || is_now;
  }

  /// Fetches what the blocks after the i-th will need: leaves, then positions.
  void prefetch(const std::vector<std::uint32_t>& blocks, std::size_t i) const {
    constexpr std::size_t leaves_ahead = 4, positions_ahead = 2;
    if (i + leaves_ahead < blocks.size()) {
      for_every_leaf(blocks[i + leaves_ahead], [](const Leaf& leaf) {
        __builtin_prefetch(leaf.vertices);
        __builtin_prefetch(leaf.vertices + width - 1);
      });
    }
    if (i + positions_ahead < blocks.size()) {
      for_every_leaf(blocks[i + positions_ahead], [&](const Leaf& leaf) {
        for (std::uint32_t j = 0; j < width; j += 2) __builtin_prefetch(&positions_[leaf.vertices[j][2]]);
      });
    }
  }

  /// Whether the model has outgrown the unit of the tree, or shrunk far below it; then the unit is another. What the
  /// bounds tell suffices to notice; of a model that has shrunk by more than 2^60 they do not tell the size.
  bool adapts_unit(MeshView mesh) const {
    const Bound root = lane_of_block(tree_.blocks[0], 0);
    const double unit = unit_for(2 * tree_.unit * length(root.half), max_abs(tree_.blocks[0].origin));
    if (unit <= 1024 * tree_.unit && tree_.unit <= 1024 * unit) return false;
    const double before = std::exchange(tree_.unit, extent_of(mesh).unit());
    return tree_.unit != before;
  }

 private:
  /// Fits a block of the lowest level and its leaves.
  Bound fit_lowest(Block& block) const {
    const std::span<Leaf> leaves(tree_.leaves);
    return from(kernels_.fit_leaves(positions_, tree_.unit, block, leaves.subspan(block.first_child)));
  }

  /// The same for a block whose children are blocks.
  Bound fit_higher(const Block& block) const {
    Bound bound = from(kernels_.enclose(block));
    if (&block == below_root()) bound.radius = root_radius(tree_, block, bound);
    return bound;
  }

  static void mark_coincident(Block& block, std::uint32_t lane, bool is) {
    block.coincident = (block.coincident & ~(1U << lane)) | (is ? 1U << lane : 0U);
  }

  /// Whether all triangles below a block, whose own marks are right, are at one place, corner by corner.
  bool is_coincident(const Block& block, bool is_lowest) const {
    if (is_lowest) {
      // Quantised corners nearly always tell at once.
      const std::int16_t(&row)[width] = tree_.leaves[block.first_child].corners.corner[0];
      if (!std::all_of(row, row + width, [&](std::int16_t x) { return x == row[0]; })) return false;
    } else if (block.coincident != (1U << block.count) - 1) {
      return false;
    }
    const auto& first = tree_.leaves[first_leaf(block, 0, is_lowest)].vertices[0];
    for (std::uint32_t k = 0; k < block.count; ++k) {
      const Leaf& leaf = tree_.leaves[first_leaf(block, k, is_lowest)];
      for (std::uint32_t j = 0; j < (is_lowest ? width : 1); ++j) {
        for (std::size_t c = 0; c < 3; ++c) {
          if (positions_[leaf.vertices[j][c]] != positions_[first[c]]) return false;
        }
      }
    }
    return true;
  }
  /// The first leaf below a lane.
  std::uint32_t first_leaf(const Block& block, std::uint32_t lane, bool is_lowest) const {
    if (is_lowest) return block.first_child + lane;
    const NodeId leaf = first_leaf_below(tree_, (block.first_child + lane) * width);
    return tree_.blocks[block_of(leaf)].first_child;
  }

  /// The block of the root's children.
  const Block* below_root() const { return &tree_.blocks[1]; }

  template <typename Visit>
  void for_every_leaf(std::uint32_t b, const Visit& visit) const {
    const Block& block = tree_.blocks[b];
    for (std::uint32_t k = 0; k < block.count; ++k) visit(tree_.leaves[block.first_child + k]);
  }

  /// Whether the first child is so far from the origin of its parent, which was its own, that places get blurred.
  bool has_left(const Block& child, const Block& parent) const {
    const simd::NodeBounds& n = parent.bounds;
    const float largest = *std::max_element(n.radius, n.radius + parent.count);
    return max_abs(child.origin - parent.origin) > 64 * tree_.unit * static_cast<double>(largest);
  }

  Tree& tree_;
  const Vec3* positions_;
  const simd::Kernels& kernels_;
};

}  // namespace

double unit_for(double size, double magnitude) {
  LIMBER_ASSERT(std::isfinite(size) && std::isfinite(magnitude));
  int exponent = 0;
  const double fraction = std::frexp(std::max({size, 0x1p-50 * magnitude, 0x1p-900}), &exponent);
  return std::ldexp(1, fraction == 0.5 ? exponent - 1 : exponent);
}

void fit(Tree& tree, MeshView mesh) {
  LIMBER_ASSERT(tree.level_begin.size() >= 2);
  const Fitting fitting(tree, mesh);
  fitting.fit_all();
  if (fitting.adapts_unit(mesh)) fitting.fit_all();
  LIMBER_ASSERT(std::isfinite(tree.blocks[0].bounds.radius[0]));
}

std::uint64_t refit(Tree& tree, MeshView mesh, Changes& changes) {
  if (changes.is_most_of(tree)) {
    changes.add_all();  // until that is done
    fit(tree, mesh);
    changes.clear();
    return tree.blocks.size();
  }
  const std::size_t lowest = tree.level_begin.size() - 2;
  const Fitting fitting(tree, mesh);
  std::uint64_t refitted = 0;
  changes.sort_lowest();
  for (std::size_t level = lowest + 1; level-- > 0;) {
    const std::vector<std::uint32_t>& blocks = changes.blocks(level);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (level == lowest) fitting.prefetch(blocks, i);
      const std::uint32_t block = blocks[i];
      ++refitted;
      if (fitting.refit(block, level == lowest)) changes.add_block(level - 1, block_of(tree.blocks[block].parent));
    }
  }
  if (fitting.adapts_unit(mesh)) {
    changes.add_all();
    fit(tree, mesh);
  }
  changes.clear();
  return refitted;
}

}  // namespace limber::tree
