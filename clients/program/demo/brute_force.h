// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/mesh.h"

namespace limber::program {

/// The distance of two meshes, each triangle of one against each of the other: no tree and no tricks.
double brute_force_distance(MeshView a, MeshView b, const Transform& a_from_b);

}  // namespace limber::program
