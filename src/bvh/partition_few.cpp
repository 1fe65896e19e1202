// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The surface area heuristic over the medians along the axes and of the sizes; see partition_few().
#include "bvh/partition.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "base/check.h"
#include "base/error_bounds.h"
#include "simd/kernels.h"

namespace limber::bvh {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

using simd::BoxRow;

float side(const BoxRow& box, int axis) { return -box.least[4 + axis] - box.least[axis]; }
float half_area(const BoxRow& box) {
  const float x = side(box, 0), y = side(box, 1), z = side(box, 2);
  return x * y + y * z + z * x;
}
float diagonal_sq(const BoxRow& box) {
  const float x = side(box, 0), y = side(box, 1), z = side(box, 2);
  return x * x + y * y + z * z;
}

/// The box of a triangle. A model that grows beyond float32 while it is rebuilt has infinite numbers: they are made
/// finite, so that no difference of them is NaN.
BoxRow box_of(const PrimitiveRef& primitive, const HalfSides& half_sides) {
  constexpr auto most = static_cast<float>(base::max_units);
  BoxRow box{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float center = std::clamp(primitive.center[axis], -most, most), half = std::min(half_sides[axis], most);
    box.least[axis] = center - half, box.least[4 + axis] = -(center + half);
  }
  return box;
}

/// Primitives with their boxes and sizes, in one order. In `by_size_` the squared diagonal of a triangle's box takes
/// the place of the first coordinate, so that least_of_few() can sort by it.
class FewPrimitives {
 public:
  FewPrimitives(std::span<const PrimitiveRef> primitives, std::span<const HalfSides> half_sides) {
    LIMBER_ASSERT(primitives.size() <= simd::few_points);
    std::copy(primitives.begin(), primitives.end(), by_center_.begin());
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const TriangleId triangle = primitives[i].triangle;
      boxes_[i] = box_of(primitives[i], half_sides[triangle]);
      by_size_[i] = {{diagonal_sq(boxes_[i]), 0, 0}, triangle};
    }
  }

  /// Splits a range into its first `rank` primitives and the others: of the medians along the long axes and of the
  /// sizes, the one of least cost.
  void split(std::size_t begin, std::size_t end, std::size_t rank) {
    const std::span<const PrimitiveRef> centers = std::span(by_center_).subspan(begin, end - begin);
    simd::PointBox box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    simd::kernels().extend_box(as_points(centers.data()), centers.size(), box);
    const float sides[3] = {box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]};
    const float longest = std::max({sides[0], sides[1], sides[2]});
    std::uint64_t best = 0;
    float least_cost = infinity;
    const auto attempt = [&](std::uint64_t first) {
      const float cost =
          cost_of(begin, first, rank) + cost_of(begin, all_of(centers.size()) & ~first, end - begin - rank);
      if (best == 0 || cost < least_cost) best = first, least_cost = cost;
    };
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_long = sides[axis] >= worth_splitting * longest;
      if (is_long) attempt(least_of_few(centers, static_cast<std::size_t>(axis), rank));
    }
    const std::span<const PrimitiveRef> sizes = std::span(by_size_).subspan(begin, end - begin);
    float smallest = infinity, largest = 0;
    for (const PrimitiveRef& size : sizes) {
      smallest = std::min(smallest, size.center[0]), largest = std::max(largest, size.center[0]);
    }
    if (largest > different_size_sq * smallest) attempt(least_of_few(sizes, 0, rank));
    // A model that grows beyond float32 while it is rebuilt has no longest side. Any split will do.
    if (best == 0) best = least_of_few(centers, 0, rank);
    move_to_front(by_center_, begin, end, best);
    move_to_front(by_size_, begin, end, best);
    move_to_front(boxes_, begin, end, best);
  }

  std::span<const PrimitiveRef> first(std::size_t count) const { return std::span(by_center_).first(count); }

 private:
  template <typename T>
  using Few = std::array<T, simd::few_points>;

  // Shorter sides of the box of the centers, as parts of the longest, are not worth a split.
  static constexpr float worth_splitting = 0.25F;
  // Sizes matter if the largest squared diagonal is that many times the smallest.
  static constexpr float different_size_sq = 2;

  static std::uint64_t all_of(std::size_t count) { return ~std::uint64_t{0} >> (simd::few_points - count); }

  /// The surface area of the box of some primitives, times their number.
  float cost_of(std::size_t begin, std::uint64_t which, std::size_t count) const {
    return half_area(simd::kernels().join_rows(boxes_.data() + begin, which)) * static_cast<float>(count);
  }

  /// Moves those of a range whose bits are set before the others; both keep their order.
  template <typename T>
  static void move_to_front(Few<T>& all, std::size_t begin, std::size_t end, std::uint64_t which) {
    std::array<T, simd::few_points> others;
    std::size_t to = begin, other_count = 0;
    for (std::size_t i = begin; i < end; ++i, which >>= 1) {
      others[other_count] = all[i];
      all[to] = all[i];
      to += which & 1, other_count += 1 - (which & 1);
    }
    std::copy_n(others.begin(), other_count, all.begin() + static_cast<std::ptrdiff_t>(to));
  }

  Few<PrimitiveRef> by_center_, by_size_;
  Few<BoxRow> boxes_;
};

void partition(FewPrimitives& few, const BuildRange& range) {
  if (range.children <= 1) return;
  const std::size_t middle = middle_of(range);
  few.split(range.begin, range.end, middle - range.begin);
  for (const BuildRange& half : halves_of(range, middle)) partition(few, half);
}

}  // namespace

std::uint64_t least_of_few(std::span<const PrimitiveRef> primitives, std::size_t axis, std::size_t n) {
  if (n == 0) return 0;
  simd::FewLeast found = simd::kernels().least_of_few(as_points(primitives.data()), axis, primitives.size(), n);
  // The kernel finds more than n where several share the greatest coordinate: drops the largest triangle ids there.
  for (auto count = static_cast<std::size_t>(std::popcount(found.least)); count > n; --count) {
    auto last = std::countr_zero(found.greatest);
    for (std::uint64_t others = found.greatest; others != 0; others &= others - 1) {
      const int other = std::countr_zero(others);
      if (primitives[other].triangle > primitives[last].triangle) last = other;
    }
    found.greatest &= ~(std::uint64_t{1} << last), found.least &= ~(std::uint64_t{1} << last);
  }
  LIMBER_ASSERT(static_cast<std::size_t>(std::popcount(found.least)) == n);
  return found.least;
}

void partition_few(std::span<PrimitiveRef> primitives, const BuildRange& range, std::span<const HalfSides> half_sides) {
  const std::span<PrimitiveRef> used = primitives.subspan(range.begin, range.end - range.begin);
  FewPrimitives few(used, half_sides);
  partition(few, {0, used.size(), range.children});
  std::copy_n(few.first(used.size()).begin(), used.size(), used.begin());
}

}  // namespace limber::bvh
