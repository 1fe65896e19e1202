// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "base/check.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/convex_start.h"
#include "pair/front.h"

namespace limber {
namespace pair {

/// Decides, from what it has given so far, whether to try something that saves time in some queries and costs time in
/// others. Where it does not pay, it is tried in few queries, so that its cost is a small part of all.
///
/// Gains and losses are parts of the time of a query that does without it.
class Trial {
 public:
  /// To be asked once a query.
  bool is_due() {
    if (credit_ >= to_begin) is_on_ = true;
    if (credit_ < to_go_on) is_on_ = false;
    if (!is_on_) credit_ += allowance;
    return is_on_;
  }
  /// Whether it has lately gained more than it has lost.
  bool has_paid() const { return credit_ > to_begin; }
  void add_gain(double gain) {
    LIMBER_ASSERT(gain <= 1);
    credit_ = std::clamp(credit_ + gain, -1.0, 2.0);
  }

 private:
  // Several queries in a row: the first may only prepare what the next one profits from.
  static constexpr double to_begin = 0.5, to_go_on = 0.2, allowance = 1. / 64;

  double credit_ = to_begin;
  bool is_on_ = true;
};

}  // namespace pair

struct QueryCache::Impl {
  Impl() {}  // NOLINT: a defaulted one would clear the front's memory, 90 kB that few queries need

  TriangleId triangle_a = no_id, triangle_b = no_id;  // the last answer
  pair::Trial pair;                                   // to compare these triangles first
  pair::Trial bound;                                  // to keep the bound of the last query, less the motion since
  pair::Trial recording;                              // to record a front
  pair::ConvexStart convex_start;                     // the last simplex of two convex bodies
  double work_of_new = 0;  // of the last traversal from the roots, in pairs of nodes that are compared
  pair::Front front;

  /// Judges whether comparing the triangles first has helped a query.
  void judge_pair(bool has_helped) { judge(pair, has_helped, cost_of_pair); }
  /// Judges whether the bound has ended a query.
  void judge_bound(bool has_ended) { judge(bound, has_ended, cost_of_bound); }
  /// Judges a traversal from the roots that has recorded a front. It may have been short only because the last answer
  /// is near this one, so it does not make what is saved look small.
  void judge_new_front(double work) {
    work_of_new = std::max(work_of_new, work);
    recording.add_gain(-cost_of_recording);
  }
  /// Judges a traversal that started with the records of a front. The work of a new one may have become less since it
  /// was counted; so that this is noticed, less and less is assumed.
  void judge_front(double work) {
    const double gain = 1 - cost_of_resumed_work * work / std::max(work_of_new, 1.0);
    work_of_new *= 1 - 1. / 64;
    recording.add_gain(gain);
    if (gain < 0) front.forget_records();
  }

 private:
  // Measured: queries with and without a cache, at rest and along paths.
  static constexpr double cost_of_pair = 4, cost_of_bound = 2;                   // in pairs of nodes
  static constexpr double cost_of_recording = 0.25, cost_of_resumed_work = 1.6;  // as parts of a new traversal's

  void judge(pair::Trial& trial, bool has_helped, double cost) {
    trial.add_gain(((has_helped ? work_of_new : 0) - cost) / (work_of_new + cost));
  }
};

}  // namespace limber
