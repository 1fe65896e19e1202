// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/check.h"
#include "base/error_bounds.h"
#include "base/memory.h"
#include "geometry/local_frame.h"
#include "layout/node.h"
#include "limber/base.h"
#include "limber/math.h"
#include "limber/mesh.h"
#include "simd/kernels.h"

/// The unit of a tree: the length that 1 stands for in the float32 numbers of its nodes. A power of two near the
/// model's size, so that dividing by it is exact.
///
/// Too small a unit brings numbers near base::max_units = 2^60, beyond which float32 cannot square them. Too large a
/// unit costs speed only: bounds have an absolute error of 2^-60 units (base::smallest_corner_error), which prunes
/// nothing where gaps are smaller. Between the two there is room, so the unit follows the model's size late.
namespace limber::bvh {

/// By which factor the unit may be too large or too small before the next rebuild chooses another, which costs nothing.
inline constexpr double unit_ratio_until_rebuild = 0x1p10;

/// By which factor it may be too large or too small after a refit before the whole tree is fitted in another unit.
inline constexpr double unit_ratio_until_fit = 0x1p20;

/// How many units vertices may move between two refits before the unit is chosen anew ahead of the refit: 2^20 and this
/// many together stay far below base::max_units.
inline constexpr double units_moved_until_fit = 0x1p40;

/// The smallest power of two that is at least `size`, the size of a mesh whose coordinates are about `magnitude`; but
/// at least 2^-50 of the magnitude, since float64 resolves only 2^-53 of it, and at least 2^-900.
double unit_for(double size, double magnitude);

/// The bounding box of some triangles.
class BoundingBox {
 public:
  void add(const Triangle& t) {
    low_ = min(low_, min(min(t.v0, t.v1), t.v2));
    high_ = max(high_, max(max(t.v0, t.v1), t.v2));
  }
  void add(const BoundingBox& other) {
    low_ = min(low_, other.low_);
    high_ = max(high_, other.high_);
  }
  Vec3 center() const { return low_ * 0.5 + high_ * 0.5; }
  /// The unit of a tree over these triangles.
  double unit() const {
    const double size = length(high_ - low_);
    // Squares of very small sides underflow; twice the longest side is at least the diagonal.
    return unit_for(size > 0x1p-450 ? size : 2 * max_abs(high_ - low_), max_abs(low_));
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low_{infinity, infinity, infinity}, high_{-infinity, -infinity, -infinity};
};

/// The bounding box of a mesh, on the threads of the calling oneTBB arena; equal on any number of them. Allocates
/// nothing.
BoundingBox bounding_box_of(MeshView mesh);

/// The hierarchy of a mesh: a BVH with up to eight children a node. Nodes lie level by level, so siblings are adjacent;
/// all leaves are children of the lowest level. A node stores the bounding volumes of its children, each in a child
/// slot. The volume around the node itself is in a slot of its parent.
///
/// So the volume of the whole mesh needs a node above the root: node 0, the header. Its only slot, `root_slot`, bounds
/// the mesh. The child of that slot is node 1, the root, called top node; or leaf 0 if there is only one leaf.
///
/// Invariants, checked by validate():
///   I1  The header has one child. Every other node is the child of exactly one slot, one level up.
///   I2  Every leaf is the child of exactly one slot of the lowest level; every triangle is in exactly one leaf. The
///       triangles of a leaf are in ascending order, with the ids of their vertices. If the last leaf has fewer than
///       eight triangles, copies of its last triangle fill it up.
///   I3  The levels of nodes, with the header's, without the leaves, are ceil(log8(n)) for n triangles, but at least 1.
///   I4  The sphere, box, slab and sides of a slot contain every corner of every triangle below it, where it was
///       when bounds were last fitted to it: at its position at the last refit. It is at most `slack` away from there.
///   I5  A decoded quantized corner differs from the exact one by at most 0.52 quantization steps + 2^-51 times the
///       corner's largest coordinate, in each coordinate. All are in units, relative to the node's origin.
///   I6  `radius` of a node is at least the distance of its origin from every point of its children's spheres.
///   I7  All triangles below a slot that is marked coincident had equal corners, in equal order, at the last refit.

/// The nodes and leaves of a tree.
struct TreeGeometry {
  std::vector<Node> nodes;
  std::vector<Leaf, base::UninitializedAllocator<Leaf>> leaves;
  std::vector<std::uint32_t> level_begin;  // first node of each level, from the header's down; at the end nodes.size()
  double unit = 1;                         // the length that 1 stands for in nodes, see unit_for()

  std::size_t lowest_level() const { return level_begin.size() - 2; }
  /// The first node whose children are leaves. The children of all nodes after it are leaves, too.
  std::uint32_t first_lowest_node() const { return level_begin[lowest_level()]; }
};

/// The tree of a model whose vertices move.
struct Tree : TreeGeometry {
  std::uint64_t build_id = 0;  // names the assignment of triangles to leaves: another assignment gets another id
  double displacement = 0;     // upper bound of how far any vertex has moved since the tree got its build_id
  double slack = 0;            // upper bound of the distance of any vertex from its position at the last refit

