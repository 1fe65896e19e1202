// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/partition.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"

namespace limber::bvh {
namespace {

// Primitives below which another task costs more than it saves.
constexpr std::size_t worth_a_task = 8192;

// Primitives among which the median is found at once.
constexpr std::size_t few = 512;

// Primitives in one step of a split, and what each of them costs, in ns (bench/develop/partial_rebuild.cpp): in a pass,
// when it is moved, and when it is one of few.
constexpr std::size_t primitives_at_once = 1024;
constexpr double ns_per_primitive = 2, ns_per_move = 5, ns_per_one_of_few = 10;

/// A number that is larger for a larger coordinate.
std::uint32_t ordered(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x + 0.0F);  // -0 becomes 0
  return (bits >> 31) != 0 ? ~bits : bits | 0x80000000U;
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

Split::Split(const BuildRange& range)
    : range_(range),
      middle_(range.begin +
              std::size_t{first_half_leaves(leaf_count(range.end - range.begin), range.children)} * width),
      begin_(range.begin),
      end_(range.end),
      done_(range.begin) {
  LIMBER_ASSERT(range.children > 1);
  low_.fill(std::numeric_limits<float>::infinity());
  high_.fill(-std::numeric_limits<float>::infinity());
}

std::uint64_t Split::key(const PrimitiveRef& primitive) const {
  return std::uint64_t{ordered(primitive.center[axis_])} << 32 | primitive.triangle;
}

void Split::measure_some(std::span<const PrimitiveRef> primitives) {
  std::array<float, 3> low = low_, high = high_;
  for (const PrimitiveRef& primitive : primitives) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], primitive.center[k]);
      high[k] = std::max(high[k], primitive.center[k]);
    }
  }
  low_ = low, high_ = high;
}

void Split::choose_axis() {
  const float x = high_[0] - low_[0], y = high_[1] - low_[1], z = high_[2] - low_[2];
  axis_ = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
}

void Split::start_counting(std::uint64_t highest_key) {
  const auto bits = static_cast<unsigned>(std::bit_width(highest_key - lowest_key_));
  shift_ = bits > bin_bits ? bits - bin_bits : 0;
  counts_.fill(0);
  step_ = Step::counting, done_ = begin_;
}

void Split::choose_bin() {
  std::size_t before = begin_;
  for (bin_ = 0; before + counts_[bin_] <= middle_; ++bin_) before += counts_[bin_];
  step_ = Step::moving, done_ = below_ = begin_, above_ = end_;
}

void Split::move_some(std::span<PrimitiveRef> primitives) {
  for (std::size_t i = 0; i < primitives_at_once && done_ < above_; ++i) {
    const std::size_t found = bin(primitives[done_]);
    if (found < bin_) {
      std::swap(primitives[below_++], primitives[done_++]);
    } else if (found > bin_) {
      std::swap(primitives[--above_], primitives[done_]);
    } else {
      ++done_;
    }
  }
}

void Split::finish(std::span<PrimitiveRef> primitives) {
  const auto at = [&](std::size_t i) { return primitives.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin_), at(middle_), at(end_),
                   [&](const PrimitiveRef& s, const PrimitiveRef& t) { return key(s) < key(t); });
  step_ = Step::done;
}

bool Split::work(std::span<PrimitiveRef> primitives, core::WorkBudget& budget) {
  while (step_ != Step::done && !budget.is_spent()) {
    const std::size_t end = std::min(done_ + primitives_at_once, end_);
    const double count = static_cast<double>(end - done_);
    switch (step_) {
      case Step::measuring:
        budget.spend(ns_per_primitive * count);
        measure_some(primitives.subspan(done_, end - done_));
        done_ = end;
        if (done_ < end_) break;
        choose_axis();
        if (end_ - begin_ <= few) {
          step_ = Step::finishing;
          break;
        }
        lowest_key_ = std::uint64_t{ordered(low_[axis_])} << 32;
        start_counting(std::uint64_t{ordered(high_[axis_])} << 32 | no_id);
        break;
      case Step::counting:
        budget.spend(ns_per_primitive * count);
        for (; done_ < end; ++done_) ++counts_[bin(primitives[done_])];
        if (done_ == end_) choose_bin();
        break;
      case Step::moving:
        budget.spend(ns_per_move * count);
        move_some(primitives);
        if (done_ < above_) break;
        begin_ = below_, end_ = above_;
        lowest_key_ += std::uint64_t{bin_} << shift_;
        if (end_ - begin_ <= few) {
          step_ = Step::finishing;
        } else {
          start_counting(lowest_key_ + (std::uint64_t{1} << shift_) - 1);
        }
        break;
      case Step::finishing:
        budget.spend(ns_per_one_of_few * static_cast<double>(end_ - begin_));
        finish(primitives);
        break;
      case Step::done:
        break;
    }
  }
  return step_ == Step::done;
}

std::array<BuildRange, 2> Split::halves() const {
  LIMBER_ASSERT(step_ == Step::done);
  const auto half = [](std::size_t begin, std::size_t end, std::uint32_t children) {
    return children > 1 ? BuildRange{begin, end, children} : build_range(begin, end);
  };
  const std::uint32_t first = range_.children / 2;
  return {half(range_.begin, middle_, first), half(middle_, range_.end, range_.children - first)};
}

std::array<BuildRange, 2> split(std::span<PrimitiveRef> primitives, const BuildRange& range) {
  Split split(range);
  core::WorkBudget unlimited = core::WorkBudget::unlimited();
  split.work(primitives, unlimited);
  return split.halves();
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
  TriangleId* const end = std::transform(primitives.begin(), primitives.end(), leaf.triangle,
                                         [](const PrimitiveRef& primitive) { return primitive.triangle; });
  // Splits leave the order within a leaf to the standard library; queries are to find pairs in the same order anywhere.
  std::sort(leaf.triangle, end);
  std::fill(end, leaf.triangle + width, *(end - 1));
  for (std::size_t k = 0; k < width; ++k) leaf.vertices[k] = mesh.triangles[leaf.triangle[k]];
}

std::span<const PrimitiveRef> primitives_of_leaf(std::span<const PrimitiveRef> primitives, std::size_t i) {
  return primitives.subspan(i * width, std::min(primitives.size() - i * width, std::size_t{width}));
}

std::uint64_t new_assignment_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace limber::bvh
