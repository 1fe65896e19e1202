// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/io.h"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/check.h"
#include "base/float_environment.h"
#include "io/file_bytes.h"
#include "io/parse_mesh.h"

namespace limber {
namespace {

namespace fs = std::filesystem;

/// Puts the path in front; the whole stays one line of text whatever the path, or what is quoted of the file, holds.
Error in_file(const fs::path& path, Error error) {
  const std::u8string name = path.u8string();
  error.text = std::string(name.begin(), name.end()) + ": " + error.text;
  std::replace_if(
      error.text.begin(), error.text.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; },
      ' ');
  return error;
}

Result<io::Soup> parse_soup(const fs::path& path, std::string_view bytes, const io::BufferSource& external) {
  const base::DefaultFloatEnvironment environment;  // numbers are computed, so the rounding mode counts
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  Result<io::Soup> soup = io::parse_mesh(bytes, extension, external);
  if (!soup) return in_file(path, soup.error());
  return soup;
}

Result<io::Soup> read_soup(const fs::path& path) {
  const Result<std::string> bytes = io::read_regular_file(path, mesh_file_limits::bytes);
  if (!bytes) return in_file(path, bytes.error());
  return parse_soup(path, *bytes, io::buffers_beside(path));
}

std::vector<Vec3> pick(const std::vector<Vec3>& positions, const std::vector<VertexId>& vertices) {
  std::vector<Vec3> picked;
  picked.reserve(vertices.size());
  for (const VertexId v : vertices) {
    LIMBER_ASSERT(v < positions.size());
    picked.push_back(positions[v]);
  }
  return picked;
}

/// Cuts every face into a fan of triangles from its first corner, and gives vertices the ids that `weld` has for them.
Result<MeshFile> make_mesh_file(const fs::path& path, const io::Soup& soup, const Weld& weld) {
  std::size_t triangle_count = 0;
  for (std::size_t f = 0; f < soup.faces.size(); ++f)  // n corners make n - 2 triangles
    triangle_count += std::max<std::size_t>(soup.faces[f].size(), 2) - 2;
  if (triangle_count == 0) return in_file(path, {ErrorCode::empty_mesh, "has no face of three corners", {}});
  if (triangle_count >= no_id)
    return in_file(path, {ErrorCode::too_large, "has more triangles than ids can count", {}});

  std::vector<Corners> triangles;
  std::vector<std::uint32_t> face_of_triangle;
  triangles.reserve(triangle_count);
  face_of_triangle.reserve(triangle_count);
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    const std::span<const std::uint32_t> face = soup.faces[f];
    for (std::size_t i = 2; i < face.size(); ++i) {
      triangles.push_back({weld.welded_of[face[0]], weld.welded_of[face[i - 1]], weld.welded_of[face[i]]});
      face_of_triangle.push_back(static_cast<std::uint32_t>(f));
    }
  }
  LIMBER_ASSERT(triangles.size() == triangle_count);
  Result<Mesh> mesh = Mesh::create(pick(soup.positions, weld.first_of), std::move(triangles));
  if (!mesh) return in_file(path, mesh.error());
  return MeshFile{std::move(*mesh), std::move(face_of_triangle), soup.faces.size()};
}

}  // namespace

Result<MeshFile> read_mesh_file(const fs::path& path) {
  const Result<io::Soup> soup = read_soup(path);
  if (!soup) return soup.error();
  return make_mesh_file(path, *soup, weld(soup->positions));
}

Result<MeshFile> read_mesh_bytes(std::span<const std::byte> bytes, const fs::path& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const Result<io::Soup> soup = parse_soup(name, text, {});
  if (!soup) return soup.error();
  return make_mesh_file(name, *soup, weld(soup->positions));
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
  sequence.file_vertex_of_ = std::move(map.first_of);
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
    std::size_t face = 0;  // the loop ends: as many faces, and they differ
    while (std::equal(faces[face].begin(), faces[face].end(), first[face].begin(), first[face].end())) ++face;
    return changed("differs from the first frame in face " + std::to_string(face) + " of " +
                   std::to_string(faces.size()) + ", with " + std::to_string(file_vertex_count_) + " vertices in both");
  }
  return pick(soup->positions, file_vertex_of_);
}

}  // namespace limber
