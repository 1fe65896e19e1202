// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "limber/path.h"

/// Paths of rigid models: where they stand at times 0, 1, 2, ... and how they go from each pose to the next.
namespace limber::program {

/// The help text about path files, for every verb that reads them.
inline constexpr const char* path_help = R"(
A path file has a pose per row, tx,ty,tz,qw,qx,qy,qz, with a header or without, as limber track reads them. The model
is at the first pose at time 0, at the second at time 1, and so on: 1.25 is a quarter of the way from the second to the
third. On the way the model's origin moves straight, and the model turns about one axis, the shorter way round, both at
constant speed. Paths of both models have as many poses.
)";

/// Where a model goes, as the command line says it.
struct PathArguments {
  std::string poses;  ///< a file; empty: the model stands still
  Transform pose;     ///< where it does
};

/// How two models go along their poses, one step after the other.
class Path {
 public:
  /// Pre      One of the two goes along poses.
  /// Errors   BadInput of read_poses(); where there are fewer than two poses, or not as many for both models.
  Path(const PathArguments& a, const PathArguments& b);

  const Transform& start_a() const { return steps_.front().a.start(); }
  const Transform& start_b() const { return steps_.front().b.start(); }

  /// As time_of_impact() and min_distance() of limber/path.h, but times are those of the path.
  PathImpact first_impact(const Model& a, const Model& b, double separation) const;
  PathDistance min_distance(const Model& a, const Model& b, std::optional<double> distance_error) const;

 private:
  struct Step {
    RigidMotion a, b;
  };

  std::vector<Step> steps_;
};

}  // namespace limber::program
