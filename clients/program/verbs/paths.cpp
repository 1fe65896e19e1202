// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "command/text.h"
#include "formats/csv_inputs.h"

namespace limber::program {
namespace {

/// The poses of a path, or one of a model that stands still.
std::vector<Transform> poses_of(const PathArguments& arguments, const char* option) {
  if (arguments.poses.empty()) return {arguments.pose};
  std::vector<Transform> poses = read_poses(arguments.poses);
  if (poses.size() > 1) return poses;
  throw BadInput(fmt::format("{}: {} has one pose, and a path two or more", option, arguments.poses));
}

RigidMotion motion_from(const std::vector<Transform>& poses, std::size_t step) {
  return poses.size() == 1 ? RigidMotion(poses[0]) : RigidMotion(poses[step], poses[step + 1]);
}

void add_work(auto& sum, const auto& found) {
  sum.distance_count += found.distance_count;
  sum.stats.node_tests += found.stats.node_tests;
  sum.stats.primitive_tests += found.stats.primitive_tests;
}

}  // namespace

Path::Path(const PathArguments& a, const PathArguments& b) {
  const std::vector<Transform> poses_a = poses_of(a, "--path-a"), poses_b = poses_of(b, "--path-b");
  if (poses_a.size() > 1 && poses_b.size() > 1 && poses_a.size() != poses_b.size()) {
    throw BadInput(fmt::format("--path-a has {} poses, but --path-b has {}", poses_a.size(), poses_b.size()));
  }
  const std::size_t pose_count = std::max(poses_a.size(), poses_b.size());
  for (std::size_t s = 0; s + 1 < pose_count; ++s) steps_.push_back({motion_from(poses_a, s), motion_from(poses_b, s)});
}

PathImpact Path::first_impact(const Model& a, const Model& b, double separation) const {
  QueryCache cache;
  const PathOptions options{.min_separation = separation, .cache = &cache};
  PathImpact first;
  first.status = ImpactStatus::clear;
  for (std::size_t s = 0; s < steps_.size() && first.status == ImpactStatus::clear; ++s) {
    const PathImpact found = time_of_impact(a, steps_[s].a, b, steps_[s].b, options);
    first.status = found.status, first.time = static_cast<double>(s) + found.time, first.witness = found.witness;
    add_work(first, found);
  }
  return first;
}

PathDistance Path::min_distance(const Model& a, const Model& b, std::optional<double> distance_error) const {
  QueryCache cache;
  const PathOptions options{.distance_error = distance_error, .cache = &cache};
  PathDistance least;
  least.lower = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    const PathDistance found = limber::min_distance(a, steps_[s].a, b, steps_[s].b, options);
    least.lower = std::min(least.lower, found.lower);
    if (found.upper < least.upper) {
      least.upper = found.upper, least.time = static_cast<double>(s) + found.time, least.witness = found.witness;
    }
    add_work(least, found);
  }
  return least;
}

}  // namespace limber::program
