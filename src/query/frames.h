// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "query/placed_models.h"
#include "simd/kernels.h"

namespace limber::query {

/// Infinity above what the kernels can square: they treat such a node as if it were everywhere. A finite number in its
/// place would make the node smaller than it is.
double or_infinite(double units);

/// The inverse of a matrix that is nearly a rotation; unlike the transpose, as exact as float64 allows.
Mat3 inverse_of(const Mat3& m);

/// The transforms between the frames of two models, as the kernels need them. Computed when they are first asked for.
class Frames {
 public:
  explicit Frames(const PlacedModels& placed) : placed_(placed) {}

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
  const PlacedModels& placed_;
  bool is_known_[2] = {false, false};
};

}  // namespace limber::query
