// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "core/check.h"
#include "query/placed_pair.h"

namespace limber::query {

/// What a traversal has ruled out, and how far the models may move before that has to be looked at again.
///
/// Based on  Front tracking [EhmannLin2001]: the frontier of the last traversal is where the next one starts.
/// Differs   The front is not looked at as a whole. All motion is summed up, as an upper bound of what two points can
///           have come closer by; what was found to be far apart is left alone until that sum has used up its distance.
///
/// A record is one opening: a block, the node it was compared with, the lanes that were ruled out, and a lower bound of
/// their distance. The other lanes have been opened and have records of their own, so all records together account for
/// every pair of triangles.
class Front {
 public:
  struct Record {
    double lasts;  ///< its lanes are ruled out while moved() + cut is at most that
    tree::NodeId node[2];
    bool opens_a;
    std::uint8_t lanes;
  };
  static constexpr std::uint16_t none = 0xffff;

  /// Whether it says something about these models: the last traversal that it recorded was one of them and has ended.
  /// One that an exception broke off has not recorded all pairs.
  bool is_about(const PlacedPair& placed) const {
    return is_complete_ && count_ > 0 && id_[0] == placed.tree(Side::a).id && id_[1] == placed.tree(Side::b).id;
  }

  /// Starts over, with the models as they are placed.
  void start(PlacedPair& placed) {
    forget();
    for (const Side s : {Side::a, Side::b}) id_[index(s)] = placed.tree(s).id;
    bent_ = bent(placed);
    pose_ = placed.a_from_b();
    error_ = placed.error();
  }

  /// Adds the way from where the models were to where they are. Pre: is_about(placed).
  void move(PlacedPair& placed) {
    LIMBER_ASSERT(is_about(placed));
    const Transform pose = placed.a_from_b();
    moved_ += placed.most_moved(pose_, error_, pose) + (bent(placed) - bent_) + bent_ * 0x1p-50;
    moved_ *= 1 + 0x1p-50;  // sums of many steps are rounded many times
    bent_ = bent(placed);
    pose_ = pose;
    error_ = placed.error();
    openings_ = 0;
    is_complete_ = false;
  }
  double moved() const { return moved_; }

  void forget() {
    count_ = 0, openings_ = 0, first_openings_ = 0;
    moved_ = 0;
    is_complete_ = false;
  }

  /// Ends a traversal, complete if everything was compared or ruled out, and recorded. A front that costs nearly as
  /// much to go over as a new one is forgotten.
  void finish(bool complete) {
    if (first_openings_ == 0) first_openings_ = openings_;
    const bool pays = openings_ == first_openings_ || 5 * openings_ < 3 * first_openings_;
    if (!complete || !pays) return forget();
    is_complete_ = true;
  }

  /// An opening; none when there is no room.
  std::uint16_t add(const tree::NodeId (&node)[2], Side opened) {
    ++openings_;
    if (count_ == capacity) return none;
    records_[count_] = {std::numeric_limits<double>::infinity(), {node[0], node[1]}, opened == Side::a, 0};
    return static_cast<std::uint16_t>(count_++);
  }

  /// Lanes of a record that are at least `apart` from the node they were compared with.
  void rule_out(std::uint16_t record, unsigned lanes, double apart) {
    LIMBER_ASSERT(record < count_ && apart > 0);
    Record& r = records_[record];
    r.lanes = static_cast<std::uint8_t>(r.lanes | lanes);
    r.lasts = std::min(r.lasts, apart + moved_);
  }

  /// Takes what a record has ruled out, to be looked at again.
  unsigned reopen(std::uint16_t record) {
    LIMBER_ASSERT(record < count_);
    ++openings_;
    Record& r = records_[record];
    const unsigned lanes = r.lanes;
    r.lanes = 0;
    r.lasts = std::numeric_limits<double>::infinity();
    return lanes;
  }

  std::span<const Record> records() const { return {records_, count_}; }

 private:
  /// At least the ways that any vertex of either model has gone within its model, together.
  static double bent(const PlacedPair& placed) { return placed.tree(Side::a).motion + placed.tree(Side::b).motion; }

  static constexpr std::uint32_t capacity = 1024;

  std::uint64_t id_[2] = {0, 0};
  Transform pose_;
  double error_ = 0;  // of placed points there
  double bent_ = 0;
  double moved_ = 0;
  bool is_complete_ = false;
  std::uint32_t count_ = 0, openings_ = 0, first_openings_ = 0;
  Record records_[capacity];
};

}  // namespace limber::query
