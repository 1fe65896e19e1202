// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Slab cut balls [LarssonAkenineMoller2009]: a sphere cut by the slab that bounds its content.
// Differs   A box shares the center. The two lowest levels are fitted to corners, the levels above to the bounds below.
//           The origin of a node is a corner below it, so differences of origins and corners are as exact as they
//           are small, wherever the mesh is.
#include "bvh/refit.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/check.h"
#include "base/error_bounds.h"
#include "base/parallel.h"
#include "base/prefetch.h"
#include "base/rounding.h"
#include "bvh/partition.h"
#include "bvh/reach.h"
#include "simd/kernels.h"

namespace limber::bvh {
namespace {

using base::outward;

// Fewer nodes are not worth a task.
constexpr std::size_t nodes_per_task = 16;

// A unit may be this factor too large or too small before a rebuild of the tree writes it in another one, and before
// the whole tree is fitted in another one at once. Float32 has the digits for more: all that it costs is bounds of tiny
// gaps.
constexpr double good_unit_ratio = 0x1p10, tolerated_unit_ratio = 0x1p20;

// An origin may be this multiple of the largest child's radius away from its node's first child.
constexpr double tolerated_origin_distance = 64;

/// The bounding volume of everything below a node, in units, relative to an origin.
struct Volume {
  Vec3 center, half;
  double radius;
  Vec3 normal;  // entries are float32 numbers
  double low, high;

