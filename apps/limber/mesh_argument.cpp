// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_argument.h"

#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include "bad_input.h"
#include "scenes/scenes.h"

namespace limber::program {
namespace {

constexpr std::string_view scene_prefix = "scene:";

}  // namespace

bool is_scene(const std::string& argument) { return argument.starts_with(scene_prefix); }

MeshFile load_mesh_argument(const std::string& argument) {
  if (!is_scene(argument)) return value_or_bad_input(read_mesh_file(argument));
  Mesh mesh = value_or_bad_input(scenes::by_name(argument.substr(scene_prefix.size())), argument + ": ");
  std::vector<std::uint32_t> face_of_triangle(mesh.triangles().size());
  std::iota(face_of_triangle.begin(), face_of_triangle.end(), 0U);
  const std::size_t face_count = face_of_triangle.size();
  return {std::move(mesh), std::move(face_of_triangle), face_count};
}

}  // namespace limber::program
