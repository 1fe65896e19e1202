// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Quinlan1994]'s division into equal halves across the longest side.
// Differs   Eight children instead of two: halves of halves. The number of triangles alone decides the shape: every
//           subtree gets whole leaves, as few levels as will do, and children of equal size, so leaves and blocks are
//           full nearly everywhere and all leaves are on one level.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "tree/node.h"

namespace limber::tree {
namespace {

/// A triangle as the build moves it around.
struct Item {
  std::array<float, 3> middle;
  TriangleId triangle;
};

std::uint32_t leaf_count(std::size_t triangles) { return static_cast<std::uint32_t>((triangles + width - 1) / width); }

/// How many children a node over that many leaves has: as few full ones as will do.
std::uint32_t child_count(std::uint32_t leaves) {
  std::uint64_t full = 1;
  while (full * width < leaves) full *= width;
  return static_cast<std::uint32_t>((leaves + full - 1) / full);
}

/// Of `leaves` to be shared by `children`, those of the first half of the children.
std::uint32_t first_share(std::uint32_t leaves, std::uint32_t children) {
  return static_cast<std::uint32_t>(std::uint64_t{leaves} * (children / 2) / children);
}

void share(std::uint32_t leaves, std::uint32_t children, std::vector<std::uint32_t>& parts) {
  if (children == 1) return parts.push_back(leaves);
  const std::uint32_t first = first_share(leaves, children);
  share(first, children / 2, parts);
  share(leaves - first, children - children / 2, parts);
}

/// All blocks, without bounds, level by level.
void lay_out(Tree& tree, std::uint32_t leaves) {
  std::vector<std::uint32_t> level{leaves}, parts;  // leaves below each node of the level
  tree.blocks.push_back({});
  tree.blocks[0].count = 1;
  tree.level_begin = {0, 1};
  while (level.front() > 1) {
    std::vector<std::uint32_t> next;
    std::uint32_t parent = tree.level_begin[tree.level_begin.size() - 2], lane = 0;
    for (const std::uint32_t below : level) {
      const auto block = static_cast<std::uint32_t>(tree.blocks.size());
      if (lane == 0) tree.blocks[parent].first_child = block;
      const NodeId parent_node = parent * width + lane;
      if (++lane == tree.blocks[parent].count) lane = 0, ++parent;
      parts.clear();
      share(below, child_count(below), parts);
      tree.blocks.push_back({});
      tree.blocks.back().count = static_cast<std::uint32_t>(parts.size());
      tree.blocks.back().parent = parent_node;
      next.insert(next.end(), parts.begin(), parts.end());
    }
    tree.level_begin.push_back(static_cast<std::uint32_t>(tree.blocks.size()));
    level.swap(next);
  }
  std::uint32_t leaf = 0;
  for (std::uint32_t b = tree.lowest_level(); b < tree.blocks.size(); ++b) {
    tree.blocks[b].first_child = leaf;
    leaf += tree.blocks[b].count;
  }
  LIMBER_ASSERT(leaf == leaves);
}

std::size_t longest_side(const Item* begin, const Item* end) {
  std::array<float, 3> low = begin->middle, high = low;
  for (const Item* item = begin; item != end; ++item) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], item->middle[k]);
      high[k] = std::max(high[k], item->middle[k]);
    }
  }
  const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
}

void sort_into_leaves(Item* begin, Item* end);

/// Divides the items among that many children, and those on.
void divide(Item* begin, Item* end, std::uint32_t children) {
  if (children == 1) return sort_into_leaves(begin, end);
  const std::uint32_t leaves = leaf_count(static_cast<std::size_t>(end - begin));
  Item* const middle = begin + std::size_t{first_share(leaves, children)} * width;
  const std::size_t axis = longest_side(begin, end);
  std::nth_element(begin, middle, end, [axis](const Item& s, const Item& t) {
    return s.middle[axis] != t.middle[axis] ? s.middle[axis] < t.middle[axis] : s.triangle < t.triangle;
  });
  core::parallel_invoke(
      end - begin > 8192, [&] { divide(begin, middle, children / 2); },
      [&] { divide(middle, end, children - children / 2); });
}

void sort_into_leaves(Item* begin, Item* end) {
  const std::uint32_t leaves = leaf_count(static_cast<std::size_t>(end - begin));
  if (leaves > 1) divide(begin, end, child_count(leaves));
}

std::vector<Item> items_of(const Tree& tree, MeshView mesh, const Vec3& origin) {
  std::vector<Item> items(mesh.triangles.size());
  core::parallel_for(items.size(), 4096, [&](std::size_t t) {
    const Triangle corners = mesh.triangle(static_cast<TriangleId>(t));
    const Vec3 low = min(min(corners.v0, corners.v1), corners.v2), high = max(max(corners.v0, corners.v1), corners.v2);
    const Vec3 middle = ((low - origin) + (high - origin)) * (0.5 / tree.unit);
    items[t] = {{static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)},
                static_cast<TriangleId>(t)};
  });
  return items;
}

std::uint64_t new_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

Tree build(MeshView mesh) {
  LIMBER_ASSERT(!mesh.triangles.empty());
  Tree tree;
  tree.id = new_id();
  Vec3 low = mesh.triangle(0).v0, high = low;
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle corners = mesh.triangle(t);
    low = min(low, min(min(corners.v0, corners.v1), corners.v2));
    high = max(high, max(max(corners.v0, corners.v1), corners.v2));
  }
  const Vec3 middle = low * 0.5 + high * 0.5;
  tree.unit = unit_for(length(high - low), max_abs(low));
  LIMBER_ASSERT(tree.unit >= length(high - low));

  std::vector<Item> items = items_of(tree, mesh, middle);
  sort_into_leaves(items.data(), items.data() + items.size());
  const std::uint32_t leaves = leaf_count(items.size());
  lay_out(tree, leaves);
  tree.leaves.resize(leaves);
  core::parallel_for(leaves, 1024, [&](std::size_t leaf) {
    for (std::size_t k = 0; k < width; ++k) {
      tree.leaves[leaf].triangle[k] = items[std::min(leaf * width + k, items.size() - 1)].triangle;
    }
  });
  fit(tree, mesh);
  return tree;
}

}  // namespace limber::tree
