// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/tree.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/parallel.h"
#include "bvh/partition.h"

namespace limber::bvh {
namespace {

// A bounding box is found in parts, one task each: at least so many triangles in a part, and at most so many parts.
constexpr std::size_t triangles_per_part = 8192, most_parts = 64;

}  // namespace

double unit_for(double size, double magnitude) {
  LIMBER_ASSERT(std::isfinite(size) && std::isfinite(magnitude));
  constexpr double magnitude_resolved = 0x1p-50, smallest_unit = 0x1p-900;
  int exponent = 0;
  // The argument is fraction * 2^exponent with 0.5 <= fraction < 1: itself a power of two if the fraction is 0.5.
  const double fraction = std::frexp(std::max({size, magnitude_resolved * magnitude, smallest_unit}), &exponent);
  return std::ldexp(1, fraction == 0.5 ? exponent - 1 : exponent);
}

BoundingBox bounding_box_of(MeshView mesh) {
  const std::size_t count = mesh.triangles.size();
  const std::size_t size = std::max(triangles_per_part, (count + most_parts - 1) / most_parts);
  std::array<BoundingBox, most_parts> boxes;  // no vector: commits must not allocate
  base::parallel_for_ranges(count, size, [&](std::size_t begin, std::size_t end) {
    BoundingBox box;  // not boxes[i] itself: the compiler keeps a local variable in registers
    for (std::size_t t = begin; t < end; ++t) box.add(mesh.triangle(static_cast<TriangleId>(t)));
    boxes[begin / size] = box;
  });
  BoundingBox all;
  for (const BoundingBox& box : boxes) all.add(box);
  return all;
}

namespace {

// Fewer are not worth a task.
constexpr std::size_t primitives_per_task = 4096, leaves_per_task = 1024;

/// A build id that no tree has had.
std::uint64_t new_build_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

/// Appends, for each of `children` children, how many of `leaves` leaves are below it.
void distribute_leaves(std::uint32_t leaves, std::uint32_t children, std::vector<std::uint32_t>& counts) {
  if (children == 1) return counts.push_back(leaves);
  const std::uint32_t first = first_half_leaves(leaves, children);
  distribute_leaves(first, children / 2, counts);
  distribute_leaves(leaves - first, children - children / 2, counts);
}

/// How many leaves are below each slot of a level, level by level: first below the root slot, at last below those that
/// have a leaf each.
std::vector<std::vector<std::uint32_t>> leaves_below_slots(std::uint32_t leaves) {
  std::vector<std::vector<std::uint32_t>> levels{{leaves}};
  while (levels.back().front() > 1) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t below : levels.back()) distribute_leaves(below, child_count(below), next);
    levels.push_back(std::move(next));
  }
  return levels;
}

/// Creates all nodes, without bounds, level by level.
void create_nodes(Tree& tree, std::uint32_t leaves) {
  std::vector<std::vector<std::uint32_t>> levels = leaves_below_slots(leaves);
  levels.pop_back();  // slots with leaves have no nodes
  std::size_t count = 1;
  for (const auto& level : levels) count += level.size();
  tree.nodes.reserve(count);
  tree.nodes.push_back({});
  tree.nodes[0].child_count = 1;
  tree.nodes[0].elongated_slots = 1;
  tree.level_begin = {0, 1};
  for (const std::vector<std::uint32_t>& level : levels) {
    std::uint32_t parent = tree.level_begin[tree.level_begin.size() - 2], slot = 0;
    for (const std::uint32_t below : level) {
      const auto node = static_cast<std::uint32_t>(tree.nodes.size());
      if (slot == 0) tree.nodes[parent].first_child = node;
      tree.nodes.push_back({});
      tree.nodes.back().child_count = child_count(below);
      tree.nodes.back().parent = parent * width + slot;
      tree.nodes.back().elongated_slots = used_slots(tree.nodes.back());  // until they are fitted
      if (++slot == tree.nodes[parent].child_count) slot = 0, ++parent;
    }
    tree.level_begin.push_back(static_cast<std::uint32_t>(tree.nodes.size()));
  }
  std::uint32_t leaf = 0;
  for (std::uint32_t n = tree.first_lowest_node(); n < tree.nodes.size(); ++n) {
    tree.nodes[n].first_child = leaf;
    leaf += tree.nodes[n].child_count;
  }
  LIMBER_ASSERT(leaf == leaves);
}

}  // namespace

void Tree::exchange(TreeGeometry& other) {
  LIMBER_ASSERT(level_begin == other.level_begin);
  std::swap(static_cast<TreeGeometry&>(*this), other);
  build_id = new_build_id();
  displacement = 0;
}

Tree build(MeshView mesh) {
  LIMBER_ASSERT(!mesh.triangles.empty());
  Tree tree;
  tree.build_id = new_build_id();
  const BoundingBox box = bounding_box_of(mesh);
  tree.unit = box.unit();

  const std::size_t count = mesh.triangles.size();
  const auto memory = std::make_unique_for_overwrite<PrimitiveRef[]>(count);
  const std::span<PrimitiveRef> primitives(memory.get(), count);
  const auto memory_of_sides = std::make_unique_for_overwrite<HalfSides[]>(count);
  const std::span<HalfSides> half_sides(memory_of_sides.get(), count);
  const PrimitiveSource source{mesh, box.center(), 0.5 / tree.unit};
  base::parallel_for(count, primitives_per_task, [&](std::size_t t) {
    primitives[t] = source.primitive_of(static_cast<TriangleId>(t), half_sides[t]);
  });
  partition_into_leaves(primitives, build_range(0, count), half_sides);
  const std::uint32_t leaves = leaf_count(count);
  create_nodes(tree, leaves);
  tree.leaves.resize(leaves);
  base::parallel_for(tree.leaves.size(), leaves_per_task,
                     [&](std::size_t i) { write_leaf(tree.leaves[i], mesh, primitives_of_leaf(primitives, i)); });
  fit(tree, mesh);
  return tree;
}

// Boxes are minima and maxima of stored coordinates, so nothing is rounded. Corners of leaves are float32, for kernels.

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
      double corners[9][width];  // as in MovingLeaf: loops over slots become vectors
      for (std::uint32_t k = 0; k < width; ++k) {
        for (std::uint32_t corner = 0; corner < 3; ++corner) {
          const Vec3& p = positions[leaf.vertices[k][corner]];
          for (std::uint32_t axis = 0; axis < 3; ++axis) corners[3 * corner + axis][k] = p[axis];
        }
      }
      double low[3], high[3], center[3], size = 0;
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        double least[width], most[width];
        for (std::uint32_t k = 0; k < width; ++k) {
          const double p = corners[axis][k], q = corners[3 + axis][k], r = corners[6 + axis][k];
          least[k] = std::min(std::min(p, q), r), most[k] = std::max(std::max(p, q), r);
        }
        low[axis] = *std::min_element(least, least + width), high[axis] = *std::max_element(most, most + width);
        center[axis] = 0.5 * low[axis] + 0.5 * high[axis];
        size = std::max({size, high[axis] - center[axis], center[axis] - low[axis]});
        node.low[end][axis][slot] = low[axis], node.high[end][axis][slot] = high[axis];
        moving.center[end][axis] = center[axis];
      }
      const double unit = unit_above(size), per_unit = 1 / unit;
      moving.unit[end] = unit;
      for (std::uint32_t i = 0; i < 9; ++i) {
        for (std::uint32_t k = 0; k < width; ++k) {
          moving.corner[end][i][k] = static_cast<float>((corners[i][k] - center[i % 3]) * per_unit);
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
