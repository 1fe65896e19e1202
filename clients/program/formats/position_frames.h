// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "limber/mesh.h"
#include "reports/page_data.h"

/// What moves from frame to frame, as a page carries it.
namespace limber::program {

/// The positions of a deforming mesh in many frames: whole multiples of one step, and of these the differences from one
/// frame to the next. Every 32nd frame stands for itself, so that a page can start there.
///
/// Promise  Coordinates are off by at most half a step, which is 2^-16 of the diagonal of the first frame's box.
class PositionFrames {
 public:
  /// Pre: there is a position.
  explicit PositionFrames(std::span<const Vec3> first);

  /// Pre      As many positions as in the first frame.
  /// Errors   BadInput where a position is so far from the first frame that it has no place in a picture with it.
  void add(std::span<const Vec3> positions);

  /// Keeps the first of every two frames.
  void drop_every_second();

  std::size_t byte_count() const { return byte_count_; }

  /// `low`, `step`, `run` (how many frames from one that stands for itself to the next) and `data`, a text for each
  /// frame. Written are counts, for the coordinates one after the other: where k coordinates are as expected, 0 and k;
  /// else 2 d for a difference d > 0 from what is expected, and -2 d - 1 for d < 0. Expected is the coordinate in the
  /// frame before; in a frame that stands for itself, that of the vertex before.
  Json to_json() const;

 private:
  using Steps = std::vector<std::int64_t>;

  Steps steps_of(std::span<const Vec3> positions) const;
  Steps expected(const Steps& steps) const;
  void append(const Steps& steps);

  Vec3 low_;
  double step_ = 1;
  std::vector<Bytes> frames_;
  std::size_t byte_count_ = 0;
  Steps last_;  // the frame that was added last
};

/// Poses as twelve float64 each: the rows of the rotation, then the translation. The lowest byte of each comes first.
Json poses_json(std::span<const Transform> poses);

}  // namespace limber::program
