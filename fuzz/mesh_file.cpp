// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bytes as a mesh file: readers return a sound mesh or an error of one line, whatever the bytes.
// Built once for each format; LIMBER_FUZZ_FORMAT is its extension.
#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "fuzz/property.h"
#include "limber/io.h"
#include "limber/model.h"

namespace limber::fuzz {
namespace {

constexpr std::size_t most_triangles_in_model = 2000;

void check_mesh_file(MeshFile file) {
  const Result<void> sound = check_mesh(file.mesh);
  require(static_cast<bool>(sound), "a mesh that was read is sound", sound ? "" : sound.error().text);
  const auto& faces = file.face_of_triangle;
  require(faces.size() == file.mesh.triangles().size(), "every triangle has a face");
  require(std::is_sorted(faces.begin(), faces.end()), "triangles are in the order of their faces");
  require(faces.back() < file.face_count, "faces of triangles exist in the file");
  const auto &parts = file.part_of_triangle, &vertices = file.vertex_of_file_vertex;
  require(parts.size() == faces.size() && *std::max_element(parts.begin(), parts.end()) < file.parts.size() &&
              *std::max_element(vertices.begin(), vertices.end()) + 1 == file.mesh.positions().size(),
          "every triangle has a part, every mesh vertex one of the file");
  require(file.mesh.triangles().size() > most_triangles_in_model ||
              static_cast<bool>(Model(std::move(file.mesh)).validate()),
          "a model of the mesh is valid");
}

}  // namespace
}  // namespace limber::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limber::fuzz;
  const std::span bytes(data, size);
  // glTF comes as text and as a binary container that says so.
  const bool is_container = std::string(data, data + std::min<std::size_t>(size, 4)) == "glTF";
  const std::string format = LIMBER_FUZZ_FORMAT, name = "input." + (format == "gltf" && is_container ? "glb" : format);
  limber::Result<limber::MeshFile> read = limber::read_mesh_bytes(std::as_bytes(bytes), name);
  if (read) {
    check_mesh_file(std::move(*read));
    return 0;
  }
  const std::string& text = read.error().text;
  require(is_one_line(text), "an error is one line", text);
  require(text.starts_with(name + ": "), "an error starts with the file's name", text);
  return 0;
}
