// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Fits the bounds of a tree bottom up: those of all nodes, or of dirty nodes and of the nodes above them.
//
// Based on  Slab cut balls [LarssonAkenineMoller2009]: a sphere cut by the slab that bounds its content.
// Differs   A box about the sphere's center cuts it, too.
//
// 1. fit_lowest_node(): a kernel fits the slots of a lowest node to the corners in its leaves, and a volume around all.
// 2. merge_slots(): another kernel merges the slots of a higher node into a volume around them.
// 3. store() puts either volume into the slot of the parent that stands for the node.
//
// fit_upper_node() does so for the children of one node, and thereby sets all of its slots; fit_whole_tree() for all
// nodes. refit_node() does so for one dirty node; if the slot in its parent has changed, the parent is dirty next.
//
// Node 0, the header, has one slot, the root slot, for the whole mesh; the child in it is node 1, the top node
// (bvh/tree.h). Slots below which all triangles coincide are marked: any one triangle answers for all of them.
// A lowest node's origin is a corner of a triangle below it; a higher node takes that of its first child. So origins
// are near what is relative to them: the difference of a position and an origin is small, and so is its rounding.
#include "bvh/refit.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/check.h"
#include "base/error_bounds.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/rounding.h"
#include "bvh/tree.h"
#include "simd/kernels.h"

namespace limber::bvh {
namespace {

// Fewer nodes are not worth a task: a guess, on which no answer depends.
constexpr std::size_t nodes_per_task = 16;

// A refitted node takes a new origin when its own is farther from its first child's than this multiple of its largest
// slot radius. At 64 radii, stored centers, of 24 bits, have lost 6 of them. Less would fit more nodes anew.
constexpr double tolerated_origin_distance = 64;

/// The sphere, box and slab of one slot (ChildBounds in layout/node.h says more), in float64, in units, relative to the
/// origin of some node.
struct Volume {
  Vec3 center, half;
  double radius;
  Vec3 normal;  // float32 numbers, as kernels give them: stored without rounding
  double low, high;
  double turn, side_low[2], side_high[2];  // SlabSides, as lengths
  bool is_elongated;

