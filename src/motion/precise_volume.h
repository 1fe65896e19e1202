// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error_free.h"
#include "motion/moving_elements.h"

namespace limber::motion {

/// The coplanarity polynomial of two moving elements with twice the digits of a double: det(u, v, w) of MovingElements
/// as a function of time.
///
/// Pre: of u, v and w none has a largest coordinate, at both ends, below 2^-200 of the largest; or nothing is certain.
class PreciseVolume {
 public:
  explicit PreciseVolume(const MovingElements& elements);

  /// The value at a time from 0 to 1, in some unit; 0 if its sign is not certain.
  double at(double time) const;

 private:
  base::DoublePair coefficient_[4];  // of (1 - t)^3, (1 - t)^2 t, (1 - t) t^2 and t^3
  double error_;
};

}  // namespace limber::motion
