// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Boxes are minima and maxima of stored coordinates, so nothing is rounded. Corners of leaves are float32, for kernels.
#include "bvh/moving_tree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/check.h"
#include "base/parallel.h"

namespace limber::bvh {
namespace {

// Fewer nodes are not worth a task.
constexpr std::size_t moving_nodes_per_task = 16;

/// The power of two that is next above a length, and not so small that dividing by it overflows.
double unit_above(double length) {
  constexpr int least_exponent = -900;
  return std::ldexp(1.0, length > 0 ? std::max(std::ilogb(length) + 1, least_exponent) : least_exponent);
}

class MovingFit {
 public:
  MovingFit(MovingTree& moving, const Tree& tree, std::span<const Vec3> start, std::span<const Vec3> end)
      : moving_(moving), tree_(tree), positions_{start.data(), end.data()} {
    moving.nodes.resize(tree.nodes.size());
    moving.leaves.resize(tree.leaves.size());
  }

  void fit_all() {
    LIMBER_ASSERT(tree_.level_begin.size() >= 2);
    for (std::size_t level = tree_.lowest_level() + 1; level-- > 0;) {
      const std::uint32_t begin = tree_.level_begin[level], end = tree_.level_begin[level + 1];
      const bool is_lowest = level == tree_.lowest_level();
      base::parallel_for(end - begin, moving_nodes_per_task, [&](std::size_t i) {
        const auto node = static_cast<std::uint32_t>(begin + i);
        is_lowest ? fit_lowest(node) : fit_upper(node);
      });
    }
  }

 private:
  /// The boxes of leaves, and the leaves.
  void fit_lowest(std::uint32_t n) {
    const Node& node = tree_.nodes[n];
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      const std::uint32_t child = node.first_child + k;
      fit_leaf(tree_.leaves[child], moving_.leaves[child], moving_.nodes[n], k);
    }
    repeat_last(moving_.nodes[n], node.child_count);
  }
  void fit_leaf(const Leaf& leaf, MovingLeaf& moving, MovingNode& node, std::uint32_t slot) const {
    for (std::uint32_t end = 0; end < motion_ends; ++end) {
      const Vec3* const positions = positions_[end];
      Vec3 corners[3][width];
      Vec3 low = positions[leaf.vertices[0][0]], high = low;
      for (std::uint32_t k = 0; k < width; ++k) {
        for (std::uint32_t corner = 0; corner < 3; ++corner) {
          const Vec3& p = corners[corner][k] = positions[leaf.vertices[k][corner]];
          low = min(low, p), high = max(high, p);
        }
      }
      const Vec3 center = 0.5 * low + 0.5 * high;
      const double unit = unit_above(std::max(max_abs(high - center), max_abs(center - low))), per_unit = 1 / unit;
      moving.unit[end] = unit;
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        node.low[end][axis][slot] = low[axis], node.high[end][axis][slot] = high[axis];
        moving.center[end][axis] = center[axis];
        for (std::uint32_t corner = 0; corner < 3; ++corner) {
          float* const row = moving.corner[end][3 * corner + axis];
          for (std::uint32_t k = 0; k < width; ++k) {
            row[k] = static_cast<float>((corners[corner][k][axis] - center[axis]) * per_unit);
          }
        }
      }
    }
  }

  /// The boxes around the children of the children.
  void fit_upper(std::uint32_t n) {
    const Node& node = tree_.nodes[n];
    MovingNode& boxes = moving_.nodes[n];
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      const MovingNode& child = moving_.nodes[node.first_child + k];
      for (std::uint32_t end = 0; end < motion_ends; ++end) {
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
          const auto &low = child.low[end][axis], &high = child.high[end][axis];
          boxes.low[end][axis][k] = *std::min_element(low, low + width);
          boxes.high[end][axis][k] = *std::max_element(high, high + width);
        }
      }
    }
    repeat_last(boxes, node.child_count);
  }

  /// Fills the slots that have no child.
  static void repeat_last(MovingNode& node, std::uint32_t count) {
    for (std::uint32_t end = 0; end < motion_ends; ++end) {
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        for (auto* const row : {node.low[end][axis], node.high[end][axis]}) {
          std::fill(row + count, row + width, row[count - 1]);
        }
      }
    }
  }

  MovingTree& moving_;
  const Tree& tree_;
  const Vec3* positions_[motion_ends];
};

}  // namespace

void fit(MovingTree& moving, const Tree& tree, std::span<const Vec3> start, std::span<const Vec3> end) {
  MovingFit(moving, tree, start, end).fit_all();
}

}  // namespace limber::bvh
