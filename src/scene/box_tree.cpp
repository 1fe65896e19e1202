// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Eight boxes a node, over models in spatial order. The rank of a model is its place in that order: leaf i, the i-th
// node of the lowest level, holds ranks 8 i to 8 i + 7, and the k-th child of node i of a level is node 8 i + k below.
// build() fills the levels from below. visit_near() goes down from the top with the bounds of something else;
// visit_pairs() with the box of a leaf, to itself and the leaves after it. u is 2^-53.
#include "scene/box_tree.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "base/arguments.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/rounding.h"
#include "simd/kernels.h"

namespace limber::scene {
namespace {

using bvh::BoxNode;
using bvh::width;

constexpr int bits_of_width = std::countr_zero(unsigned{width});

// The factor leaves 32 u; 10 u are needed: a squared length of differences is off by 5 u, the square of a sum of three
// by 5 u.
constexpr double squared_length_down = 1 - 0x1p-48;
// The factor leaves 8 u; 2 u are needed: for the sum of two radii, and for its product with this.
constexpr double radii_up = 1 + 0x1p-50;

/// Boxes that meet no finite box; so margins have to be finite.
BoxNode empty_boxes() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  BoxNode boxes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::fill_n(boxes.low[axis], width, infinity);
    std::fill_n(boxes.high[axis], width, -infinity);
  }
  return boxes;
}

void set_box(BoxNode& boxes, std::size_t slot, const Box& box) {
  boxes.low[0][slot] = box.low.x, boxes.low[1][slot] = box.low.y, boxes.low[2][slot] = box.low.z;
  boxes.high[0][slot] = box.high.x, boxes.high[1][slot] = box.high.y, boxes.high[2][slot] = box.high.z;
}

Box box_of(const BoxNode& boxes, std::size_t slot) {
  return {{boxes.low[0][slot], boxes.low[1][slot], boxes.low[2][slot]},
          {boxes.high[0][slot], boxes.high[1][slot], boxes.high[2][slot]}};
}

/// The smallest box around some boxes.
Box box_around(const BoxNode& boxes) {
  Box box = box_of(boxes, 0);
  for (std::size_t slot = 1; slot < width; ++slot) {
    const Box next = box_of(boxes, slot);
    box = {min(box.low, next.low), max(box.high, next.high)};
  }
  return box;
}

/// The boxes that may be within the margin of another one: a bit mask.
unsigned boxes_near(const BoxNode& boxes, const Box& box, double margin) {
  const Vec3 by{margin, margin, margin};
  return simd::kernels().overlapping_boxes(boxes, box.low - by, box.high + by);
}

/// Whether a distance, given by its square, may be at most a limit, which is not squared. Squares below 2^-900 may have
/// underflowed, and prove nothing.
bool may_be_at_most(double distance_sq, double limit) {
  return distance_sq * squared_length_down <= limit * limit + base::tiny_square;
}
bool may_be_near(const Sphere& a, const Sphere& b, double margin) {
  return may_be_at_most(length_sq(b.center - a.center), a.radius + b.radius + margin);
}
bool may_be_near(const Box& a, const Box& b, double margin) { return may_be_at_most(length_sq(gaps(a, b)), margin); }

}  // namespace

void BoxTree::build(std::span<const std::uint32_t> ids, std::span<const WorldBounds> bounds) {
  LIMBER_ASSERT(ids.size() < no_id);
  centers_.resize(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) centers_[i] = bounds[ids[i]].sphere.center;
  const std::span<const std::uint32_t> order = spatial_order_.sort(centers_);

  level_begin_.assign(1, 0);
  // Every level has an eighth of the boxes below, until one node holds all. One model has a level too, none has none.
  for (std::size_t boxes_below = ids.size(); boxes_below > 0;) {
    const std::size_t nodes = (boxes_below + width - 1) / width;
    level_begin_.push_back(level_begin_.back() + nodes);
    boxes_below = nodes > 1 ? nodes : 0;
  }
  LIMBER_ASSERT(level_count() <= 11);  // 2^32 models: 8^11 = 2^33
  boxes_.resize(level_begin_.back());
  spheres_.resize(ids.size());
  ids_.resize(ids.size());
  // Only the last node of a level may be partly filled.
  for (std::size_t level = 0; level < level_count(); ++level) boxes_[level_begin_[level + 1] - 1] = empty_boxes();
  for (std::uint32_t rank = 0; rank < size(); ++rank) {
    ids_[rank] = ids[order[rank]];
    const WorldBounds& model = bounds[ids_[rank]];
    spheres_[rank] = model.sphere;
    set_box(boxes_[rank / width], rank % width, model.box);
  }
  for (std::size_t level = 1; level < level_count(); ++level) {
    const std::size_t begin = level_begin_[level], begin_below = level_begin_[level - 1];
    for (std::size_t i = 0; begin_below + i < begin; ++i) {
      set_box(boxes_[begin + i / width], i % width, box_around(boxes_[begin_below + i]));
    }
  }
}

bool BoxTree::may_be_within(std::uint32_t rank_a, std::uint32_t rank_b, double margin) const {
  LIMBER_ASSERT(rank_a < size() && rank_b < size());
  // The spheres first: most pairs then need no boxes, which are not stored one by one.
  return may_be_near(spheres_[rank_a], spheres_[rank_b], margin) &&
         may_be_near(bounds_of(rank_a).box, bounds_of(rank_b).box, margin);
}

WorldBounds BoxTree::bounds_of(std::uint32_t rank) const {
  LIMBER_ASSERT(rank < size());
  return {box_of(boxes_[rank / width], rank % width), spheres_[rank]};
}

