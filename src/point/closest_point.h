// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "bvh/tree.h"
#include "limber/points.h"
#include "point/placed_model.h"
#include "simd/kernels.h"

namespace limber::point {

/// In one range of a query about many: some 50 us of work.
inline constexpr std::size_t points_per_task = 64;

/// Finds the triangles of a model that may be closest to a point, for callers that compare them.
///
/// Based on  Depth-first branch and bound [Roussopoulos1995]: children wait nearest first.
/// Differs   Leaves give certified intervals of the distances of their triangles, which are computed in float32. A
///           triangle is a candidate if its interval may hold the least distance, as float64 computes it.
class NearestTriangles {
 public:
  struct Candidate {
    double lower;  // of its distance
    const bvh::Leaf* leaf;
    std::uint32_t slot;

    TriangleId id() const { return leaf->triangle[slot]; }
    const Corners& vertices() const { return leaf->vertices[slot]; }
  };

  explicit NearestTriangles(const PlacedModel& model) : model_(model), tree_(model.tree()) {}

  /// Begins a search. Triangles farther away than `limit` do not matter. One at most `enough` away is offered at once.
  ///
  /// Pre: the point is finite and at most `max_coordinate` in size.
  void start(const Vec3& point, double limit, double enough) {
    in_frame_ = model_.in_frame(point);
    enough_ = enough;
    set_limit(limit);
    waiting_.start(limit_bound_);
  }
  /// Goes on until there are candidates, and returns them: the one with the least lower bound first, the others in any
  /// order. None are left if there are none.
  std::span<const Candidate> next(QueryStats& stats);

  /// Whether a candidate may still be the closest triangle.
  bool matters(const Candidate& candidate) const { return candidate.lower <= limit_; }
  /// Takes into account that a triangle is that far away.
  void lower_limit(double distance) {
    if (distance < limit_) set_limit(distance);
  }

 private:
  void set_limit(double limit) { limit_ = limit, limit_bound_ = bound_of(limit); }
  float bound_of(double distance) const;
  void expand(bvh::SlotId slot, QueryStats& stats);
  bool collect_from_leaf(bvh::SlotId slot);

  static constexpr std::uint32_t capacity = 64;

  const PlacedModel& model_;
  const bvh::Tree& tree_;
  const simd::Kernels& kernels_ = simd::kernels();
  simd::QueryPoint in_frame_;
  double enough_ = 0;
  double limit_ = 0;       // triangles farther away do not matter
  float limit_bound_ = 0;  // the same in the measure of the kernels
  bvh::SlotStack waiting_;
  std::uint32_t count_ = 0;
  Candidate candidates_[capacity];
};

/// Finds the points of a model that are closest to points, one after the other. All candidates are compared, so the
/// answer is the one of a loop over all triangles, to the bit.
class ClosestPointSearch {
 public:
  explicit ClosestPointSearch(const PlacedModel& model) : model_(model), nearest_(model) {}

  /// Ends soon after a point at most `enough` away was found; by default after the closest one was.
  ///
  /// Pre: the point is finite and at most `max_coordinate` in size.
  std::optional<SurfacePoint> find(const Vec3& point, double max_distance, QueryStats& stats, double enough = -1);

 private:
  void compare(const NearestTriangles::Candidate& candidate, const Vec3& point, double max_distance);

  const PlacedModel& model_;
  NearestTriangles nearest_;
  std::optional<SurfacePoint> best_;
};

}  // namespace limber::point
