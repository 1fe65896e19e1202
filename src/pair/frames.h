// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pair/placed_pair.h"
#include "simd/kernels.h"

namespace limber::pair {

/// The transforms between the frames of two models, as the kernels need them. Computed when they are first asked for.
class Frames {
 public:
  explicit Frames(const PlacedPair& placed) : placed_(placed) {}

  /// To the frame of model `s` from that of the other.
  const simd::FrameTransform& of(Side s) {
    if (!is_known_[index(s)]) compute(s);
    return transforms_[index(s)];
  }

  /// The pose of b in the frame of a.
  Transform a_from_b();

 private:
  void compute(Side s);

  simd::FrameTransform transforms_[2];
  const PlacedPair& placed_;
  bool is_known_[2] = {false, false};
};

}  // namespace limber::pair
