// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/io.h"

#include <algorithm>
#include <bit>
#include <fstream>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "io/prepare.h"
#include "io/read_soup.h"

namespace limber {
namespace {

namespace fs = std::filesystem;

/// Puts the path in front; the whole stays one line whatever the path holds.
Error in_file(const fs::path& path, Error error) {
  error.text = path.string() + ": " + error.text;
  std::replace_if(
      error.text.begin(), error.text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return error;
}

Result<std::string> read_bytes(const fs::path& path) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  const auto unreadable = [](std::string reason) { return Error{ErrorCode::unreadable_file, std::move(reason), {}}; };
  if (status.type() == fs::file_type::not_found) return unreadable("no such file");
  if (failed) return unreadable(failed.message());
  if (fs::is_directory(status)) return unreadable("is a folder");
  if (!fs::is_regular_file(status)) return unreadable("is not a regular file");
  std::ifstream in(path, std::ios::binary);
  if (!in) return unreadable("cannot be opened, its permissions may forbid it");
  const std::uintmax_t size = fs::file_size(path, failed);
  if (failed) return unreadable(failed.message());
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (!in.read(bytes.data(), static_cast<std::streamsize>(size))) return unreadable("cannot be read to its end");
  if (bytes.empty()) return Error{ErrorCode::malformed_file, "is empty", {}};
  return bytes;
}

Result<io::Soup> parse(const fs::path& path) {
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return bytes.error();
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (extension == ".obj") return io::read_obj(*bytes);
  if (extension == ".ply") return io::read_ply(*bytes);
  if (extension == ".off") return io::read_off(*bytes);
  if (extension == ".stl") {
    const Result<bool> is_binary = io::is_binary_stl(*bytes);
    if (!is_binary) return is_binary.error();
    return *is_binary ? io::read_stl_binary(*bytes) : io::read_stl_text(*bytes);
  }
  if (extension == ".gltf" || extension == ".glb") return io::read_gltf(path, *bytes);
  return Error{ErrorCode::unsupported_format,
               (extension.empty() ? "has no extension" : "extension '" + extension + "' is not read") +
                   "; .obj, .ply, .stl, .off, .gltf and .glb are",
               {}};
}

/// Reads a file and checks all that can be said without triangles. Errors name the file.
Result<io::Soup> read_soup(const fs::path& path) {
  try {
    Result<io::Soup> soup = parse(path);
    if (!soup) return in_file(path, soup.error());
    if (soup->faces.size() >= no_id)
      return in_file(path, {ErrorCode::too_large, "has more faces than ids can count", {}});
    if (Result<void> checked = check_positions(soup->positions); !checked) return in_file(path, checked.error());
    return soup;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& thrown) {
    return in_file(path, {ErrorCode::malformed_file, std::string("cannot be read: ") + thrown.what(), {}});
  }
}

struct Weld {
  std::vector<VertexId> welded_of;       // for each file vertex
  std::vector<VertexId> file_vertex_of;  // the first file vertex for each welded vertex
};

/// Spreads a position over 64 bits; equal positions, so also -0 and 0, give equal values.
std::uint64_t hash(const Vec3& p) {
  std::uint64_t h = 0;
  for (const double coordinate : {p.x, p.y, p.z}) {
    h = (h ^ std::bit_cast<std::uint64_t>(coordinate + 0.0)) * 0x9e37'79b9'7f4a'7c15U;  // -0 + 0 is 0
    h ^= h >> 32U;
  }
  return h;
}

/// Maps vertices at equal positions to the first of them, by hashing with linear probing.
Weld weld(const std::vector<Vec3>& positions) {
  Weld result;
  result.welded_of.reserve(positions.size());
  std::vector<VertexId> table(std::bit_ceil(2 * positions.size() + 1), no_id);  // of welded vertices
  for (std::size_t v = 0; v < positions.size(); ++v) {
    std::size_t slot = hash(positions[v]) & (table.size() - 1);
    while (table[slot] != no_id && positions[result.file_vertex_of[table[slot]]] != positions[v]) {
      slot = (slot + 1) & (table.size() - 1);
    }
    if (table[slot] == no_id) {
      table[slot] = static_cast<VertexId>(result.file_vertex_of.size());
      result.file_vertex_of.push_back(static_cast<VertexId>(v));
    }
    result.welded_of.push_back(table[slot]);
  }
  return result;
}

std::vector<Vec3> pick(const std::vector<Vec3>& positions, const std::vector<VertexId>& vertices) {
  std::vector<Vec3> picked;
  picked.reserve(vertices.size());
  for (const VertexId v : vertices) picked.push_back(positions[v]);
  return picked;
}

/// Triangulates and welds.
Result<MeshFile> make_mesh_file(const fs::path& path, const io::Soup& soup, const Weld& weld) {
  std::vector<Corners> triangles;
  std::vector<std::uint32_t> face_of_triangle;
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    const std::span<const std::uint32_t> face = soup.faces[f];
    for (std::size_t i = 2; i < face.size(); ++i) {
      triangles.push_back({weld.welded_of[face[0]], weld.welded_of[face[i - 1]], weld.welded_of[face[i]]});
      face_of_triangle.push_back(static_cast<std::uint32_t>(f));
    }
  }
  if (triangles.empty()) return in_file(path, {ErrorCode::empty_mesh, "has no face of three corners", {}});
  if (triangles.size() >= no_id)
    return in_file(path, {ErrorCode::too_large, "has more triangles than ids can count", {}});
  Result<Mesh> mesh = Mesh::create(pick(soup.positions, weld.file_vertex_of), std::move(triangles));
  if (!mesh) return in_file(path, mesh.error());
  return MeshFile{std::move(*mesh), std::move(face_of_triangle), soup.faces.size()};
}

}  // namespace

