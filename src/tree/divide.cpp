// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tree/divide.h"

#include <algorithm>
#include <atomic>

#include "core/check.h"
#include "core/parallel.h"

namespace limber::tree {
namespace {

std::size_t longest_side(std::span<const Item> items) {
  std::array<float, 3> low = items.front().middle, high = low;
  for (const Item& item : items) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], item.middle[k]);
      high[k] = std::max(high[k], item.middle[k]);
    }
  }
  const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
}

}  // namespace

std::uint32_t leaf_count(std::size_t triangles) { return static_cast<std::uint32_t>((triangles + width - 1) / width); }

std::uint32_t child_count(std::uint32_t leaves) {
  std::uint64_t full = 1;
  while (full * width < leaves) full *= width;
  return static_cast<std::uint32_t>((leaves + full - 1) / full);
}

std::uint32_t first_share(std::uint32_t leaves, std::uint32_t children) {
  return static_cast<std::uint32_t>(std::uint64_t{leaves} * (children / 2) / children);
}

Part part_of(std::size_t begin, std::size_t end) {
  const std::uint32_t leaves = leaf_count(end - begin);
  return {begin, end, leaves > 1 ? child_count(leaves) : 1};
}

std::array<Part, 2> halve(std::span<Item> items, const Part& part) {
  LIMBER_ASSERT(part.children > 1);
  const std::span<Item> own = items.subspan(part.begin, part.end - part.begin);
  const std::size_t first = std::size_t{first_share(leaf_count(own.size()), part.children)} * width;
  const std::size_t axis = longest_side(own);
  std::nth_element(
      own.begin(), own.begin() + static_cast<std::ptrdiff_t>(first), own.end(), [axis](const Item& s, const Item& t) {
        return s.middle[axis] != t.middle[axis] ? s.middle[axis] < t.middle[axis] : s.triangle < t.triangle;
      });
  const std::size_t middle = part.begin + first;
  const auto half = [](std::size_t begin, std::size_t end, std::uint32_t children) {
    return children > 1 ? Part{begin, end, children} : part_of(begin, end);
  };
  return {half(part.begin, middle, part.children / 2), half(middle, part.end, part.children - part.children / 2)};
}

void sort_into_leaves(std::span<Item> items, const Part& part) {
  if (part.children <= 1) return;
  const std::array<Part, 2> halves = halve(items, part);
  core::parallel_invoke(
      part.end - part.begin > 8192, [&] { sort_into_leaves(items, halves[0]); },
      [&] { sort_into_leaves(items, halves[1]); });
}

Extent extent_of(MeshView mesh) {
  Extent extent;
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) extent.put(mesh.triangle(t));
  return extent;
}

Item item_of(MeshView mesh, TriangleId triangle, const Vec3& origin, double unit) {
  const Triangle corners = mesh.triangle(triangle);
  const Vec3 low = min(min(corners.v0, corners.v1), corners.v2), high = max(max(corners.v0, corners.v1), corners.v2);
  const Vec3 middle = ((low - origin) + (high - origin)) * (0.5 / unit);
  return {{static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)}, triangle};
}

void write_leaves(Tree& tree, MeshView mesh, std::uint32_t first, std::span<const Item> items) {
  LIMBER_ASSERT(!items.empty() && first + leaf_count(items.size()) <= tree.leaves.size());
  core::parallel_for(leaf_count(items.size()), 1024, [&](std::size_t leaf) {
    for (std::size_t k = 0; k < width; ++k) {
      const TriangleId triangle = items[std::min(leaf * width + k, items.size() - 1)].triangle;
      tree.leaves[first + leaf].triangle[k] = triangle;
      tree.leaves[first + leaf].vertices[k] = mesh.triangles[triangle];
    }
  });
}

std::uint64_t new_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace limber::tree
