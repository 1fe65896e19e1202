// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bvh/tree.h"
#include "limber/points.h"
#include "point/placed_model.h"
#include "simd/kernels.h"

namespace limber::point {

/// In one range of a query about many: some 50 us of work.
inline constexpr std::size_t points_per_task = 64;

/// Finds the points of a model that are closest to points, one after the other.
///
/// Based on  Depth-first branch and bound [Roussopoulos1995]: children wait nearest first.
/// Differs   Leaves give certified intervals of the distances of their triangles, which are computed in float32. The
///           float64 distance is computed at the end, for triangles whose interval may hold the least distance. All of
///           these are compared, so the answer is the one of a loop over all triangles, to the bit.
class ClosestPointSearch {
 public:
  explicit ClosestPointSearch(const PlacedModel& model);

  /// Pre: the point is finite and at most `max_coordinate` in size.
  std::optional<SurfacePoint> find(const Vec3& point, double max_distance, QueryStats& stats);

  /// Steps of all calls that tight bounds would have made unnecessary, as far as can be told.
  double margin_cost() const { return margin_cost_; }

 private:
  struct Waiting {
    float bound;  // in the measure of the kernel
    bvh::SlotId slot;
    std::uint32_t siblings;  // where the stack's entries of its siblings begin
  };
  struct Candidate {
    double lower;  // of its distance
    const bvh::Leaf* leaf;
    std::uint32_t slot;
  };

  void set_limit(double limit);
  float bound_of(double distance) const;
  bool is_leaf(bvh::SlotId slot) const;
  void count_margin_cost(const Waiting& slot);
  void expand(bvh::SlotId slot, QueryStats& stats);
  void compare_leaf(bvh::SlotId slot, QueryStats& stats);
  void compare_candidates(QueryStats& stats);
  void compare(const Candidate& candidate, QueryStats& stats);

  // Every slot taken adds less than `width` more and goes one level down, of at most 11 (2^32 triangles).
  static constexpr std::uint32_t stack_capacity = 96, candidate_capacity = 64;

  const PlacedModel& model_;
  const bvh::Tree& tree_;
  const simd::Kernels& kernels_;
  Vec3 point_;
  simd::QueryPoint in_frame_;
  double max_distance_ = 0;
  double limit_ = 0;                         // triangles farther away do not matter
  float limit_bound_ = 0, tight_bound_ = 0;  // the same in the measure of the kernels, and without a margin
  std::optional<SurfacePoint> best_;
  double margin_cost_ = 0;
  std::uint32_t waiting_count_ = 0, candidate_count_ = 0;
  Waiting waiting_[stack_capacity];  // the nearest last
  Candidate candidates_[candidate_capacity];
};

}  // namespace limber::point
