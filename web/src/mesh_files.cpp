// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>
#include <string>

#include "bindings.h"
#include "limber/io.h"

namespace limber::web {
namespace {

std::optional<MeshFile> last_file;

std::uint32_t address(const void* p) { return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(p)); }

}  // namespace

/// Reads the mesh file in input(), whose name follows its bytes. Gives places and counts of vertices, triangles and
/// faces; they stay until forgetMeshFile().
LIMBER_EXPORT(readMeshBytes) bool exported_read_mesh_bytes(std::size_t bytes, std::size_t name_size) {
  return guarded([&] {
    const std::string name(reinterpret_cast<const char*>(input()) + bytes, name_size);
    last_file = read_mesh_bytes({input(), bytes}, name).value();
    const Mesh& mesh = last_file->mesh;
    exchange.words[0] = address(mesh.positions().data());
    exchange.words[1] = static_cast<std::uint32_t>(mesh.positions().size());
    exchange.words[2] = address(mesh.triangles().data());
    exchange.words[3] = static_cast<std::uint32_t>(mesh.triangles().size());
    exchange.words[4] = address(last_file->face_of_triangle.data());
    exchange.words[5] = static_cast<std::uint32_t>(last_file->face_count);
  });
}

LIMBER_EXPORT(forgetMeshFile) void forget_mesh_file() { last_file.reset(); }

}  // namespace limber::web