  bool operator==(const Volume&) const = default;
};

bool has_slot(std::uint32_t mask, std::uint32_t slot) { return (mask >> slot & 1) != 0; }
void mark(std::uint32_t& mask, std::uint32_t slot, bool is_marked) {
  mask = (mask & ~(1U << slot)) | (is_marked ? 1U << slot : 0U);
}

Vec3 vec3(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
Volume to_volume(const MergedBounds& b) {
  return {vec3(b.center),
          vec3(b.half),
          b.radius,
          vec3(b.normal),
          b.low,
          b.high,
          b.turn,
          {b.side_low[0], b.side_low[1]},
          {b.side_high[0], b.side_high[1]},
          b.is_elongated != 0};
}

Volume volume_of_slot(const Node& node, std::uint32_t k) {
  const ChildBounds& n = node.bounds;
  const Vec3 half{n.half_x[k], n.half_y[k], n.half_z[k]}, normal{n.normal_x[k], n.normal_y[k], n.normal_z[k]};
  const double step = static_cast<double>(n.radius[k]) / double{max_side};
  const auto side = [&](const std::int16_t(&steps)[width]) { return step * static_cast<double>(steps[k]); };
  const SlabSides& s = node.sides;
  return {local_slot_center(node, k),
          half,
          n.radius[k],
          normal,
          n.low[k],
          n.high[k],
          static_cast<double>(s.turn[k]),
          {side(s.low[0]), side(s.low[1])},
          {side(s.high[0]), side(s.high[1])},
          has_slot(node.elongated_slots, k)};
}

/// The radius of the root slot: that of a sphere about the center of `whole` around the slots of the top node's
/// children, or that of `whole` if it is smaller. `whole`, which is fitted to the top node's own slots, has a radius a
/// quarter too large on a model that is a ball. That matters because many queries end at the root slots of two models.
double root_radius(const Tree& tree, const Node& top, const Volume& whole) {
  double radius = 0;
  for (std::uint32_t k = 0; k < top.child_count; ++k) {
    const Node& child = tree.nodes[top.first_child + k];
    const Vec3 shift = (child.origin - top.origin) * (1 / tree.unit) - whole.center;
    for (std::uint32_t j = 0; j < child.child_count; ++j) {
      const Reach reach = reach_of(child.bounds, j, local_slot_center(child, j) + shift);
      // squares_up, 1 + 2^-20: stored normals have length 1 up to 4.5 * 2^-24 only, and heights are off by as much.
      radius = std::max(radius, std::min(reach.by_sphere, reach.by_slab * double{base::squares_up}));
    }
  }
  // Two kinds of rounding in float64. That of `radius` is in proportion to it: a factor. That of `shift` and of the
  // centers is in proportion to their lengths. These are at most that of whole.center plus the distances of origins,
  // which are at most 64 radii (tolerated_origin_distance) on each of up to 10 levels. A radius is at most sqrt(3)
  // halves: 10 * 64 * sqrt(3) < 1109 halves altogether. `outward` has room for 2^13 = 8192 roundings.
  const double rounding = (base::outward - 1) * (max_abs(whole.center) + max_abs(whole.half));
  return std::min(whole.radius, radius * base::outward + rounding);
}

/// Stores a volume, which is relative to `origin`, in a slot of a node, rounded outward.
void store(Node& node, std::uint32_t slot, const Vec3& origin, const Volume& volume, double per_unit) {
  const Vec3 offset = (origin - node.origin) * per_unit;
  const Vec3 center = offset + volume.center;
  const Vec3 stored{base::to_24_bits(center.x), base::to_24_bits(center.y), base::to_24_bits(center.z)};
  // An upper bound of the distance between the stored center and the volume's: no height over the center, radius or
  // half extent changes by more.
  const Vec3 off = center - stored;
  const double shift =
      (std::abs(off.x) + std::abs(off.y) + std::abs(off.z)) * base::outward + max_abs(offset) * base::offset_error;
  // At least x + shift, after rounding to float32.
  const auto grown = [&](double x) {
    return static_cast<float>(x + shift + (std::abs(x) + shift) * base::storage_error);
  };
  ChildBounds& n = node.bounds;
  n.center_x[slot] = static_cast<float>(stored.x);
  n.center_y[slot] = static_cast<float>(stored.y);
  n.center_z[slot] = static_cast<float>(stored.z);
  n.radius[slot] = grown(volume.radius);
  n.half_x[slot] = grown(volume.half.x), n.half_y[slot] = grown(volume.half.y), n.half_z[slot] = grown(volume.half.z);
  n.normal_x[slot] = static_cast<float>(volume.normal.x);
  n.normal_y[slot] = static_cast<float>(volume.normal.y);
  n.normal_z[slot] = static_cast<float>(volume.normal.z);
  // A height is a sum of terms as large as the radius, so its rounding is relative to that. -grown(-x) rounds x down.
  const double error = volume.radius * base::storage_error;
  n.low[slot] = -grown(-(volume.low - error)), n.high[slot] = grown(volume.high + error);
  const double per_step = double{max_side} / static_cast<double>(n.radius[slot]);
  // Two steps outward, one of them for rounding here, the other as SlabSides promises.
  const auto steps = [&](double x) {
    return static_cast<std::int16_t>(
        std::clamp(std::ceil((x + shift) * per_step) + 1, -double{max_quantized}, double{max_quantized}));
  };
  mark(node.elongated_slots, slot, volume.is_elongated);
  SlabSides& sides = node.sides;
  sides.turn[slot] = static_cast<std::int16_t>(volume.turn);
  for (std::size_t k = 0; k < 2; ++k) {
    sides.low[k][slot] = static_cast<std::int16_t>(-steps(-volume.side_low[k]));
    sides.high[k][slot] = steps(volume.side_high[k]);
  }
}

/// Sets the radius of a node: that of a sphere about its origin which contains the spheres of all its slots (invariant
/// I6 of bvh/tree.h).
void set_radius(Node& node) {
  double radius = 0;
  for (std::uint32_t k = 0; k < node.child_count; ++k) {
    radius = std::max(radius, length(local_slot_center(node, k)) + static_cast<double>(node.bounds.radius[k]));
  }
  node.radius = base::float_up(radius * base::outward);
}

/// The unit that suits a model with the bounds that the tree has now.
double unit_of_bounds(const Tree& tree) {
  const Node& header = tree.nodes[0];
  return unit_for(2 * tree.unit * length(volume_of_slot(header, 0).half), max_abs(header.origin));
}
/// Whether the unit of a tree is the one that suits its bounds up to a factor of `ratio`.
bool has_unit_within(const Tree& tree, double ratio) {
  const double unit = unit_of_bounds(tree);
  return unit <= ratio * tree.unit && tree.unit <= ratio * unit;
}

/// Fits the nodes of one tree to the positions of one mesh.
class Refitter {
 public:
  Refitter(Tree& tree, MeshView mesh) : tree_(tree), positions_(mesh.positions.data()), kernels_(simd::kernels()) {}

  bool is_lowest(std::uint32_t node) const { return node >= tree_.first_lowest_node(); }

  /// Fits the slots of a node above the lowest level. Children on the lowest level are fitted here first, as one kernel
  /// fits their slots and the volume around them; the slots of other children must have been fitted before.
  void fit_upper_node(Node& node, bool children_are_lowest) {
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      Node& child = tree_.nodes[node.first_child + k];
      base::prefetch(tree_.nodes[std::min<std::size_t>(node.first_child + k + 1, tree_.nodes.size() - 1)]);
      const Volume volume = children_are_lowest ? fit_lowest_node(child, leaves_from(child), wants_sides(node, k))
                                                : merge_slots(child, wants_sides(node, k));
      if (k == 0) node.origin = child.origin;
      store(node, k, child.origin, volume, 1 / tree_.unit);
      mark(node.coincident_slots, k, all_coincide(child, children_are_lowest));
    }
    set_radius(node);
  }

  void fit_whole_tree() {
    const std::size_t lowest_level = tree_.lowest_level();
    if (lowest_level == 0)
      fit_lowest_node(tree_.nodes[0], tree_.leaves, tree_.nodes[0].elongated_slots != 0);  // one leaf, below the header
    for (std::size_t level = lowest_level; level-- > 0;) {
      const std::uint32_t begin = tree_.level_begin[level], end = tree_.level_begin[level + 1];
      base::parallel_for(end - begin, nodes_per_task,
                         [&](std::size_t i) { fit_upper_node(tree_.nodes[begin + i], level + 1 == lowest_level); });
    }
  }

  /// Refits dirty node `i`, below which corners or slots have changed. The slots of a lowest node are fitted to its
  /// leaves. Those of a higher node were stored when its children were refitted; if it needs another origin,
  /// fit_upper_node() stores all of them again, for which it fits children on the lowest level once more. Then the
  /// parent's slot for the node is stored. Returns whether the parent is dirty now; the header has none: false.
  bool refit_node(std::uint32_t i) {
    const bool node_is_lowest = is_lowest(i);
    Node& node = tree_.nodes[i];
    if (!node_is_lowest && is_far_from_first_child(node)) {
      fit_upper_node(node, is_lowest(node.first_child));
    } else if (!node_is_lowest) {
      set_radius(node);
    }
    Node& parent = tree_.nodes[node_of(node.parent)];
    const std::uint32_t slot = slot_of(node.parent);
    const bool sides = node.elongated_slots != 0 || has_slot(parent.elongated_slots, slot);
    const Volume volume = node_is_lowest ? fit_lowest_node(node, leaves_of(node), sides) : merge_slots(node, sides);
    if (i == 0) return false;  // no slot stands for the header; where it is the lowest node, it is fitted now
    const Volume before = volume_of_slot(parent, slot);
    store(parent, slot, node.origin, volume, 1 / tree_.unit);
    const bool was_coincident = has_slot(parent.coincident_slots, slot);
    const bool is_coincident = all_coincide(node, node_is_lowest);
    mark(parent.coincident_slots, slot, is_coincident);
    // The radius of the root slot depends on the slots of the top node's children themselves.
    const bool counts_for_root_radius = &parent == top_node();
    // Triangles may move by too little to change their volume, and yet begin or cease to coincide with those elsewhere.
    const bool may_change_marks = was_coincident || is_coincident;
    return before != volume_of_slot(parent, slot) || counts_for_root_radius || may_change_marks;
  }

  /// Prefetches what the nodes after the i-th will need: leaves, then the position of one corner of every second
  /// triangle, as neighbors often share cache lines (docs/design/deforming.md). Always inlined, see base::prefetch().
  [[gnu::always_inline]] void prefetch(const std::vector<std::uint32_t>& nodes, std::size_t i) const {
    constexpr std::size_t leaves_ahead = 4, positions_ahead = 2;
    if (i + leaves_ahead < nodes.size()) {
      for (const Leaf& leaf : leaves_of(tree_.nodes[nodes[i + leaves_ahead]])) base::prefetch(leaf);
    }
    if (i + positions_ahead < nodes.size()) {
      for (const Leaf& leaf : leaves_of(tree_.nodes[nodes[i + positions_ahead]])) {
        for (std::uint32_t j = 0; j < width; j += 2) base::prefetch(positions_[leaf.vertices[j][2]].x);
      }
    }
  }

  /// Gives the tree another unit if the present one is off by more than `unit_ratio_until_fit`. Returns whether it has:
  /// then all has to be fitted. Bounds tell that the unit is off, but not by how much. They are enlarged by 2^-60
  /// units (base::smallest_corner_error), maybe far more than the model's size. So vertices are measured.
  bool change_unit_if_unfit(MeshView mesh) {
    if (has_unit_within(tree_, unit_ratio_until_fit)) return false;
    const double before = std::exchange(tree_.unit, bounding_box_of(mesh).unit());
    return tree_.unit != before;
  }

 private:
  /// Fits a lowest node and its leaves, which come first in `leaves`; those behind them are prefetched. Returns the
  /// volume around them all.
  Volume fit_lowest_node(Node& node, std::span<Leaf> leaves, bool sides) {
    return to_volume(kernels_.fit_leaves(positions_, tree_.unit, node, leaves, sides));
  }
  /// The leaves of a lowest node and of all nodes after it.
  std::span<Leaf> leaves_from(const Node& node) const { return std::span(tree_.leaves).subspan(node.first_child); }
  std::span<Leaf> leaves_of(const Node& node) const { return leaves_from(node).first(node.child_count); }

  /// The volume around the children of a node above the lowest level.
  Volume merge_slots(const Node& node, bool sides) const {
    Volume volume = to_volume(kernels_.merge_bounds(node, sides));
    if (&node == top_node()) volume.radius = root_radius(tree_, node, volume);
    return volume;
  }

  /// Whether sides are fitted to a child, or to all children: where one was elongated, and in a tree that is new.
  bool wants_sides(const Node& node, std::uint32_t k) const {
    return has_slot(node.elongated_slots, k) || tree_.nodes[node.first_child + k].elongated_slots != 0;
  }

  /// Whether all triangles below a node have the same three positions, corner by corner: then the parent's slot for the
  /// node is marked. Pre: the node is fitted, and the marks of its own slots are right.
  bool all_coincide(const Node& node, bool node_is_lowest) const {
    if (node_is_lowest) {
      // A cheap test that nearly always says no: quantized x of corner 0 in the first leaf, equal for equal corners.
      const std::int16_t(&row)[width] = tree_.leaves[node.first_child].corners.corner[0];
      if (!std::all_of(row, row + width, [&](std::int16_t x) { return x == row[0]; })) return false;
    } else if (node.coincident_slots != used_slots(node)) {
      return false;
    }
    // All triangles of a lowest node are compared; above, one stands for each slot, as all slots are marked coincident.
    const std::uint32_t compared = node_is_lowest ? width : 1;
    const auto& first = tree_.leaves[first_leaf_below(node, 0, node_is_lowest)].vertices[0];
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      const Leaf& leaf = tree_.leaves[first_leaf_below(node, k, node_is_lowest)];
      for (std::uint32_t j = 0; j < compared; ++j) {
        for (std::size_t c = 0; c < 3; ++c) {
          if (positions_[leaf.vertices[j][c]] != positions_[first[c]]) return false;
        }
      }
    }
    return true;
  }
  /// The index of the first leaf below a slot of a node.
  std::uint32_t first_leaf_below(const Node& node, std::uint32_t slot, bool node_is_lowest) const {
    if (node_is_lowest) return node.first_child + slot;
    return child_of(tree_, first_leaf_slot(tree_, (node.first_child + slot) * width));
  }

