// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "limber/distance.h"

/// A tool as a user is to feel it: it follows the device, but stops in front of the tissue. The force is a spring
/// between the two. It is the proxy, or god object, of [Zilles1995] and [Ruspini1997]; steps are limited here by what a
/// query has certified. The tool is turned as the device is.
struct Proxy {
  limber::Vec3 place;          ///< of the tool's origin
  double standoff = 0.3;       ///< from the tissue, where the tool stops
  double retreat = 0.1;        ///< of a step where none is known to be safe: at least as far as tissue comes up
  limber::Vec3 away{0, 0, 1};  ///< from the tissue, as the last query has found it that was not interrupted

  /// Moves towards the device. `found` is the distance of the tissue (a) and the tool (b) at `place`.
  void follow(const limber::Vec3& device, const limber::DistanceResult& found) {
    if (found.lower == 0) {  // contact, or nothing is known: back, the way that last led out
      place += retreat * away;
      return;
    }
    // No step shorter than `lower` can touch, however the query ended; half is left for what moves before the next.
    const double reach = found.lower / 2;
    limber::Vec3 step = device - place;
    if (found.witness) {
      const limber::Vec3 apart = found.witness->point_b - found.witness->point_a;
      const limber::Vec3 out = apart * (1 / length(apart));
      if (found.status != limber::DistanceStatus::interrupted) away = out;
      const double wanted = dot(out, step);
      const double along = std::clamp(std::max(wanted, standoff - found.upper), -reach, std::max(reach, retreat));
      place += along * out;
      step = shortened(step - wanted * out, std::sqrt(std::max(0.0, reach * reach - along * along)));
    }
    place += shortened(step, reach);
  }

  static limber::Vec3 shortened(const limber::Vec3& v, double longest) {
    const double size = length(v);
    return size > longest ? v * (longest / size) : v;
  }
};
