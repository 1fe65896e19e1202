// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bvh/slot_stack.h"
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

  /// Ends soon after a point at most `enough` away was found; by default after the closest one was.
  ///
  /// Pre: the point is finite and at most `max_coordinate` in size.
  std::optional<SurfacePoint> find(const Vec3& point, double max_distance, QueryStats& stats, double enough = -1);

 private:
  struct Candidate {
    double lower;  // of its distance
    const bvh::Leaf* leaf;
    std::uint32_t slot;
  };

  void set_limit(double limit);
  float bound_of(double distance) const;
  void expand(bvh::SlotId slot, QueryStats& stats);
  void compare_leaf(bvh::SlotId slot, QueryStats& stats);
  void compare_candidates(QueryStats& stats);
  void compare(const Candidate& candidate, QueryStats& stats);

  static constexpr std::uint32_t candidate_capacity = 64;

  const PlacedModel& model_;
  const bvh::Tree& tree_;
  const simd::Kernels& kernels_;
  Vec3 point_;
  simd::QueryPoint in_frame_;
  double max_distance_ = 0;
  double limit_ = 0;       // triangles farther away do not matter
  float limit_bound_ = 0;  // the same in the measure of the kernels
  std::optional<SurfacePoint> best_;
  bvh::SlotStack waiting_;
  std::uint32_t candidate_count_ = 0;
  Candidate candidates_[candidate_capacity];
};

}  // namespace limber::point
