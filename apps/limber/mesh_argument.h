// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "limber/io.h"

namespace limber::program {

/// The help about an argument that names a model.
inline constexpr const char* model_argument_help = "mesh file (.obj .ply .stl .off .gltf .glb) or scene:NAME";

/// Whether the argument names a scene instead of a file.
bool is_scene(const std::string& argument);

/// Reads a mesh file or makes a scene; each triangle of a scene is a face of its own.
///
/// Errors   BadInput naming the argument.
MeshFile load_mesh_argument(const std::string& argument);

}  // namespace limber::program
