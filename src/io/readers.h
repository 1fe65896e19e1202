// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "io/parse_mesh.h"
#include "io/soup.h"

/// One reader for each format, from the bytes of the file. Each takes time and memory in proportion to the bytes it is
/// given, whatever a header promises; glTF scenes, which may show a mesh many times, have limits of their own.
namespace limber::io {

Result<Soup> read_obj(std::string_view file);
Result<Soup> read_off(std::string_view file);
Result<Soup> read_ply(std::string_view file);
Result<Soup> read_stl(std::string_view file);
Result<Soup> read_gltf(std::string_view file, const BufferSource& external);

}  // namespace limber::io