  /// Swaps nodes, leaves and unit with another tree of this mesh, which has equal levels. Takes a new build id;
  /// `displacement`, which counts from then on, becomes 0.
  void exchange(TreeGeometry& other);
};

/// A child slot of a node: 8 * node + slot, with slot < 8. Stands for the child's bounding volume and subtree.
using SlotId = std::uint32_t;
/// The slot that bounds the whole mesh, the only one of node 0.
inline constexpr SlotId root_slot = 0;

/// The node that stores a slot, not the slot's child; child_of() is that.
inline std::uint32_t node_of(SlotId id) { return id / width; }
/// The index of a slot in its node, 0 to 7. Functions that take a node and a `slot` expect this index.
inline std::uint32_t slot_of(SlotId id) { return id % width; }

/// Center of a slot's volume, relative to the node's origin, in units.
inline Vec3 local_slot_center(const Node& node, std::uint32_t slot) {
  return {node.bounds.center_x[slot], node.bounds.center_y[slot], node.bounds.center_z[slot]};
}
/// Center of a slot's volume in the model frame. Products with the unit, a power of two, are exact; the sum is rounded,
/// by at most 2^-53 of each coordinate.
inline Vec3 slot_center(const Tree& tree, SlotId id) {
  const Node& node = tree.nodes[node_of(id)];
  return node.origin + tree.unit * local_slot_center(node, slot_of(id));
}

/// Whether the child of a slot is a leaf.
inline bool has_leaf(const Tree& tree, SlotId id) { return node_of(id) >= tree.first_lowest_node(); }
/// Whether all triangles below a slot coincided at the last refit.
inline bool is_coincident(const Tree& tree, SlotId id) {
  return (tree.nodes[node_of(id)].coincident_slots >> slot_of(id) & 1) != 0;
}
/// The index of a slot's child: in `leaves` if it has a leaf, else in `nodes`.
inline std::uint32_t child_of(const Tree& tree, SlotId id) { return tree.nodes[node_of(id)].first_child + slot_of(id); }
/// Pre: has_leaf().
inline const Leaf& leaf_of(const Tree& tree, SlotId id) { return tree.leaves[child_of(tree, id)]; }

/// Whether a slot need not be expanded: it has a leaf, or all triangles below it coincide now, so that any leaf below
/// stands for all. They may no longer coincide where vertices are away from their positions at the last refit.
inline bool has_leaf_or_coincides(const Tree& tree, SlotId id) {
  return has_leaf(tree, id) || (is_coincident(tree, id) && tree.slack == 0);
}

/// The slot of the first leaf below a slot.
inline SlotId first_leaf_slot(const Tree& tree, SlotId id) {
  while (!has_leaf(tree, id)) id = child_of(tree, id) * width;
  return id;
}

/// A leaf, with the slot whose child it is and the node that stores the slot: its corners are relative to
/// the slot's sphere.
struct LeafInNode {
  const Node& node;
  std::uint32_t slot;
  const Leaf& leaf;
};
/// The first leaf below a slot.
inline LeafInNode first_leaf(const Tree& tree, SlotId id) {
  const SlotId slot = first_leaf_slot(tree, id);
  return {tree.nodes[node_of(slot)], slot_of(slot), leaf_of(tree, slot)};
}

/// Builds the tree of a mesh: assigns triangles to leaves, and fits all bounds.
///
/// Cost     O(n log n), on the threads of the calling oneTBB arena; the same tree on any number of them.
Tree build(MeshView mesh);

/// Recomputes all bounds from the positions, and the unit if it no longer suits the model's size. The topology and the
/// assignment of triangles to leaves stay.
///
/// Cost     O(n), parallel as build().
void fit(Tree& tree, MeshView mesh);

/// The direction in the plane of a normal that SlabSides::turn stands for, up to some 30 u32: what the kernels compute
/// in float32.
Vec3 in_plane(const Vec3& normal, double turn);

/// Checks the invariants I1 to I7.
///
/// Errors   `broken_invariant`, naming the invariant's number and the node.
Result<void> validate(const Tree& tree, MeshView mesh);

/// A subtree and its leaves, those from `first_leaf` up to `end_leaf`.
struct Subtree {
  SlotId slot;
  std::uint32_t first_leaf, end_leaf;
};

inline Subtree subtree_of(const Tree& tree, SlotId slot) {
  LIMBER_ASSERT(slot_of(slot) < tree.nodes[node_of(slot)].child_count);
  SlotId first = slot, last = slot;
  while (node_of(first) < tree.first_lowest_node()) {
    first = (tree.nodes[node_of(first)].first_child + slot_of(first)) * width;
    const std::uint32_t node = tree.nodes[node_of(last)].first_child + slot_of(last);
    last = node * width + tree.nodes[node].child_count - 1;
  }
  return {slot, tree.nodes[node_of(first)].first_child + slot_of(first),
          tree.nodes[node_of(last)].first_child + slot_of(last) + 1};
}

/// Bounds of a whole model, by the root slot of its tree.

inline double sum_of_coordinates(const Vec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// Radius of a sphere around the model, about the center of its root slot.
inline double root_radius(const Tree& tree) {
  return tree.unit * static_cast<double>(tree.nodes[0].bounds.radius[0]) + tree.slack;
}

/// A lower bound of the distance of a point from a model, by the box or the slab of its root slot. The point is
/// relative to that slot's center, in the model's frame.
inline double root_gap(const Tree& tree, const Vec3& point) {
  const ChildBounds& n = tree.nodes[0].bounds;
  const Vec3 out = max(abs(point) - tree.unit * Vec3{n.half_x[0], n.half_y[0], n.half_z[0]}, Vec3{});
  const double height = dot(Vec3{n.normal_x[0], n.normal_y[0], n.normal_z[0]}, point);
  const double above = height - tree.unit * static_cast<double>(n.high[0]);
  const double below = tree.unit * static_cast<double>(n.low[0]) - height;
  return std::max({geometry::safe_length(out), above, below}) - tree.slack;
}

/// An upper bound of the distance of any point of the placed model from the world's origin.
inline double magnitude(const Tree& tree, const Transform& pose) {
  // A model that has moved far may be many radii away from the origin of its header node.
  const double from_origin = tree.unit * static_cast<double>(tree.nodes[0].radius) + tree.slack;
  return sum_of_coordinates(pose.translation) +
         (sum_of_coordinates(tree.nodes[0].origin) + std::max(2 * root_radius(tree), from_origin)) * base::magnitude_up;
}

/// At least the distance from a point of anything in a volume, in units, up to rounding in float64: by its sphere; by
/// its slab and the sphere across that. The kernel merge_bounds has the same for eight volumes at once.
struct Reach {
  double by_sphere, by_slab;
};

/// The reach of the volume of a slot whose center is at `d` from the point.
inline Reach reach_of(const ChildBounds& n, std::uint32_t slot, const Vec3& d) {
  const double radius = n.radius[slot], low = n.low[slot], high = n.high[slot];
  const double height = dot(Vec3{n.normal_x[slot], n.normal_y[slot], n.normal_z[slot]}, d), d_sq = length_sq(d);
  const double along = std::max(std::abs(height + low), std::abs(height + high));
  const double across_sq = std::max(0.0, d_sq - height * height) + d_sq * double{base::across_error};
  const double across = std::sqrt(across_sq) + radius;
  return {std::sqrt(d_sq) + radius, std::sqrt(along * along + across * across)};
}

/// The bounds of a model whose vertices go from one position each to another: the topology is that of its tree.
///
/// A box whose corners are interpolated contains, at every time, what it contains at both ends: each coordinate of a
/// vertex is between two numbers that are interpolated as it is.
struct MovingTree {
  std::vector<MovingNode, base::UninitializedAllocator<MovingNode>> nodes;
  std::vector<MovingLeaf, base::UninitializedAllocator<MovingLeaf>> leaves;
};

/// Fits all bounds to vertices that go from `start` to `end`, both in the world. The tree's own bounds do not matter.
///
/// Cost     O(n), on the threads of the calling oneTBB arena; the same bounds on any number of them.
void fit(MovingTree& moving, const Tree& tree, std::span<const Vec3> start, std::span<const Vec3> end);

/// The child slots of one tree that a depth-first search has still to take, the nearest last.
class SlotStack {
 public:
  struct Entry {
    float bound;  // in the measure of the kernel
    SlotId slot;
    std::uint32_t siblings;  // where the entries of its siblings begin
  };

  void start(float bound_of_root) { entries_[0] = {bound_of_root, root_slot, 0}, count_ = 1; }

  /// Takes the next slot whose bound is at most the limit, and drops those before it. False if no slot is left.
  bool take(float limit, Entry& next) {
    while (count_ > 0) {
      next = entries_[count_ - 1];
      if (next.bound <= limit) {
        --count_;
        return true;
      }
      count_ = next.siblings;  // which are no nearer
    }
    return false;
  }

  /// Adds the children of a node that a kernel has kept, the nearest last.
  void add(std::uint32_t node, const simd::ChildrenInOrder& children) {
    LIMBER_ASSERT(count_ + width <= capacity);
    const std::uint32_t first = count_;
    for (std::uint32_t k = 0; k < width; ++k) {
      entries_[first + children.place_of(k)] = {children.bound[k], node * width + k, first};
    }
    count_ += static_cast<std::uint32_t>(std::popcount(children.kept));
  }
  /// Adds children of a node, as a bit mask, whose bounds are 0.
  void add(std::uint32_t node, unsigned slots) {
    LIMBER_ASSERT(count_ + width <= capacity);
    for (const std::uint32_t first = count_; slots != 0; slots &= slots - 1) {
      entries_[count_++] = {0, node * width + static_cast<std::uint32_t>(std::countr_zero(slots)), first};
    }
  }

 private:
  // Every slot taken adds less than `width` more and goes one level down, of at most 11 (2^32 triangles).
  static constexpr std::uint32_t capacity = 96;

  std::uint32_t count_ = 0;
  Entry entries_[capacity];
};

}  // namespace limber::bvh
