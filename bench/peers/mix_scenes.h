// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "bench/peers/scenes_of_peers.h"

namespace limber::bench {

/// Calls `use` with each scene of the broad mix: pairs of mesh files, things over floors, in rooms and in a maze, FCL's
/// own test scene, ball over square, linked rings, soups. The mix stands for what users may have: no scene is chosen
/// for the sake of a library or of a heuristic.
///
/// Situations have up to `pose_count` random poses each. `PeerScene::path` is coherent, for queries with a cache.
/// Scenes whose files are not in `meshes` are left out; with an empty path only generated scenes remain.
/// Errors   BadResult when a file is there and cannot be read.
void for_each_mix_scene(const std::filesystem::path& meshes, std::size_t pose_count,
                        const std::function<void(const PeerScene&)>& use);

}  // namespace limber::bench