  /// The address of the top node. Only compared, because there is no such node if the mesh has one leaf.
  const Node* top_node() const { return tree_.nodes.data() + 1; }

  /// Whether stored centers lose precision: the origins of a node and of its first child were equal when the node was
  /// fitted, but now they are far apart.
  bool is_far_from_first_child(const Node& node) const {
    const ChildBounds& n = node.bounds;
    const float largest = *std::max_element(n.radius, n.radius + node.child_count);
    return max_abs(tree_.nodes[node.first_child].origin - node.origin) >
           tolerated_origin_distance * tree_.unit * static_cast<double>(largest);
  }

  Tree& tree_;
  const Vec3* positions_;
  const simd::Kernels& kernels_;
};

}  // namespace

// Unlike change_unit_if_unfit(), a rebuild can take the unit from the bounds: every refit leaves one that suits them up
// to 2^20 (unit_ratio_until_fit). So what they are enlarged by is about 2^-40 of their size or less.
double unit_for_rebuild(const Tree& tree) {
  return has_unit_within(tree, unit_ratio_until_rebuild) ? tree.unit : unit_of_bounds(tree);
}

void fit(Tree& tree, MeshView mesh) {
  LIMBER_ASSERT(tree.level_begin.size() >= 2);
  Refitter refitter(tree, mesh);
  refitter.fit_whole_tree();
  if (refitter.change_unit_if_unfit(mesh)) refitter.fit_whole_tree();
  LIMBER_ASSERT(std::isfinite(tree.nodes[0].bounds.radius[0]));
}

