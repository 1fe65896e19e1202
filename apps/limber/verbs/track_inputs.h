// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "limber/io.h"

/// Inputs that change from frame to frame: positions from files, and poses.
namespace limber::program {

/// The frames of one model: a single mesh, or several that differ in their positions only.
///
/// Errors   BadInput, from every function that reads.
class MeshFrames {
 public:
  /// Reads the first frame. Pre: there is at least one argument.
  explicit MeshFrames(std::vector<std::string> arguments);

  std::size_t count() const { return arguments_.size(); }
  const MeshFile& first() const { return sequence_ ? sequence_->first() : *scene_; }

  /// Reads one frame and keeps nothing of it.
  std::vector<Vec3> positions(std::size_t frame) const;

 private:
  std::vector<Vec3> scene_positions(std::size_t frame) const;

  std::vector<std::string> arguments_;
  std::optional<MeshSequence> sequence_;  // either of files
  std::optional<MeshFile> scene_;         // or of scenes
};

/// A list with one entry for every frame, or one entry for all frames.
struct FrameList {
  std::string name;  ///< as the user knows it
  std::size_t length = 0;
};

/// The length of the longest list.
///
/// Errors   BadInput naming two lists that are longer than one and differ.
std::size_t common_frame_count(const std::vector<FrameList>& lists);

}  // namespace limber::program
