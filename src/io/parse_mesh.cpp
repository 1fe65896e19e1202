// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/parse_mesh.h"

#include "limber/io.h"

namespace limber::io {
namespace {

Result<Soup> parse(std::string_view bytes, std::string_view extension, const BufferSource& external) {
  const bool is_known = extension == ".obj" || extension == ".ply" || extension == ".off" || extension == ".stl" ||
                        extension == ".gltf" || extension == ".glb";
  if (!is_known) {
    return Error{ErrorCode::unsupported_format,
                 (extension.empty() ? "has no extension" : "extension " + in_quotes(extension) + " is not read") +
                     "; .obj, .ply, .stl, .off, .gltf and .glb are",
                 {}};
  }
  if (bytes.empty()) return malformed("is empty");
  const std::uint64_t byte_count = bytes.size();
  if (byte_count > mesh_file_limits::bytes) {
    return Error{ErrorCode::too_large, "has more bytes than the limit", {}};
  }
  if (extension == ".obj") return read_obj(bytes);
  if (extension == ".ply") return read_ply(bytes);
  if (extension == ".off") return read_off(bytes);
  if (extension == ".stl") return read_stl(bytes);
  return read_gltf(bytes, external);
}

}  // namespace

Result<Soup> parse_mesh(std::string_view bytes, std::string_view extension, const BufferSource& external) {
  Result<Soup> soup = parse(bytes, extension, external);
  if (!soup) return soup;
  if (soup->faces.size() >= no_id) return Error{ErrorCode::too_large, "has more faces than ids can count", {}};
  if (Result<void> checked = check_positions(soup->positions); !checked) return checked.error();
  return soup;
}

}  // namespace limber::io
