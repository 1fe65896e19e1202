// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdint>
#include <string>

#include "io/read_soup.h"
#include "io/text_scan.h"

namespace limber::io {
namespace {

using Matrix = aiMatrix4x4t<double>;

/// Appends a mesh as its node places it.
Result<void> append(Soup& soup, const aiMesh& mesh, const Matrix& world_from_mesh) {
  const std::size_t first_vertex = soup.positions.size();
  if (first_vertex + mesh.mNumVertices >= no_id) {
    return Error{ErrorCode::too_large, "has more vertices than ids can count", {}};
  }
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D& p = mesh.mVertices[v];
    const aiVector3t<double> placed = world_from_mesh * aiVector3t<double>(p.x, p.y, p.z);
    soup.positions.push_back({placed.x, placed.y, placed.z});
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    const std::span corners(face.mIndices, face.mNumIndices);
    if (Result<void> added = add_face(soup.faces, corners, first_vertex, mesh.mNumVertices); !added) return added;
  }
  return {};
}

/// All meshes of the scene, each as often as a node shows it, nodes before their children and these in order.
Result<Soup> flatten(const aiScene& scene) {
  struct Visit {
    const aiNode* node;
    Matrix world_from_parent;
  };
  Soup soup;
  std::vector<Visit> open;
  if (scene.mRootNode != nullptr) open.push_back({scene.mRootNode, Matrix()});
  while (!open.empty()) {
    const auto [node, world_from_parent] = open.back();
    open.pop_back();
    const Matrix world_from_node = world_from_parent * Matrix(node->mTransformation);
    for (unsigned m = 0; m < node->mNumMeshes; ++m) {
      if (Result<void> done = append(soup, *scene.mMeshes[node->mMeshes[m]], world_from_node); !done)
        return done.error();
    }
    for (unsigned c = node->mNumChildren; c-- > 0;) open.push_back({node->mChildren[c], world_from_node});
  }
  return soup;
}

/// An importer that reads files of one extension only: Assimp shows what its loader refuses to those of all other
/// formats.
class OneFormatImporter : public Assimp::Importer {
 public:
  explicit OneFormatImporter(std::string_view extension) {
    for (std::size_t i = GetImporterCount(); i-- > 0;) {
      Assimp::BaseImporter* loader = GetImporter(i);
      if (std::string_view(GetImporterInfo(i)->mFileExtensions).find(extension) != std::string_view::npos) continue;
      UnregisterLoader(loader);
      delete loader;  // ours since it is no longer registered
    }
  }
};

/// Why a file could not be read, as one printable line.
Error failure(const Assimp::Importer& importer) {
  std::string_view text = importer.GetErrorString();
  text = take_line(text);
  if (text.empty() || text.starts_with("No suitable reader"))
    return malformed("is damaged or not what its extension says");
  std::string reason = "cannot be read: ";
  for (const char c : text.substr(0, 200)) reason += c >= ' ' && c <= '~' ? c : '?';
  return malformed(reason);
}

/// Refuses a binary glTF file whose header or chunks promise more bytes than it has: Assimp allocates before it reads.
Result<void> check_chunks(std::string_view file) {
  const auto number = [&](std::size_t at) {
    std::uint64_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8U | static_cast<unsigned char>(file[at + i]);
    return value;
  };
  constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;
  if (file.size() < header_bytes + chunk_header_bytes) return malformed("ends inside its header");
  std::uint64_t promised = number(8);
  for (std::uint64_t at = header_bytes; at + chunk_header_bytes <= file.size();) {
    at += chunk_header_bytes + number(at);
    promised = std::max(promised, at);
  }
  if (promised <= file.size()) return {};
  return malformed("promises " + std::to_string(promised) + " bytes but has " + std::to_string(file.size()));
}

/// Refuses what Assimp would read wrongly or not notice.
Result<void> check_gltf(std::string_view file) {
  std::string_view rest = without_byte_order_mark(file);
  if (file.starts_with("glTF")) {
    if (Result<void> checked = check_chunks(file); !checked) return checked;
  } else if (!take_word(rest).starts_with('{')) {
    return malformed("is not a glTF file");
  }
  for (const char* name : {"KHR_mesh_quantization", "KHR_draco_mesh_compression", "EXT_meshopt_compression"}) {
    if (file.find('"' + std::string(name) + '"') == file.npos) continue;
    return Error{
        ErrorCode::unsupported_format, std::string("uses the glTF extension ") + name + ", which is not read", {}};
  }
  return {};
}

}  // namespace

Result<Soup> read_stl_binary(std::string_view file) {
  OneFormatImporter importer("stl");
  const aiScene* scene = importer.ReadFileFromMemory(file.data(), file.size(), 0, "stl");
  if (scene == nullptr) return failure(importer);
  return flatten(*scene);
}

Result<Soup> read_gltf(const std::filesystem::path& path, std::string_view file) {
  if (Result<void> checked = check_gltf(file); !checked) return checked.error();
  OneFormatImporter importer("gltf");
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  if (scene == nullptr) return failure(importer);
  return flatten(*scene);
}

}  // namespace limber::io
