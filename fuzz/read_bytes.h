// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "fuzz/scratch_file.h"
#include "limber/io.h"

namespace limber::fuzz {

/// Bytes read as a mesh file with the given extension. `name` is what a message must start with.
///
/// Only this function decides how bytes get to the readers: by a file.
struct ReadBytes {
  std::string name;
  Result<MeshFile> file;
};

inline ReadBytes read_bytes(const std::string& extension, std::span<const unsigned char> bytes) {
  static ScratchFile scratch("input." + extension);
  static ScratchFile binary_scratch("input.glb");
  ScratchFile& chosen = extension == "glb" ? binary_scratch : scratch;
  chosen.write(bytes);
  return {chosen.path().string(), read_mesh_file(chosen.path())};
}

}  // namespace limber::fuzz
