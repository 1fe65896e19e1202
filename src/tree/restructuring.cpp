// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tree/restructuring.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/check.h"

namespace limber::tree {
namespace {

/// Of the leaves of a block of the lowest level, in squared units.
double measure(const Block& block) {
  double sum = 0;
  for (std::uint32_t k = 0; k < block.count; ++k) {
    const auto radius = static_cast<double>(block.bounds.radius[k]);
    sum += radius * radius;
  }
  return sum;
}

/// The same for the root, which is what others are compared with.
double root_measure(const Tree& tree) { return std::max(measure(tree.blocks[0]), 0x1p-100); }

std::uint32_t lowest_block_of(const Tree& tree, std::uint32_t leaf) {
  const auto begin = tree.blocks.begin() + tree.lowest_level();
  const auto after = std::upper_bound(begin, tree.blocks.end(), leaf,
                                      [](std::uint32_t l, const Block& block) { return l < block.first_child; });
  return static_cast<std::uint32_t>(after - begin) - 1;
}

}  // namespace

Subtree subtree_of(const Tree& tree, NodeId node) {
  LIMBER_ASSERT(lane_of(node) < tree.blocks[block_of(node)].count);
  NodeId first = node, last = node;
  while (block_of(first) < tree.lowest_level()) {
    first = (tree.blocks[block_of(first)].first_child + lane_of(first)) * width;
    const std::uint32_t block = tree.blocks[block_of(last)].first_child + lane_of(last);
    last = block * width + tree.blocks[block].count - 1;
  }
  return {node, tree.blocks[block_of(first)].first_child + lane_of(first),
          tree.blocks[block_of(last)].first_child + lane_of(last) + 1};
}

void Quality::set(const Tree& tree, const Subtree& subtree) {
  expected_.resize(tree.blocks.size() - tree.lowest_level());
  const double whole = root_measure(tree);
  const std::uint32_t end = lowest_block_of(tree, subtree.end_leaf - 1);
  for (std::uint32_t b = lowest_block_of(tree, subtree.first_leaf); b <= end; ++b) {
    expected_[b] = static_cast<float>(measure(tree.blocks[tree.lowest_level() + b]) / whole);
  }
}

double Quality::sum(const Tree& tree, const Subtree& subtree) {
  double sum = 0;
  const std::uint32_t end = lowest_block_of(tree, subtree.end_leaf - 1);
  for (std::uint32_t b = lowest_block_of(tree, subtree.first_leaf); b <= end; ++b) {
    sum += measure(tree.blocks[tree.lowest_level() + b]);
  }
  return sum / root_measure(tree);
}

namespace {

/// Sums over the blocks of the lowest level before each.
struct Sums {
  std::vector<double> expected, excess;

