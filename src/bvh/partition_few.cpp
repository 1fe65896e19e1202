// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Splits few primitives down to leaves. A range is split at a median along an axis or of the sizes of boxes: the one of
// least cost by the surface area heuristic; see partition_few().
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

/// The sides of a box. A BoxRow is low.x, low.y, low.z, -, -high.x, -high.y, -high.z, -: so the row of a box around
/// others is the minimum of their rows, number by number.
std::array<float, 3> sides_of(const BoxRow& box) {
  const auto side = [&](int axis) { return -box.least[4 + axis] - box.least[axis]; };
  return {side(0), side(1), side(2)};
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

/// Primitives with their sizes and boxes: three arrays in one order, that of the leaves once all is split. A size is
/// the squared diagonal of a triangle's box. It takes the place of the first coordinate, so that least_of_few() can
/// compare it. Some primitives of a range are a mask, in which bit i stands for the i-th.
class FewPrimitives {
 public:
  FewPrimitives(std::span<const PrimitiveRef> primitives, std::span<const HalfSides> half_sides) {
    LIMBER_ASSERT(primitives.size() <= simd::few_points);
    std::copy(primitives.begin(), primitives.end(), centers_.begin());
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const TriangleId triangle = primitives[i].triangle;
      boxes_[i] = box_of(primitives[i], half_sides[triangle]);
      const auto [x, y, z] = sides_of(boxes_[i]);
      sizes_[i] = {{x * x + y * y + z * z, 0, 0}, triangle};
    }
  }

  /// Splits a range down to leaves.
  void split_into_leaves(const BuildRange& range) {
    if (range.children <= 1) return;
    const std::size_t middle = middle_of(range);
    split(range.begin, range.end, middle - range.begin);
    for (const BuildRange& half : halves_of(range, middle)) split_into_leaves(half);
  }

  std::span<const PrimitiveRef> in_order(std::size_t count) const { return std::span(centers_).first(count); }

 private:
  template <typename T>
  using Few = std::array<T, simd::few_points>;

  static_assert(simd::few_points == 64, "a mask has a bit for each");
  // Choices that save attempts; no answer depends on them. Sides of the box of the centers that are shorter than this
  // part of the longest are not tried; nor are sizes, unless the largest is this many times the smallest.
  static constexpr float worth_splitting = 0.25F, different_size_sq = 2;

  /// Splits a range into its first `rank` primitives and the others: of the medians along the long axes and of the
  /// sizes, the one of least cost. Pre: rank > 0.
  void split(std::size_t begin, std::size_t end, std::size_t rank) {
    const std::span<const PrimitiveRef> centers = std::span(centers_).subspan(begin, end - begin);
    simd::PointBox box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    simd::kernels().extend_box(as_points(centers.data()), centers.size(), box);
    const float sides[3] = {box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]};
    const float longest = std::max({sides[0], sides[1], sides[2]});
    std::uint64_t best = 0;  // none yet: a first part is never empty
    float least_cost = infinity;
    const auto attempt = [&](std::uint64_t first) {
      const std::uint64_t others = ~std::uint64_t{0} >> (simd::few_points - centers.size()) & ~first;
      const float cost = cost_of(begin, first, rank) + cost_of(begin, others, end - begin - rank);
      if (best == 0 || cost < least_cost) best = first, least_cost = cost;
    };
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_long = sides[axis] >= worth_splitting * longest;
      if (is_long) attempt(least_of_few(centers, static_cast<std::size_t>(axis), rank));
    }
    const std::span<const PrimitiveRef> sizes = std::span(sizes_).subspan(begin, end - begin);
    float smallest = infinity, largest = 0;
    for (const PrimitiveRef& size : sizes) {
      smallest = std::min(smallest, size.center[0]), largest = std::max(largest, size.center[0]);
    }
    if (largest > different_size_sq * smallest) attempt(least_of_few(sizes, 0, rank));
    // A model that grows beyond float32 while it is rebuilt has no longest side. Any split will do.
    if (best == 0) best = least_of_few(centers, 0, rank);
    move_to_front(centers_, begin, end, best);
    move_to_front(sizes_, begin, end, best);
    move_to_front(boxes_, begin, end, best);
  }

  /// Half the surface area of the box of some primitives of the range from `begin` on, times their number.
  float cost_of(std::size_t begin, std::uint64_t which, std::size_t count) const {
    const auto [x, y, z] = sides_of(simd::kernels().join_rows(boxes_.data() + begin, which));
    return (x * y + y * z + z * x) * static_cast<float>(count);
  }

  /// Moves those of a range whose bits are set before the others; both keep their order.
  template <typename T>
  static void move_to_front(Few<T>& all, std::size_t begin, std::size_t end, std::uint64_t which) {
    Few<T> others;
    std::size_t to = begin, other_count = 0;
    for (std::size_t i = begin; i < end; ++i, which >>= 1) {
      // Both are written, so that there is no branch. As to <= i, all[to] has been read.
      others[other_count] = all[i];
      all[to] = all[i];
      to += which & 1, other_count += 1 - (which & 1);
    }
    std::copy_n(others.begin(), other_count, all.begin() + static_cast<std::ptrdiff_t>(to));
  }

  Few<PrimitiveRef> centers_, sizes_;
  Few<BoxRow> boxes_;
};

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
  few.split_into_leaves({0, used.size(), range.children});
  const auto in_order = few.in_order(used.size());
  std::copy(in_order.begin(), in_order.end(), used.begin());
}

}  // namespace limber::bvh
