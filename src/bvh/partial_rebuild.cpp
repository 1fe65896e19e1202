// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/partial_rebuild.h"

#include <algorithm>
#include <bit>

#include "core/check.h"

namespace limber::bvh {
namespace {

// Splitting ends on fewer than 2^31 leaves, and leaves at most one range behind at each depth.
constexpr std::size_t max_ranges = 64;

// Ranges of up to that many primitives are partitioned in one step of work().
constexpr std::size_t primitives_at_once = 4096;

}  // namespace

PartialRebuild::PartialRebuild(const Tree& tree, MeshView mesh, const Subtree& subtree) : subtree_(subtree) {
  const std::size_t begin = std::size_t{subtree.first_leaf} * width;
  const std::size_t end = std::min(std::size_t{subtree.end_leaf} * width, mesh.triangles.size());
  LIMBER_ASSERT(begin < end);
  const auto triangle = [&](std::size_t i) { return tree.leaves[i / width].triangle[i % width]; };
  // The box of the present positions: the bounds of the tree may be those of earlier ones.
  BoundingBox box;
  for (std::size_t i = begin; i < end; ++i) box.add(mesh.triangle(triangle(i)));
  const Vec3 center = box.center();
  const double unit = box.unit();
  primitives_.reserve(end - begin);
  for (std::size_t i = begin; i < end; ++i) primitives_.push_back(primitive_of(mesh, triangle(i), center, unit));
  ranges_.reserve(max_ranges);
  ranges_.push_back(build_range(0, primitives_.size()));
}

bool PartialRebuild::work(double budget) {
  while (!ranges_.empty() && budget > 0) {
    const BuildRange range = ranges_.back();
    ranges_.pop_back();
    const std::size_t size = range.end - range.begin;
    if (size <= primitives_at_once) {
      partition_into_leaves(primitives_, range);
      budget -= static_cast<double>(size) * static_cast<double>(std::bit_width(size / width));
      continue;
    }
    budget -= static_cast<double>(size);
    for (const BuildRange& half : split(primitives_, range)) {
      if (half.children <= 1) continue;
      LIMBER_ASSERT(ranges_.size() < ranges_.capacity());
      ranges_.push_back(half);
    }
  }
  return ranges_.empty();
}

void PartialRebuild::finish() {
  for (const BuildRange& range : ranges_) partition_into_leaves(primitives_, range);
  ranges_.clear();
}

void PartialRebuild::apply(Tree& tree, MeshView mesh) const {
  LIMBER_ASSERT(ranges_.empty());
  for (std::uint32_t leaf = subtree_.first_leaf; leaf < subtree_.end_leaf; ++leaf) {
    write_leaf(tree.leaves[leaf], mesh, primitives_of_leaf(primitives_, leaf - subtree_.first_leaf));
  }
  tree.assignment_id = new_assignment_id();
  tree.displacement = 0;
}

}  // namespace limber::bvh