double lower_bound(const WorldBounds& a, const WorldBounds& b) {
  const double of_spheres =
      base::distance_down(a.sphere.center, b.sphere.center) - (a.sphere.radius + b.sphere.radius) * radii_up;
  const double of_boxes = base::distance_down({}, gaps(a.box, b.box));
  // The factor covers the subtraction too: it takes 1024 u of the difference away, which is off by 1 u of itself.
  return std::max(of_spheres, of_boxes) * (1 - base::scene_distance_error);
}

bool BoxTree::visit_near(const WorldBounds& bounds, double margin, FunctionRef<bool(std::uint32_t)> visit) const {
  LIMBER_ASSERT(base::is_finite_and_not_negative(margin));
  return size() == 0 || visit_near_below(level_count() - 1, 0, bounds, margin, visit);
}

bool BoxTree::visit_near_below(std::size_t level, std::uint32_t node, const WorldBounds& own, double margin,
                               FunctionRef<bool(std::uint32_t)> visit) const {
  LIMBER_ASSERT(level < level_count());
  unsigned waiting = boxes_near(boxes(level, node), own.box, margin);
  for (; waiting != 0; waiting &= waiting - 1) {
    const std::uint32_t child = node * width + static_cast<std::uint32_t>(std::countr_zero(waiting));
    if (level > 0) {
      if (!visit_near_below(level - 1, child, own, margin, visit)) return false;
      continue;
    }
    const WorldBounds bounds = bounds_of(child);
    const bool is_near = may_be_near(own.sphere, bounds.sphere, margin) && may_be_near(own.box, bounds.box, margin);
    if (is_near && !visit(child)) return false;
  }
  return true;
}

/// Pairs of a model of one leaf and a model of the same or a later one. They are collected before they are visited:
/// every pair is written, but the count only goes up after one that is near, so the loop needs no branch for that.
class BoxTree::PairCollector {
 public:
  PairCollector(const BoxTree& tree, std::uint32_t leaf, double margin,
                FunctionRef<bool(std::uint32_t, std::uint32_t)> visit)
      : tree_(tree), leaf_(leaf), margin_(margin), visit_(visit), around_(box_of_leaf(leaf)) {}

  /// Adds the pairs with models below a node, children in order. Returns whether the walk goes on.
  bool add_below(std::size_t level, std::uint32_t node) {
    unsigned waiting = boxes_near(tree_.boxes(level, node), around_, margin_);
    // The number, on the level below, of the node that is or contains the own leaf. If this node contains it too,
    // children with lower slots hold only leaves before it: drop them, as those pairs are visited from the other leaf.
    const std::uint32_t on_path = leaf_ >> (bits_of_width * (level - 1));
    if (on_path / width == node) waiting &= ~0U << (on_path % width);
    for (; waiting != 0; waiting &= waiting - 1) {
      const std::uint32_t child = node * width + static_cast<std::uint32_t>(std::countr_zero(waiting));
      if (!(level > 1 ? add_below(level - 1, child) : add_leaf(child))) return false;
    }
    return true;
  }

  /// Adds the pairs with models of a leaf. Returns whether the walk goes on.
  bool add_leaf(std::uint32_t other) {
    std::uint64_t boxes_meet =
        simd::kernels().overlapping_pairs(tree_.boxes(0, leaf_), tree_.boxes(0, other), box_of_leaf(other), margin_);
    if (other == leaf_) boxes_meet &= bvh::each_pair_once;
    for (; boxes_meet != 0; boxes_meet &= boxes_meet - 1) {
      LIMBER_ASSERT(count_ < room);
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(boxes_meet));
      const std::uint32_t a = leaf_ * width + bit / width, b = other * width + bit % width;
      found_a_[count_] = a, found_b_[count_] = b;
      // The kernel has compared the boxes axis by axis. At margin 0 that is all that boxes can tell.
      const bool is_near =
          margin_ == 0 ? may_be_near(tree_.spheres_[a], tree_.spheres_[b], 0) : tree_.may_be_within(a, b, margin_);
      count_ += is_near ? 1 : 0;
    }
    return count_ + most_of_two_leaves <= room || flush();
  }

  /// Visits what was collected. Returns whether the walk goes on.
  bool flush() {
    for (std::size_t i = 0; i < count_; ++i) {
      if (!visit_(found_a_[i], found_b_[i])) return false;
    }
    count_ = 0;
    return true;
  }

 private:
  Box box_of_leaf(std::uint32_t i) const {
    return tree_.level_count() > 1 ? box_of(tree_.boxes(1, i / width), i % width) : box_around(tree_.boxes(0, i));
  }

  static constexpr std::size_t most_of_two_leaves = width * width, room = 4 * most_of_two_leaves;
  const BoxTree& tree_;
  std::uint32_t leaf_;
  double margin_;
  FunctionRef<bool(std::uint32_t, std::uint32_t)> visit_;
  Box around_;  // the own leaf
  std::uint32_t found_a_[room], found_b_[room];
  std::size_t count_ = 0;
};

bool BoxTree::visit_pairs(std::uint32_t leaf, double margin,
                          FunctionRef<bool(std::uint32_t, std::uint32_t)> visit) const {
  LIMBER_ASSERT(leaf < leaf_count() && base::is_finite_and_not_negative(margin));
  PairCollector pairs(*this, leaf, margin, visit);
  const std::size_t top = level_count() - 1;
  return (top > 0 ? pairs.add_below(top, 0) : pairs.add_leaf(leaf)) && pairs.flush();
}

}  // namespace limber::scene
