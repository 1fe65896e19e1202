// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "base/check.h"
#include "base/float_environment.h"
#include "io/mesh_of_soup.h"
#include "io/soup.h"

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

/// What `call` returns, or the error that it throws.
template <typename Call>
auto result_of(const Call& call) -> Result<decltype(call())> {
  try {
    return call();
  } catch (const BadResult& refused) {
    return refused.error();
  }
}

/// What `call` returns; errors that it throws get the path in front.
template <typename Call>
auto about_file(const fs::path& path, const Call& call) {
  try {
    return call();
  } catch (const BadResult& refused) {
    throw BadResult(in_file(path, refused.error()));
  }
}

/// `extension` is lower-case and starts with a dot, as in ".obj".
io::Soup parse_format(std::string_view bytes, std::string_view extension, const io::BufferSource& external) {
  constexpr std::array<std::string_view, 6> known = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
  if (std::find(known.begin(), known.end(), extension) == known.end()) {
    throw BadResult(
        {ErrorCode::unsupported_format,
         (extension.empty() ? "has no extension" : "extension " + io::in_quotes(extension) + " is not read") +
             "; .obj, .ply, .stl, .off, .gltf and .glb are",
         {}});
  }
  if (bytes.empty()) throw io::malformed("is empty");
  if (std::uint64_t{bytes.size()} > mesh_file_limits::bytes) {
    throw BadResult({ErrorCode::too_large, "has more bytes than the limit", {}});
  }
  if (extension == ".obj") return io::read_obj(bytes);
  if (extension == ".ply") return io::read_ply(bytes);
  if (extension == ".off") return io::read_off(bytes);
  if (extension == ".stl") return io::read_stl(bytes);
  return io::read_gltf(bytes, external);
}

/// Promise  Positions are finite and at most `max_coordinate` in size; faces name existing vertices.
io::Soup parse_soup(const fs::path& path, std::string_view bytes, const io::BufferSource& external) {
  const base::DefaultFloatEnvironment environment;  // numbers are computed, so the rounding mode counts
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return about_file(path, [&] {
    io::Soup soup = parse_format(bytes, extension, external);
    if (soup.faces.size() >= no_id) {
      throw BadResult({ErrorCode::too_large, "has more faces than ids can count", {}});
    }
    check_positions(soup.positions).value();
    return soup;
  });
}

/// Reads a file; `files` becomes the list of all that were read.
io::Soup read_soup(const fs::path& path, std::vector<fs::path>* files = nullptr) {
  const std::string bytes = about_file(path, [&] { return io::read_regular_file(path, mesh_file_limits::bytes); });
  if (files == nullptr) return parse_soup(path, bytes, io::buffers_beside(path));
  *files = {path};
  return parse_soup(path, bytes, [&](const std::string& name, std::uint64_t max_bytes) {
    files->push_back(path.parent_path() / std::u8string(name.begin(), name.end()));
    return io::buffers_beside(path)(name, max_bytes);
  });
}

void require_options(const ReadOptions& options) {
  const double tolerance = options.weld_tolerance;
  if (!(tolerance >= 0 && std::isfinite(tolerance))) {
    throw std::invalid_argument("limber::ReadOptions: weld_tolerance must be finite and not below 0");
  }
  if (!options.weld && tolerance != 0) {
    throw std::invalid_argument("limber::ReadOptions: there is a weld_tolerance without weld");
  }
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

/// A part's name in UTF-8 and without control characters, whatever the file has.
std::string shown_name(const std::string& name) {
  const auto valid = nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  auto shown = nlohmann::json::parse(valid).get<std::string>();
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }, '?');
  return shown;
}

/// Splits every face into triangles, and gives vertices the ids that `weld` has for them.
MeshFile make_mesh_file(const io::Soup& soup, Weld weld, std::vector<fs::path> files) {
  std::size_t triangle_count = 0;
  for (std::size_t f = 0; f < soup.faces.size(); ++f)  // n corners make n - 2 triangles
    triangle_count += std::max<std::size_t>(soup.faces[f].size(), 2) - 2;
  if (triangle_count == 0) throw BadResult({ErrorCode::empty_mesh, "has no face of three corners", {}});
  if (triangle_count >= no_id) {
    throw BadResult({ErrorCode::too_large, "has more triangles than ids can count", {}});
  }

  std::vector<Corners> triangles;
  std::vector<std::uint32_t> face_of_triangle, part_of_triangle;
  triangles.reserve(triangle_count);
  face_of_triangle.reserve(triangle_count);
  part_of_triangle.reserve(triangle_count);
  io::PolygonTriangles splitter(soup.positions);
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    const std::span<const std::uint32_t> face = soup.faces[f];
    const std::span<const std::uint32_t> corners = splitter.split(face, f);
    const auto vertex = [&](std::size_t corner) { return weld.welded_of[face[corners[corner]]]; };
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      triangles.push_back({vertex(i), vertex(i + 1), vertex(i + 2)});
      face_of_triangle.push_back(static_cast<std::uint32_t>(f));
      part_of_triangle.push_back(soup.part_of_face.empty() ? 0 : soup.part_of_face[f]);
    }
  }
  LIMBER_ASSERT(triangles.size() == triangle_count);
  Mesh mesh = Mesh::create(pick(soup.positions, weld.first_of), std::move(triangles)).value();
  std::vector<std::string> parts(std::max<std::size_t>(soup.parts.size(), 1));
  std::transform(soup.parts.begin(), soup.parts.end(), parts.begin(), shown_name);
  return MeshFile{std::move(mesh),  std::move(face_of_triangle), soup.faces.size(), std::move(weld.welded_of),
                  std::move(parts), std::move(part_of_triangle), std::move(files)};
}

