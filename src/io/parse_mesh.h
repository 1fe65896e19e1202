// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "io/soup.h"

namespace limber::io {

/// Gives the bytes of a buffer file that a glTF file names, at most `max_bytes` of them.
///
/// The path is decoded and relative to the glTF file's folder; it has no "..", no root and no scheme.
using BufferSource = std::function<Result<std::string>(const std::string& path, std::uint64_t max_bytes)>;

/// Parses a whole file that is in memory. `extension` is lower-case and starts with a dot, as in ".obj".
///
/// Promise  Positions are finite and at most `max_coordinate` in size; faces name existing vertices.
/// Errors   One line that does not name the file, as read_mesh_file(). Without `external`, glTF files that name buffer
///          files are malformed.
Result<Soup> parse_mesh(std::string_view bytes, std::string_view extension, const BufferSource& external = {});

/// One reader for each format, from the bytes of the file. Each takes time and memory in proportion to the bytes it is
/// given, whatever a header promises; glTF scenes, which may show a mesh many times, have limits of their own.
Result<Soup> read_obj(std::string_view file);
Result<Soup> read_off(std::string_view file);
Result<Soup> read_ply(std::string_view file);
Result<Soup> read_stl(std::string_view file);
Result<Soup> read_gltf(std::string_view file, const BufferSource& external);

}  // namespace limber::io