  bool operator==(const Volume&) const = default;
};

Vec3 to_24_bits(const Vec3& v) { return {base::to_24_bits(v.x), base::to_24_bits(v.y), base::to_24_bits(v.z)}; }

Vec3 vec3(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

Volume from(const MergedBounds& b) { return {vec3(b.center), vec3(b.half), b.radius, vec3(b.normal), b.low, b.high}; }

Volume volume_of_slot(const Node& node, std::uint32_t k) {
  const ChildBounds& n = node.bounds;
  return {local_slot_center(node, k),
          {n.half_x[k], n.half_y[k], n.half_z[k]},
          n.radius[k],
          {n.normal_x[k], n.normal_y[k], n.normal_z[k]},
          n.low[k],
          n.high[k]};
}

/// The radius of the root's sphere, fitted to the volumes two levels below the root; `node` has the root's children. A
/// sphere around spheres around spheres is a quarter too large on a model that is a ball, and many queries end at the
/// roots.
double root_radius(const Tree& tree, const Node& node, const Volume& root) {
  double radius = 0;
  for (std::uint32_t k = 0; k < node.child_count; ++k) {
    const Node& child = tree.nodes[node.first_child + k];
    const Vec3 shift = (child.origin - node.origin) * (1 / tree.unit) - root.center;
    for (std::uint32_t j = 0; j < child.child_count; ++j) {
      const Reach reach = reach_of(child.bounds, j, local_slot_center(child, j) + shift);
      radius = std::max(radius, std::min(reach.by_sphere, reach.by_slab * double{base::squares_up}));
    }
  }
  return std::min(root.radius, radius * outward + (outward - 1) * (max_abs(root.center) + max_abs(root.half)));
}

/// Stores a volume, which is relative to `origin`, in a slot, rounded outward.
void store(Node& node, std::uint32_t slot, const Vec3& origin, const Volume& b, double per_unit) {
  const Vec3 offset = (origin - node.origin) * per_unit;
  const Vec3 center = offset + b.center, stored = to_24_bits(center);
  // At least the distance of the stored center from the volume's.
  const Vec3 off = center - stored;
  const double shift =
      (std::abs(off.x) + std::abs(off.y) + std::abs(off.z)) * outward + max_abs(offset) * base::offset_error;
  // By more than rounding to float32 takes away.
  const auto grown = [&](double x) {
    return static_cast<float>(x + shift + (std::abs(x) + shift) * base::storage_error);
  };
  ChildBounds& n = node.bounds;
  n.center_x[slot] = static_cast<float>(stored.x);
  n.center_y[slot] = static_cast<float>(stored.y);
  n.center_z[slot] = static_cast<float>(stored.z);
  n.radius[slot] = grown(b.radius);
  n.half_x[slot] = grown(b.half.x), n.half_y[slot] = grown(b.half.y), n.half_z[slot] = grown(b.half.z);
  n.normal_x[slot] = static_cast<float>(b.normal.x);
  n.normal_y[slot] = static_cast<float>(b.normal.y);
  n.normal_z[slot] = static_cast<float>(b.normal.z);
  // The slab's heights are rounded relative to the sphere, not to themselves.
  const double error = b.radius * base::storage_error;
  n.low[slot] = -grown(error - b.low), n.high[slot] = grown(error + b.high);
}

void find_radius(Node& node) {
  double radius = 0;
  for (std::uint32_t k = 0; k < node.child_count; ++k) {
    radius = std::max(radius, length(local_slot_center(node, k)) + static_cast<double>(node.bounds.radius[k]));
  }
  node.radius = base::float_up(radius * outward);
}

/// The unit for a model of the size of the root's bounds.
double unit_of_bounds(const Tree& tree) {
  const Volume root = volume_of_slot(tree.nodes[0], 0);
  return unit_for(2 * tree.unit * length(root.half), max_abs(tree.nodes[0].origin));
}
/// Whether the unit of a tree is at most so many times larger or smaller than that.
bool has_unit_within(const Tree& tree, double ratio) {
  const double unit = unit_of_bounds(tree);
  return unit <= ratio * tree.unit && tree.unit <= ratio * unit;
}

class Refitter {
 public:
  Refitter(Tree& tree, MeshView mesh)
      : tree_(tree),
        lowest_level_(tree.level_begin.size() - 2),
        positions_(mesh.positions.data()),
        kernels_(simd::kernels()) {}

  std::size_t lowest_level() const { return lowest_level_; }
  bool is_lowest(std::uint32_t node) const { return node >= tree_.first_lowest_node(); }

  /// Fits a node above the lowest level. Its children must have been fitted, unless they are on the lowest level.
  void fit_upper(Node& node, bool children_are_lowest) const {
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      Node& child = tree_.nodes[node.first_child + k];
      base::prefetch(tree_.nodes[std::min<std::size_t>(node.first_child + k + 1, tree_.nodes.size() - 1)]);
      const Volume volume = children_are_lowest ? fit_lowest(child, leaves_from(child)) : merge(child);
      if (k == 0) node.origin = child.origin;
      store(node, k, child.origin, volume, 1 / tree_.unit);
      mark_coincident(node, k, is_coincident(child, children_are_lowest));
    }
    find_radius(node);
  }

  /// Fits the whole tree, bottom up.
  void fit_all() const {
    if (lowest_level_ == 0) fit_lowest(tree_.nodes[0], tree_.leaves);
    for (std::size_t level = lowest_level_; level-- > 0;) {
      const std::uint32_t begin = tree_.level_begin[level], end = tree_.level_begin[level + 1];
      base::parallel_for(end - begin, nodes_per_task,
                         [&](std::size_t i) { fit_upper(tree_.nodes[begin + i], level + 1 == lowest_level_); });
    }
  }

  /// Fits a node whose corners or children have changed, and the slot of its parent that stands for it. Returns whether
  /// that slot has changed, so that the parent has to be fitted too.
  bool refit(std::uint32_t n) const {
    const bool node_is_lowest = is_lowest(n);
    Node& node = tree_.nodes[n];
    if (!node_is_lowest) {
      if (is_far_from_first_child(node)) {
        fit_upper(node, is_lowest(node.first_child));
      } else {
        find_radius(node);
      }
    }
    const Volume volume = node_is_lowest ? fit_lowest(node, leaves_of(node)) : merge(node);
    if (n == 0) return false;
    Node& parent = tree_.nodes[node_of(node.parent)];
    const std::uint32_t slot = slot_of(node.parent);
    const Volume before = volume_of_slot(parent, slot);
    store(parent, slot, node.origin, volume, 1 / tree_.unit);
    const bool was_coincident = (parent.coincident_slots >> slot & 1) != 0,
               is_now = is_coincident(node, node_is_lowest);
    mark_coincident(parent, slot, is_now);
    // The root's radius also depends on the slots two levels below it. Coincident triangles may have moved too little
    // to change the bounds, and yet no longer coincide with those beside them.
    return before != volume_of_slot(parent, slot) || &parent == node_of_root() || was_coincident || is_now;
  }

  /// Prefetches what the nodes after the i-th will need: leaves, then positions. Always inlined, see base::prefetch().
  [[gnu::always_inline]] void prefetch(const std::vector<std::uint32_t>& nodes, std::size_t i) const {
    constexpr std::size_t leaves_ahead = 4, positions_ahead = 2;
    if (i + leaves_ahead < nodes.size()) {
      for (const Leaf& leaf : leaves_of(tree_.nodes[nodes[i + leaves_ahead]])) base::prefetch(leaf);
    }
    if (i + positions_ahead < nodes.size()) {
      for (const Leaf& leaf : leaves_of(tree_.nodes[nodes[i + positions_ahead]])) {
        for (std::uint32_t j = 0; j < width; j += 2) __builtin_prefetch(&positions_[leaf.vertices[j][2]]);
      }
    }
  }

  /// Gives the tree another unit if the model has become far larger or smaller than the present one. Returns whether it
  /// did. The bounds are enough to notice that; once a model has shrunk by more than 2^60 they no longer tell its size,
  /// so the new unit is measured from the vertices.
  bool adapts_unit(MeshView mesh) const {
    if (has_unit_within(tree_, tolerated_unit_ratio)) return false;
    const double before = std::exchange(tree_.unit, bounding_box_of(mesh).unit());
    return tree_.unit != before;
  }

 private:
  /// Fits a node of the lowest level and its leaves; after these, `leaves` has those that will be fitted next.
  Volume fit_lowest(Node& node, std::span<Leaf> leaves) const {
    return from(kernels_.fit_leaves(positions_, tree_.unit, node, leaves));
  }
  /// The leaves of a node of the lowest level, and of those after it.
  std::span<Leaf> leaves_from(const Node& node) const { return std::span(tree_.leaves).subspan(node.first_child); }
  std::span<Leaf> leaves_of(const Node& node) const { return leaves_from(node).first(node.child_count); }

  /// The volume around the children of a node above the lowest level.
  Volume merge(const Node& node) const {
    Volume volume = from(kernels_.merge_bounds(node));
    if (&node == node_of_root()) volume.radius = root_radius(tree_, node, volume);
    return volume;
  }

  static void mark_coincident(Node& node, std::uint32_t slot, bool is) {
    node.coincident_slots = (node.coincident_slots & ~(1U << slot)) | (is ? 1U << slot : 0U);
  }

  /// Whether all triangles below a node have equal corners, in order. The marks of the node itself must be right.
  bool is_coincident(const Node& node, bool node_is_lowest) const {
    if (node_is_lowest) {
      // Quantized corners nearly always differ at once.
      const std::int16_t(&row)[width] = tree_.leaves[node.first_child].corners.corner[0];
      if (!std::all_of(row, row + width, [&](std::int16_t x) { return x == row[0]; })) return false;
    } else if (node.coincident_slots != (1U << node.child_count) - 1) {
      return false;
    }
    const auto& first = tree_.leaves[first_leaf(node, 0, node_is_lowest)].vertices[0];
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      const Leaf& leaf = tree_.leaves[first_leaf(node, k, node_is_lowest)];
      for (std::uint32_t j = 0; j < (node_is_lowest ? width : 1); ++j) {
        for (std::size_t c = 0; c < 3; ++c) {
          if (positions_[leaf.vertices[j][c]] != positions_[first[c]]) return false;
        }
      }
    }
    return true;
  }
  /// The first leaf below a slot of a node.
  std::uint32_t first_leaf(const Node& node, std::uint32_t slot, bool node_is_lowest) const {
    if (node_is_lowest) return node.first_child + slot;
    const SlotId leaf = first_leaf_slot(tree_, (node.first_child + slot) * width);
    return tree_.nodes[node_of(leaf)].first_child;
  }

