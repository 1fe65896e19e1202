// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "limber/model.h"

/// Pairs of models for which budgets and caches are measured: smooth and flat bodies, scans, and cases in which all
/// pairs of triangles are about as far apart.
namespace limber::bench {

struct RealTimeScene {
  std::string name;
  Model a, b;
  Transform pose;  ///< of b
  double size;     ///< of the smaller model
};

/// `meshes` is a folder with stanford-bunny.obj and armadillo.obj, or empty: then there are no scans.
std::vector<RealTimeScene> real_time_scenes(const std::filesystem::path& meshes);

/// Frames in which b turns and slides by `step` of its size; without anything in common if that is 0.
std::vector<Transform> real_time_path(const RealTimeScene& scene, double step, std::size_t frames);

}  // namespace limber::bench
