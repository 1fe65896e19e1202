// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "layout/node.h"
#include "limber/base.h"
#include "scene/world_bounds.h"

namespace limber::scene {

/// A cube of cubic cells, numbered along a Hilbert curve. A flat scene is divided along its plane only.
class HilbertGrid {
 public:
  /// The grid of points between two corners; none if they are so close that their order does not matter.
  static std::optional<HilbertGrid> of(const Vec3& low, const Vec3& high);
  /// Whether a point is between the corners.
  bool contains(const Vec3& p) const { return min(p, low_) == low_ && max(p, high_) == high_; }
  /// The number of a point's cell. Pre: contains(p).
  std::uint32_t cell_of(const Vec3& p) const;

 private:
  Vec3 low_, high_;
  double per_length_ = 0;
};

/// Orders points so that those which follow each other are near each other: along a Hilbert curve through the cells of
/// a grid.
///
/// Based on  [Hamilton2008] for the curve.
/// Differs   Where more points are in one cell than a node has children, the cell gets a grid of its own, about the
///           points in it. So a grid need not be fine, and a point far away does not spoil the order of all others.
class HilbertOrder {
 public:
  /// The indices of `centers`, in order. Depends on the points alone; equal points are in the order of their indices.
  /// Valid until the next call. A grid is that of more points than these, whose order they are to have.
  ///
  /// Cost     O(n) for points that are spread out, O(n log n) for others; allocates where there are more points than
  ///          ever.
  std::span<const std::uint32_t> sort(std::span<const Vec3> centers, const HilbertGrid* grid = nullptr);

 private:
  using Entry = std::uint64_t;  // the place of the cell on the curve, then the index

  void sort_range(std::span<const Vec3> centers, std::size_t begin, std::size_t end);
  void sort_range(std::span<const Vec3> centers, std::size_t begin, std::size_t end, const HilbertGrid& grid);
  void sort_entries(std::size_t begin, std::size_t end);

  std::vector<Entry> entries_, other_entries_;
  std::vector<std::uint32_t> order_;
};

/// A lower bound of the distance of two things with these bounds.
double lower_bound(const WorldBounds& a, const WorldBounds& b);

/// An 8-wide tree over the bounds of placed models, built anew whenever some have moved.
///
/// The models are numbered in Hilbert order; these numbers are their ranks. Eight consecutive ones are a leaf, eight
/// consecutive leaves the children of a node, and so on, so a node's number tells its children's.
class BoxTree {
 public:
  /// Builds the tree of the models with these ids, which index `bounds`.
  ///
  /// Cost     O(n) for models that are spread out, O(n log n) for others; allocates where there are more than ever.
  void build(std::span<const std::uint32_t> ids, std::span<const WorldBounds> bounds);

  std::uint32_t size() const { return static_cast<std::uint32_t>(ids_.size()); }
  std::uint32_t leaf_count() const { return static_cast<std::uint32_t>((ids_.size() + bvh::width - 1) / bvh::width); }
  /// The id of a model. Pre: rank < size().
  std::uint32_t id_of(std::uint32_t rank) const { return ids_[rank]; }

  /// Whether two models may be at most so far apart. Pre: the margin comes from margin_with_error().
  bool may_be_within(std::uint32_t rank_a, std::uint32_t rank_b, double margin) const;
  /// A lower bound of the distance of two models.
  double lower_bound(std::uint32_t rank_a, std::uint32_t rank_b) const {
    return scene::lower_bound(bounds_of(rank_a), bounds_of(rank_b));
  }

  /// Calls visit(rank_a, rank_b) once for every two models that may be within the margin, of which the one with the
  /// lower rank, rank_a, is in the given leaf, until that returns false. Returns whether it never did. Pre: as for
  /// may_be_within(); leaf < leaf_count().
  bool visit_pairs(std::uint32_t leaf, double margin, FunctionRef<bool(std::uint32_t, std::uint32_t)> visit) const;

  /// Calls visit(rank) once for every model that may be within the margin of something else with those bounds, until
  /// that returns false. Returns whether it never did. Pre: as for may_be_within().
  bool visit_near(const WorldBounds& bounds, double margin, FunctionRef<bool(std::uint32_t)> visit) const;
  /// A lower bound of the distance of a model and something else with those bounds.
  double lower_bound(const WorldBounds& bounds, std::uint32_t rank) const {
    return scene::lower_bound(bounds, bounds_of(rank));
  }

 private:
  class PairCollector;
  WorldBounds bounds_of(std::uint32_t rank) const;
  bool visit_near_below(std::size_t level, std::uint32_t node, const WorldBounds& own, double margin,
                        FunctionRef<bool(std::uint32_t)> visit) const;

  /// The boxes of a leaf's models on level 0, those of a node's children above.
  const bvh::BoxNode& boxes(std::size_t level, std::size_t node) const { return boxes_[level_begin_[level] + node]; }
  std::size_t level_count() const { return level_begin_.size() - 1; }

  HilbertOrder spatial_order_;
  std::vector<Vec3> centers_;
  std::vector<std::uint32_t> ids_;        // by rank
  std::vector<Sphere> spheres_;           // by rank
  std::vector<bvh::BoxNode> boxes_;       // level by level
  std::vector<std::size_t> level_begin_;  // and one past the last, which has one node
};

}  // namespace limber::scene