  /// The node that has the children of the root.
  const Node* node_of_root() const { return &tree_.nodes[1]; }

  /// Whether the first child has moved so far from the origin that the node took from it that stored centers lose
  /// precision.
  bool is_far_from_first_child(const Node& node) const {
    const ChildBounds& n = node.bounds;
    const float largest = *std::max_element(n.radius, n.radius + node.child_count);
    return max_abs(tree_.nodes[node.first_child].origin - node.origin) >
           tolerated_origin_distance * tree_.unit * static_cast<double>(largest);
  }

  Tree& tree_;
  std::size_t lowest_level_;
  const Vec3* positions_;
  const simd::Kernels& kernels_;
};

}  // namespace

double unit_for(double size, double magnitude) {
  LIMBER_ASSERT(std::isfinite(size) && std::isfinite(magnitude));
  constexpr double magnitude_resolved = 0x1p-50, smallest_unit = 0x1p-900;
  int exponent = 0;
  const double fraction = std::frexp(std::max({size, magnitude_resolved * magnitude, smallest_unit}), &exponent);
  return std::ldexp(1, fraction == 0.5 ? exponent - 1 : exponent);
}

double better_unit(const Tree& tree) {
  return has_unit_within(tree, good_unit_ratio) ? tree.unit : unit_of_bounds(tree);
}

void fit(Tree& tree, MeshView mesh) {
  LIMBER_ASSERT(tree.level_begin.size() >= 2);
  const Refitter refitter(tree, mesh);
  refitter.fit_all();
  if (refitter.adapts_unit(mesh)) refitter.fit_all();
  LIMBER_ASSERT(std::isfinite(tree.nodes[0].bounds.radius[0]));
}

void fit_children(Tree& tree, MeshView mesh, std::uint32_t node) {
  LIMBER_ASSERT(node < tree.first_lowest_node());
  const Refitter refitter(tree, mesh);
  refitter.fit_upper(tree.nodes[node], refitter.is_lowest(tree.nodes[node].first_child));
}

bool refit_node(Tree& tree, MeshView mesh, std::uint32_t node) { return Refitter(tree, mesh).refit(node); }

std::uint64_t refit(Tree& tree, MeshView mesh, DirtySet& dirty) {
  if (dirty.covers_most_of(tree)) {
    dirty.add_all();  // in case fit() throws
    fit(tree, mesh);
    dirty.clear();
    return tree.nodes.size();
  }
  const Refitter refitter(tree, mesh);
  std::uint64_t refitted = 0;
  dirty.sort_lowest();
  for (std::size_t level = refitter.lowest_level() + 1; level-- > 0;) {
    const std::vector<std::uint32_t>& nodes = dirty.nodes(level);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (level == refitter.lowest_level()) refitter.prefetch(nodes, i);
      const std::uint32_t node = nodes[i];
      ++refitted;
      if (refitter.refit(node)) dirty.add_node(level - 1, node_of(tree.nodes[node].parent));
    }
  }
  if (refitter.adapts_unit(mesh)) {
    dirty.add_all();
    fit(tree, mesh);
    refitted += tree.nodes.size();
  }
  dirty.clear();
  return refitted;
}

}  // namespace limber::bvh
