// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/haptic_proxy.h"
#include "limber/distance.h"

#include <algorithm>
#include <cmath>

namespace limber::program {
namespace {

constexpr double part_of_lower = 0.5;  // how much of what is certified a step may use

Vec3 shortened(const Vec3& v, double longest) {
  const double l = length(v);
  return l > longest ? v * (longest / l) : v;
}

}  // namespace

Vec3 Proxy::step_towards(const Vec3& device, const DistanceResult& found) {
  if (found.lower == 0) return retreat_ * away_;
  const Vec3 wanted = device - place_;
  const double reach = part_of_lower * found.lower;
  if (!found.witness) return shortened(wanted, reach);
  const Vec3 apart = found.witness->point_b - found.witness->point_a;
  const Vec3 away = apart * (1 / length(apart));
  if (found.status != DistanceStatus::interrupted) away_ = away;
  // The step nearest to the one wanted that leaves the witness points a standoff apart, as if each were on a plane.
  // Where it is too long, going across the planes counts for more: tissue that comes up must not catch the tool.
  const double along_wanted = dot(away, wanted);
  const double along = std::clamp(std::max(along_wanted, standoff_mm - found.upper), -reach, std::max(reach, retreat_));
  const Vec3 within_planes = wanted - along_wanted * away;
  return along * away + shortened(within_planes, std::sqrt(std::max(0., reach * reach - along * along)));
}

Vec3 Proxy::follow(const Vec3& device, const DistanceResult& found) {
  place_ += step_towards(device, found);
  return stiffness_n_per_mm * (place_ - device);
}

}  // namespace limber::program