  /// Of the blocks of a subtree.
  static double of(const std::vector<double>& sums, const Tree& tree, NodeId node) {
    const Subtree s = subtree_of(tree, node);
    return sums[lowest_block_of(tree, s.end_leaf - 1) + 1] - sums[lowest_block_of(tree, s.first_leaf)];
  }
};

/// First child of a node whose children are not on the lowest level; none otherwise.
std::optional<std::uint32_t> block_to_look_into(const Tree& tree, NodeId node) {
  if (block_of(node) >= tree.lowest_level()) return std::nullopt;
  const std::uint32_t below = tree.blocks[block_of(node)].first_child + lane_of(node);
  return below < tree.lowest_level() ? std::optional(below) : std::nullopt;
}

/// The node with most excess among those of the upper levels that are worse than tolerated, each compared with itself.
std::optional<NodeId> intolerable(const Tree& tree, const Sums& sums, double most, NodeId node, int levels) {
  const double excess = Sums::of(sums.excess, tree, node);
  if (excess > (most - 1) * Sums::of(sums.expected, tree, node)) return node;
  const std::optional<std::uint32_t> below = block_to_look_into(tree, node);
  if (!below || levels == 0) return std::nullopt;
  std::optional<NodeId> worst;
  for (std::uint32_t k = 0; k < tree.blocks[*below].count; ++k) {
    const std::optional<NodeId> found = intolerable(tree, sums, most, *below * width + k, levels - 1);
    if (!found) continue;
    if (!worst || Sums::of(sums.excess, tree, *found) > Sums::of(sums.excess, tree, *worst)) worst = found;
  }
  return worst;
}

}  // namespace

std::optional<Subtree> Quality::worst(const Tree& tree, double most) const {
  const double whole = root_measure(tree);
  Sums sums{std::vector<double>(expected_.size() + 1), std::vector<double>(expected_.size() + 1)};
  for (std::size_t b = 0; b < expected_.size(); ++b) {
    const auto usual = static_cast<double>(expected_[b]);
    const double now = measure(tree.blocks[tree.lowest_level() + b]) / whole;
    sums.expected[b + 1] = sums.expected[b] + usual;
    sums.excess[b + 1] = sums.excess[b] + std::max(0.0, now - usual);
  }
  constexpr int levels = 2;
  std::optional<NodeId> node = intolerable(tree, sums, most, root, levels);
  if (!node) return std::nullopt;
  // Down while one child has nearly all of it.
  while (const std::optional<std::uint32_t> below = block_to_look_into(tree, *node)) {
    NodeId worst_child = *below * width;
    for (std::uint32_t k = 1; k < tree.blocks[*below].count; ++k) {
      const NodeId child = *below * width + k;
      if (Sums::of(sums.excess, tree, child) > Sums::of(sums.excess, tree, worst_child)) worst_child = child;
    }
    constexpr double nearly_all = 0.9;
    if (Sums::of(sums.excess, tree, worst_child) < nearly_all * Sums::of(sums.excess, tree, *node)) break;
    node = worst_child;
  }
  return subtree_of(tree, *node);
}

Restructuring::Restructuring(const Tree& tree, MeshView mesh, const Subtree& subtree) : subtree_(subtree) {
  const std::size_t begin = std::size_t{subtree.first_leaf} * width;
  const std::size_t end = std::min(std::size_t{subtree.end_leaf} * width, mesh.triangles.size());
  LIMBER_ASSERT(begin < end);
  const auto triangle = [&](std::size_t i) { return tree.leaves[i / width].triangle[i % width]; };
  // By where they are now, which the tree may not have been told yet.
  Extent extent;
  for (std::size_t i = begin; i < end; ++i) extent.put(mesh.triangle(triangle(i)));
  const Vec3 middle = extent.middle();
  const double unit = extent.unit();
  items_.reserve(end - begin);
  for (std::size_t i = begin; i < end; ++i) items_.push_back(item_of(mesh, triangle(i), middle, unit));
  // Halving ends on fewer than 2^31 leaves, and leaves at most one part behind at each depth.
  constexpr std::size_t most_parts = 64;
  parts_.reserve(most_parts);
  parts_.push_back(part_of(0, items_.size()));
}

bool Restructuring::work(double budget) {
  constexpr std::size_t at_once = 4096;
  while (!parts_.empty() && budget > 0) {
    const Part part = parts_.back();
    parts_.pop_back();
    const std::size_t size = part.end - part.begin;
    if (size <= at_once) {
      sort_into_leaves(items_, part);
      budget -= static_cast<double>(size) * static_cast<double>(std::bit_width(size / width));
      continue;
    }
    budget -= static_cast<double>(size);
    for (const Part& half : halve(items_, part)) {
      if (half.children <= 1) continue;
      LIMBER_ASSERT(parts_.size() < parts_.capacity());
      parts_.push_back(half);
    }
  }
  return parts_.empty();
}

void Restructuring::finish() {
  for (const Part& part : parts_) sort_into_leaves(items_, part);
  parts_.clear();
}

void Restructuring::apply(Tree& tree, MeshView mesh) const {
  LIMBER_ASSERT(parts_.empty());
  try {
    write_leaves(tree, mesh, subtree_.first_leaf, items_);
  } catch (const std::bad_alloc&) {
    // Few enough at once for one thread.
    constexpr std::size_t leaves_at_once = 1024;
    const std::span<const Item> items(items_);
    for (std::size_t leaf = 0; leaf * width < items.size(); leaf += leaves_at_once) {
      const std::size_t first = leaf * width;
      write_leaves(tree, mesh, subtree_.first_leaf + static_cast<std::uint32_t>(leaf),
                   items.subspan(first, std::min(leaves_at_once * width, items.size() - first)));
    }
  }
  tree.id = new_id();
  tree.motion = 0;
}

}  // namespace limber::tree