void fit_upper_node(Tree& tree, MeshView mesh, std::uint32_t node) {
  LIMBER_ASSERT(node < tree.first_lowest_node());
  Refitter refitter(tree, mesh);
  tree.nodes[node].elongated_slots = used_slots(tree.nodes[node]);
  refitter.fit_upper_node(tree.nodes[node], refitter.is_lowest(tree.nodes[node].first_child));
}

bool refit_node(Tree& tree, MeshView mesh, std::uint32_t node) { return Refitter(tree, mesh).refit_node(node); }

std::uint64_t refit(Tree& tree, MeshView mesh, DirtySet& dirty) {
  if (dirty.covers_most_of(tree)) {
    dirty.add_all();  // fit() may throw half-way: then all is still to be done
    fit(tree, mesh);
    dirty.clear();
    return tree.nodes.size();
  }
  Refitter refitter(tree, mesh);
  std::uint64_t refitted = 0;
  dirty.sort_lowest();
  for (std::size_t level = tree.lowest_level() + 1; level-- > 0;) {
    const std::vector<std::uint32_t>& nodes = dirty.nodes(level);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (level == tree.lowest_level()) refitter.prefetch(nodes, i);
      const std::uint32_t node = nodes[i];
      ++refitted;
      if (refitter.refit_node(node)) dirty.add_node(level - 1, node_of(tree.nodes[node].parent));
    }
  }
  if (refitter.change_unit_if_unfit(mesh)) {
    dirty.add_all();
    fit(tree, mesh);
    refitted += tree.nodes.size();
  }
  dirty.clear();
  return refitted;
}

}  // namespace limber::bvh
