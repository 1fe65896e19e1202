// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "limber/contacts.h"

/// Pairs of triangles that belong together, such as those of one of the places where a shaft meets a plate.
namespace limber::program {

/// Pairs that are connected: two are neighbors if their triangles of A share a vertex, or are one, and their triangles
/// of B, too. Of two neighbors both are in one region.
struct ContactRegion {
  std::size_t count = 0, intersecting_count = 0;  ///< of its pairs
  double depth = 0, distance = 0;                 ///< the largest, the least
  Vec3 low, high;                                 ///< a box around the points of its pairs
};

struct ContactRegions {
  std::vector<ContactRegion> regions;    ///< the deepest first, then the nearest, then the largest
  std::vector<std::uint32_t> region_of;  ///< of each pair
};

/// Cost     O(n log n) for n pairs.
ContactRegions regions_of(const std::vector<Contact>& contacts, MeshView a, MeshView b);

}  // namespace limber::program
