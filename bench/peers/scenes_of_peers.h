// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "limber/mesh.h"
#include "limber/model.h"

/// The scenes on which libraries are compared.
namespace limber::bench {

/// One situation in several poses of b.
struct Situation {
  std::string name;
  bool touching = false;  ///< so near to contact that rounding decides; collisions are not compared then
  std::vector<Transform> poses;
};

struct PeerScene {
  std::string name;
  Mesh a, b;
  std::vector<Situation> situations;
  std::vector<Transform> path = {};  ///< poses of b that change little from one to the next; empty if there are none
};

/// Ball and square of the source's experiment, both turned together by one random rotation so that nothing is aligned
/// with an axis, at all its separations, in `pose_count` poses.
PeerScene turned_ball_and_square(std::size_t pose_count);

/// Two scans, centered, scaled to a diagonal of 1, b slid along a random direction: far (gap 1), mid (0.05), near
/// (0.001), and overlapping (0.011 deeper than near).
///
/// Errors   BadResult when a file cannot be read.
PeerScene two_scans(const std::string& name, const std::filesystem::path& a, const std::filesystem::path& b,
                    std::size_t pose_count);

/// The pose after b has slid along `outward` until the gap is right. No step goes too far, because its length is a
/// distance.
Transform at_gap(const Model& a, const Model& b, Transform pose, const Vec3& outward, double gap);

/// Centered on its box and scaled to a diagonal of 1, without triangles that have no area.
Mesh normalised(const Mesh& mesh);

/// Every triangle divided into four at the midpoints of its edges.
Mesh subdivided(const Mesh& mesh);

}  // namespace limber::bench
