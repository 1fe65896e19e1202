// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/track_inputs.h"

#include <fmt/format.h>

#include <utility>

#include "command/bad_input.h"
#include "verbs/models.h"

namespace limber::program {

MeshFrames::MeshFrames(std::vector<std::string> arguments) : arguments_(std::move(arguments)) {
  const std::string& first_argument = arguments_.front();
  if (is_scene(first_argument)) {
    scene_ = load_mesh_argument(first_argument);
  } else {
    sequence_ = value_or_bad_input(MeshSequence::open(first_argument));
  }
  for (const std::string& argument : arguments_) {
    if (is_scene(argument) == scene_.has_value()) continue;
    throw BadInput(fmt::format("{} and {}: frames are either files or scenes, not both", first_argument, argument));
  }
}

std::vector<Vec3> MeshFrames::positions(std::size_t frame) const {
  if (frame == 0) return first().mesh.positions();
  if (scene_) return scene_positions(frame);
  return value_or_bad_input(sequence_->read_positions(arguments_[frame], frame));
}

std::vector<Vec3> MeshFrames::scene_positions(std::size_t frame) const {
  const Mesh mesh = load_mesh_argument(arguments_[frame]).mesh;
  const Mesh& first_mesh = scene_->mesh;
  if (mesh.positions().size() != first_mesh.positions().size() || mesh.triangles() != first_mesh.triangles()) {
    throw BadInput(fmt::format("{}: frame {} has {} vertices and {} triangles, the first frame {} and {}{}",
                               arguments_[frame], frame, mesh.positions().size(), mesh.triangles().size(),
                               first_mesh.positions().size(), first_mesh.triangles().size(),
                               mesh.triangles().size() == first_mesh.triangles().size() ? ", differently joined" : ""));
  }
  return mesh.positions();
}

std::size_t common_frame_count(const std::vector<FrameList>& lists) {
  FrameList longest{"", 1};
  for (const FrameList& list : lists) {
    if (list.length == 1) continue;
    if (longest.length > 1 && list.length != longest.length) {
      throw BadInput(
          fmt::format("{} has {} frames, but {} has {}", longest.name, longest.length, list.name, list.length));
    }
    longest = list;
  }
  return longest.length;
}

}  // namespace limber::program
