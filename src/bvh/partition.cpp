// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/partition.h"

#include <algorithm>
#include <atomic>

#include "core/check.h"
#include "core/parallel.h"

namespace limber::bvh {
namespace {

// Primitives below which another task costs more than it saves.
constexpr std::size_t worth_a_task = 8192;

std::size_t longest_side(std::span<const PrimitiveRef> primitives) {
  std::array<float, 3> low = primitives.front().center, high = low;
  for (const PrimitiveRef& primitive : primitives) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], primitive.center[k]);
      high[k] = std::max(high[k], primitive.center[k]);
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

std::uint32_t first_half_leaves(std::uint32_t leaves, std::uint32_t children) {
  return static_cast<std::uint32_t>(std::uint64_t{leaves} * (children / 2) / children);
}

BuildRange build_range(std::size_t begin, std::size_t end) {
  const std::uint32_t leaves = leaf_count(end - begin);
  return {begin, end, leaves > 1 ? child_count(leaves) : 1};
}

std::array<BuildRange, 2> split(std::span<PrimitiveRef> primitives, const BuildRange& range) {
  LIMBER_ASSERT(range.children > 1);
  const std::span<PrimitiveRef> own = primitives.subspan(range.begin, range.end - range.begin);
  const std::size_t first = std::size_t{first_half_leaves(leaf_count(own.size()), range.children)} * width;
  const std::size_t axis = longest_side(own);
  const auto is_before = [axis](const PrimitiveRef& s, const PrimitiveRef& t) {
    return s.center[axis] != t.center[axis] ? s.center[axis] < t.center[axis] : s.triangle < t.triangle;
  };
  std::nth_element(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(first), own.end(), is_before);
  const std::size_t middle = range.begin + first;
  const auto half = [](std::size_t begin, std::size_t end, std::uint32_t children) {
    return children > 1 ? BuildRange{begin, end, children} : build_range(begin, end);
  };
  return {half(range.begin, middle, range.children / 2), half(middle, range.end, range.children - range.children / 2)};
}

void partition_into_leaves(std::span<PrimitiveRef> primitives, const BuildRange& range) {
  if (range.children <= 1) return;
  const std::array<BuildRange, 2> halves = split(primitives, range);
  core::parallel_invoke(
      range.end - range.begin > worth_a_task, [&] { partition_into_leaves(primitives, halves[0]); },
      [&] { partition_into_leaves(primitives, halves[1]); });
}

BoundingBox bounding_box_of(MeshView mesh) {
  BoundingBox box;
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) box.add(mesh.triangle(t));
  return box;
}

PrimitiveRef primitive_of(MeshView mesh, TriangleId triangle, const Vec3& origin, double unit) {
  const Triangle corners = mesh.triangle(triangle);
  const Vec3 low = min(min(corners.v0, corners.v1), corners.v2), high = max(max(corners.v0, corners.v1), corners.v2);
  const Vec3 center = ((low - origin) + (high - origin)) * (0.5 / unit);
  return {{static_cast<float>(center.x), static_cast<float>(center.y), static_cast<float>(center.z)}, triangle};
}

void write_leaf(Leaf& leaf, MeshView mesh, std::span<const PrimitiveRef> primitives) {
  LIMBER_ASSERT(!primitives.empty() && primitives.size() <= width);
  for (std::size_t k = 0; k < width; ++k) {
    const TriangleId triangle = primitives[std::min(k, primitives.size() - 1)].triangle;
    leaf.triangle[k] = triangle;
    leaf.vertices[k] = mesh.triangles[triangle];
  }
}

std::span<const PrimitiveRef> primitives_of_leaf(std::span<const PrimitiveRef> primitives, std::size_t i) {
  return primitives.subspan(i * width, std::min(primitives.size() - i * width, std::size_t{width}));
}

std::uint64_t new_assignment_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace limber::bvh
