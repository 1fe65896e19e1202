// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "answers/impacts.h"
#include "limber/io.h"
#include "limber/model.h"
#include "verbs/replay.h"

/// Models that move and deform from frame to frame, as `limber track` takes them.
namespace limber::program {

struct ModelArguments {
  std::vector<std::string> frames;
  std::string poses;  ///< empty: at the origin
};

/// The frames of one model: a single mesh, or several that differ in their positions only.
///
/// Errors   BadInput, from every function that reads.
class MeshFrames {
 public:
  /// Reads the first frame, and all others if vertices of the first are welded. Pre: there is at least one argument.
  explicit MeshFrames(std::vector<std::string> arguments);

  std::size_t count() const { return arguments_.size(); }
  const MeshFile& first() const { return sequence_ ? sequence_->first() : *scene_; }

  /// The positions of one frame. Frame 0 is in memory; any other is read, and nothing of it is kept.
  std::vector<Vec3> positions(std::size_t frame) const;

 private:
  std::vector<std::string> arguments_;
  // One of the two is set: the sequence if the frames are files, the scene if they are named scenes.
  std::optional<MeshSequence> sequence_;
  std::optional<MeshFile> scene_;
};

/// One of the two models, which is moved from frame to frame.
class TrackedModel {
 public:
  /// Frames that come again are read once if the sequence `is_repeated`.
  TrackedModel(const ModelArguments& arguments, const ModelOptions& options, bool is_repeated);

  std::size_t mesh_count() const { return frames_.count(); }
  std::size_t pose_count() const { return poses_.size(); }
  const Model& model() const { return model_; }
  const Transform& pose() const { return poses_[pose_]; }
  ReplayedState state() const { return {model_.mesh().positions(), pose()}; }
  std::uint32_t face_of(TriangleId triangle) const { return frames_.first().face_of_triangle[triangle]; }

  /// Reads the frame of the lists that the model goes to next.
  void aim_at(std::size_t frame);

  /// Sets the motion to that frame.
  TreeUpdate set_motion();
  /// Pre: it is set.
  const FrameMotion& motion() const { return *motion_; }

  /// Moves to that frame. Only vertices whose position differs are moved.
  TreeUpdate go();

 private:
  std::vector<Vec3> positions(std::size_t frame);
  double move_to_target();

  MeshFrames frames_;
  std::vector<Transform> poses_;  // world_from_model
  std::size_t pose_ = 0, next_pose_ = 0;
  Model model_;
  std::vector<Vec3> target_;                              // the positions of the next frame
  std::optional<FrameMotion> motion_;                     // once one has been set
  std::vector<std::optional<std::vector<Vec3>>> cached_;  // by frame; empty when no frame comes twice
};

}  // namespace limber::program