Result<MeshFile> read_mesh_file(const fs::path& path) {
  const Result<io::Soup> soup = read_soup(path);
  if (!soup) return soup.error();
  return make_mesh_file(path, *soup, weld(soup->positions));
}

Result<Mesh> load_mesh(const fs::path& path) {
  Result<MeshFile> file = read_mesh_file(path);
  if (!file) return file.error();
  return std::move(file->mesh);
}

Result<MeshSequence> MeshSequence::open(const fs::path& first_frame) {
  Result<io::Soup> soup = read_soup(first_frame);
  if (!soup) return soup.error();
  Weld map = weld(soup->positions);
  Result<MeshFile> file = make_mesh_file(first_frame, *soup, map);
  if (!file) return file.error();
  MeshSequence sequence(std::move(*file));
  sequence.file_vertex_count_ = soup->positions.size();
  sequence.file_corners_ = std::move(soup->faces.corners);
  sequence.file_face_ends_ = std::move(soup->faces.ends);
  sequence.file_vertex_of_ = std::move(map.file_vertex_of);
  return sequence;
}

Result<std::vector<Vec3>> MeshSequence::read_positions(const fs::path& path, std::size_t frame) const {
  const Result<io::Soup> soup = read_soup(path);
  if (!soup) return soup.error();
  const auto changed = [&](const std::string& how) {
    return in_file(path, {ErrorCode::changed_connectivity, "frame " + std::to_string(frame) + " " + how, frame});
  };
  const io::FaceLists& faces = soup->faces;
  if (soup->positions.size() != file_vertex_count_ || faces.size() != file_face_ends_.size()) {
    return changed("has " + std::to_string(soup->positions.size()) + " vertices and " + std::to_string(faces.size()) +
                   " faces, the first frame " + std::to_string(file_vertex_count_) + " and " +
                   std::to_string(file_face_ends_.size()));
  }
  if (faces.corners != file_corners_ || faces.ends != file_face_ends_) {
    const io::FaceLists first{file_corners_, file_face_ends_};
    std::size_t face = 0;
    while (std::ranges::equal(faces[face], first[face])) ++face;
    return changed("differs from the first frame in face " + std::to_string(face) + " of " +
                   std::to_string(faces.size()) + ", with " + std::to_string(file_vertex_count_) + " vertices in both");
  }
  return pick(soup->positions, file_vertex_of_);
}

}  // namespace limber
