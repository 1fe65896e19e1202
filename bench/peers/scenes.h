// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "limber/mesh.h"
#include "limber/model.h"

/// The scenes on which libraries are compared.
namespace limber::bench {

/// One situation in several poses of b.
struct Situation {
  std::string name;
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

/// Situations of scenes whose poses are scattered.
inline constexpr const char *meeting_name = "meeting", *apart_name = "apart";

/// Calls `use` with each scene of the broad mix: pairs of mesh files, things over floors, in rooms and in a maze, FCL's
/// own test scene, scenes of motion planners, ball over square, linked rings, soups. The mix stands for what users may
/// have: no scene is chosen for the sake of a library or of a heuristic.
///
/// Situations have up to `pose_count` random poses each. `PeerScene::path` is coherent, for queries with a cache.
/// Scenes whose files are not in `meshes` are left out; with an empty path only generated scenes remain. If there are
/// `name_parts`, scenes whose names contain none of them are left out too.
/// Errors   BadResult when a file is there and cannot be read.
void for_each_mix_scene(const std::filesystem::path& meshes, std::size_t pose_count,
                        const std::function<void(const PeerScene&)>& use,
                        const std::vector<std::string>& name_parts = {});

/// Centered on its box and scaled to a diagonal of 1, without triangles that have no area.
Mesh normalised(const Mesh& mesh);

}  // namespace limber::bench
