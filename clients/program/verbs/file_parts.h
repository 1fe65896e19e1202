// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "limber/io.h"

/// The parts of one mesh file, such as the nodes of a glTF scene or the objects of an OBJ file, as meshes of their own.
namespace limber::program {

struct FilePart {
  std::string name;  ///< as the file has it; may be empty
  MeshFile file;     ///< its triangles in their order; faces are numbered as in the whole file
};

/// Whether a name ends as those of mesh files do.
bool is_mesh_file(const std::string& path);

/// Errors   BadInput of reading the file.
std::vector<FilePart> read_file_parts(const std::string& path);

}  // namespace limber::program
