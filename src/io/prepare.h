// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "limber/base.h"

/// Readies files for the reader libraries, which trust what they read: they allocate what a header promises, go on
/// after the end of a truncated file, take 1-2 for two numbers, and refuse ordinary records that carry no geometry for
/// us. Each function refuses what is broken, with its place, and hands on only what the library is known to read well.
namespace limber::io {

/// An OBJ file of lines "v x y z" and "f i j k ..." alone.
Result<std::string> prepare_obj(std::string_view file);

/// An OFF file without comments, normals, colours and texture coordinates.
Result<std::string> prepare_off(std::string_view file);

/// A PLY file of x, y, z and of 32-bit vertex indices alone, in the encoding and byte order of the original.
Result<std::string> prepare_ply(std::string_view file);

/// Which of its two kinds an STL file is.
///
/// Errors   `malformed_file` when it is neither, or a truncated binary file.
Result<bool> is_binary_stl(std::string_view file);

/// A text STL file as an OBJ file, three vertices to the facet: Assimp is off by up to two units in the last place of
/// float32 when it reads decimals, and skips with a warning what ends early or does not follow the grammar.
Result<std::string> prepare_stl_text(std::string_view file);

}  // namespace limber::io
