// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/tracked_model.h"

#include <fmt/format.h>

#include <utility>

#include "answers/models.h"
#include "command/run_files.h"
#include "command/text.h"
#include "formats/csv_inputs.h"

namespace limber::program {

MeshFrames::MeshFrames(std::vector<std::string> arguments) : arguments_(std::move(arguments)) {
  const std::string& first_argument = arguments_.front();
  for (const std::string& argument : arguments_) {
    if (!is_scene(argument)) add_input(argument);
    if (is_scene(argument) == is_scene(first_argument)) continue;
    throw BadInput(fmt::format("{} and {}: frames are either files or scenes, not both", first_argument, argument));
  }
  if (is_scene(first_argument)) {
    scene_ = load_mesh_argument(first_argument);
    return;
  }
  const std::vector<std::filesystem::path> files(arguments_.begin(), arguments_.end());
  sequence_ = value_or_bad_input(MeshSequence::open(files));
  for (const std::filesystem::path& path : sequence_->first().files) add_input(path);
}

std::vector<Vec3> MeshFrames::positions(std::size_t frame) const {
  if (frame == 0) return first().mesh.positions();
  if (!scene_) {
    // Of glTF alone, a frame may have further files, which the sequence does not name.
    const std::string type = std::filesystem::path(arguments_[frame]).extension().string();
    if (type.starts_with(".g") || type.starts_with(".G")) load_mesh_argument(arguments_[frame]);
    return value_or_bad_input(sequence_->read_positions(arguments_[frame], frame));
  }
  const Mesh mesh = load_mesh_argument(arguments_[frame]).mesh, &first_mesh = scene_->mesh;
  if (mesh.positions().size() == first_mesh.positions().size() && mesh.triangles() == first_mesh.triangles()) {
    return mesh.positions();
  }
  throw BadInput(fmt::format("{}: frame {} has {} vertices and {} triangles, the first frame {} and {}{}",
                             arguments_[frame], frame, mesh.positions().size(), mesh.triangles().size(),
                             first_mesh.positions().size(), first_mesh.triangles().size(),
                             mesh.triangles().size() == first_mesh.triangles().size() ? ", differently joined" : ""));
}

TrackedModel::TrackedModel(const ModelArguments& arguments, const ModelOptions& options, bool is_repeated)
    : frames_(arguments.frames),
      poses_(arguments.poses.empty() ? std::vector<Transform>(1) : read_poses(arguments.poses)),
      model_(frames_.first().mesh, options),
      target_(model_.mesh().positions()),
      cached_(is_repeated ? frames_.count() : 0) {}

void TrackedModel::aim_at(std::size_t frame) {
  if (poses_.size() > 1) next_pose_ = frame;
  if (frames_.count() > 1) target_ = positions(frame);
}

TreeUpdate TrackedModel::set_motion() {
  const bool is_still = frames_.count() == 1 && poses_.size() == 1;
  if (is_still && motion_) return {};  // it holds for all frames
  const Stopwatch setting;
  if (!motion_) motion_.emplace(model_);
  value_or_bad_input(motion_->moving.set_motion(target_, poses_[pose_], poses_[next_pose_]));
  return {setting.microseconds()};
}

TreeUpdate TrackedModel::go() {
  pose_ = next_pose_;
  if (frames_.count() == 1) return {};
  const MaintenanceStats before = model_.maintenance_stats();
  const double elapsed_us = move_to_target();
  return work_since(before, model_, elapsed_us);
}

std::vector<Vec3> TrackedModel::positions(std::size_t frame) {
  if (cached_.empty()) return frames_.positions(frame);
  if (!cached_[frame]) cached_[frame] = frames_.positions(frame);
  return *cached_[frame];
}

double TrackedModel::move_to_target() {
  const std::vector<Vec3>& current = model_.mesh().positions();
  std::vector<VertexId> moved_ids;
  std::vector<Vec3> moved_positions;
  for (VertexId v = 0; v < target_.size(); ++v) {
    if (target_[v] == current[v]) continue;
    moved_ids.push_back(v);
    moved_positions.push_back(target_[v]);
  }
  const bool all_moved = moved_ids.size() == target_.size();
  const Stopwatch updating;
  value_or_bad_input(all_moved ? model_.move_all(target_) : model_.move_vertices(moved_ids, moved_positions));
  model_.commit();
  return updating.microseconds();
}

}  // namespace limber::program