/// Why a frame is not one of a sequence that begins with these; empty if it is.
std::string difference(const io::Soup& frame, std::size_t vertex_count, const std::vector<std::uint32_t>& corners,
                       const std::vector<std::size_t>& ends) {
  const io::FaceLists& faces = frame.faces;
  if (frame.positions.size() != vertex_count || faces.size() != ends.size()) {
    return "has " + std::to_string(frame.positions.size()) + " vertices and " + std::to_string(faces.size()) +
           " faces, the first frame " + std::to_string(vertex_count) + " and " + std::to_string(ends.size());
  }
  if (faces.corners == corners && faces.ends == ends) return {};
  const io::FaceLists first{corners, ends};
  std::size_t face = 0;  // the loop ends: as many faces, and they differ
  while (std::equal(faces[face].begin(), faces[face].end(), first[face].begin(), first[face].end())) ++face;
  return "differs from the first frame in face " + std::to_string(face) + " of " + std::to_string(faces.size()) +
         ", with " + std::to_string(vertex_count) + " vertices in both";
}

BadResult changed(const fs::path& path, std::size_t frame, const std::string& how) {
  return BadResult(
      in_file(path, {ErrorCode::changed_connectivity, "frame " + std::to_string(frame) + " " + how, frame}));
}

}  // namespace

Result<MeshFile> read_mesh_file(const fs::path& path, const ReadOptions& options) {
  require_options(options);
  return result_of([&] {
    std::vector<fs::path> files;
    const io::Soup soup = read_soup(path, &files);
    return about_file(path,
                      [&] { return make_mesh_file(soup, io::Welding(soup, options).result(), std::move(files)); });
  });
}

Result<MeshFile> read_mesh_bytes(std::span<const std::byte> bytes, const fs::path& name, const ReadOptions& options) {
  require_options(options);
  return result_of([&] {
    const io::Soup soup = parse_soup(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, {});
    return about_file(name, [&] { return make_mesh_file(soup, io::Welding(soup, options).result(), {}); });
  });
}

Result<Mesh> load_mesh(const fs::path& path, const ReadOptions& options) {
  Result<MeshFile> file = read_mesh_file(path, options);
  if (!file) return file.error();
  return std::move(file->mesh);
}

Result<MeshSequence> MeshSequence::open(const fs::path& first_frame, const ReadOptions& options) {
  return open(std::span(&first_frame, 1), options);
}

Result<MeshSequence> MeshSequence::open(std::span<const fs::path> frames, const ReadOptions& options) {
  require_options(options);
  if (frames.empty()) throw std::invalid_argument("limber::MeshSequence::open: there is no frame");
  return result_of([&] {
    std::vector<fs::path> files;
    io::Soup soup = read_soup(frames.front(), &files);
    io::Welding welding(soup, options);
    for (std::size_t frame = 1; frame < frames.size() && welding.joins_any(); ++frame) {
      const io::Soup later = read_soup(frames[frame]);
      const std::string how = difference(later, soup.positions.size(), soup.faces.corners, soup.faces.ends);
      if (!how.empty()) throw changed(frames[frame], frame, how);
      welding.part(later.positions);
    }
    Weld weld = welding.result();
    std::vector<VertexId> file_vertex_of = weld.first_of;
    MeshSequence sequence(
        about_file(frames.front(), [&] { return make_mesh_file(soup, std::move(weld), std::move(files)); }));
    sequence.weld_tolerance_ = options.weld_tolerance;
    sequence.file_corners_ = std::move(soup.faces.corners);
    sequence.file_face_ends_ = std::move(soup.faces.ends);
    sequence.file_vertex_of_ = std::move(file_vertex_of);
    return sequence;
  });
}

Result<std::vector<Vec3>> MeshSequence::read_positions(const fs::path& path, std::size_t frame) const {
  return result_of([&] {
    const io::Soup soup = read_soup(path);
    const std::vector<VertexId>& mesh_vertex_of = first_.vertex_of_file_vertex;
    const std::string how = difference(soup, mesh_vertex_of.size(), file_corners_, file_face_ends_);
    if (!how.empty()) throw changed(path, frame, how);
    for (std::size_t v = 0; v < mesh_vertex_of.size(); ++v) {
      const VertexId first = file_vertex_of_[mesh_vertex_of[v]];
      if (io::are_together(soup.positions[first], soup.positions[v], weld_tolerance_)) continue;
      throw changed(path, frame,
                    "parts vertices " + std::to_string(first) + " and " + std::to_string(v) +
                        " of the file, which are one in the sequence; open it with all its frames, or without welding");
    }
    return pick(soup.positions, file_vertex_of_);
  });
}

}  // namespace limber
