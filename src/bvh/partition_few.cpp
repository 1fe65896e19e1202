// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/partition_few.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "base/check.h"
#include "simd/kernels.h"

namespace limber::bvh {
namespace {

/// A box as two times four floats, the last unused: a register each.
struct FloatBox {
  alignas(16) float low[4], high[4];
};

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr FloatBox no_box{{infinity, infinity, infinity, infinity}, {-infinity, -infinity, -infinity, -infinity}};

void extend(FloatBox& box, const FloatBox& by) {
  for (int k = 0; k < 4; ++k) box.low[k] = std::min(box.low[k], by.low[k]);
  for (int k = 0; k < 4; ++k) box.high[k] = std::max(box.high[k], by.high[k]);
}

/// Half the surface area of a box.
float half_area(const FloatBox& box) {
  const float x = box.high[0] - box.low[0], y = box.high[1] - box.low[1], z = box.high[2] - box.low[2];
  return x * y + y * z + z * x;
}

FloatBox box_of(const PrimitiveSource& source, TriangleId triangle) {
  FloatBox box = no_box;
  for (const VertexId v : source.mesh.triangles[triangle]) {
    const Vec3 p = (source.mesh.positions[v] - source.origin) * (2 * source.half_per_unit);
    const FloatBox point{{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0},
                         {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0}};
    extend(box, point);
  }
  return box;
}

/// Primitives with their boxes and sizes, in one order.
class FewPrimitives {
 public:
  FewPrimitives(std::span<const PrimitiveRef> primitives, const PrimitiveSource& source) {
    LIMBER_ASSERT(primitives.size() <= simd::few_points);
    std::copy(primitives.begin(), primitives.end(), by_center_.begin());
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const TriangleId triangle = primitives[i].triangle;
      boxes_[i] = box_of(source, triangle);
      const float x = boxes_[i].high[0] - boxes_[i].low[0], y = boxes_[i].high[1] - boxes_[i].low[1],
                  z = boxes_[i].high[2] - boxes_[i].low[2];
      by_size_[i] = {{x * x + y * y + z * z, 0, 0}, triangle};
    }
  }

  /// Moves the better half of a range to its front: `rank` primitives.
  void split(std::size_t begin, std::size_t end, std::size_t rank) {
    const std::size_t count = end - begin;
    std::uint64_t best = 0;
    float least = infinity;
    for (std::size_t axis = 0; axis < 4; ++axis) {
      const auto& keys = axis < 3 ? by_center_ : by_size_;
      const std::uint64_t first = least_of_few(std::span(keys).subspan(begin, count), axis % 3, rank);
      const float cost =
          area_times_count(begin, first, rank) + area_times_count(begin, all_of(count) & ~first, count - rank);
      if (axis == 0 || cost < least) best = first, least = cost;
    }
    move_to_front(by_center_, begin, count, best);
    move_to_front(by_size_, begin, count, best);
    move_to_front(boxes_, begin, count, best);
  }

  std::span<const PrimitiveRef> first(std::size_t count) const { return std::span(by_center_).first(count); }

 private:
  template <typename T>
  using Few = std::array<T, simd::few_points>;

  static std::uint64_t all_of(std::size_t count) { return ~std::uint64_t{0} >> (simd::few_points - count); }

  /// The surface area of the box of some primitives, times their number.
  float area_times_count(std::size_t begin, std::uint64_t which, std::size_t count) const {
    FloatBox box = no_box;
    for (; which != 0; which &= which - 1)
      extend(box, boxes_[begin + static_cast<std::size_t>(std::countr_zero(which))]);
    return half_area(box) * static_cast<float>(count);
  }

  /// Moves those whose bits are set before the others; both keep their order.
  template <typename T>
  static void move_to_front(Few<T>& all, std::size_t begin, std::size_t count, std::uint64_t which) {
    const Few<T> before = all;
    std::size_t to = begin;
    for (std::uint64_t rest = which; rest != 0; rest &= rest - 1) {
      all[to++] = before[begin + static_cast<std::size_t>(std::countr_zero(rest))];
    }
    for (std::uint64_t rest = all_of(count) & ~which; rest != 0; rest &= rest - 1) {
      all[to++] = before[begin + static_cast<std::size_t>(std::countr_zero(rest))];
    }
  }

  Few<PrimitiveRef> by_center_, by_size_;  // the first coordinate of `by_size_` is the squared diagonal of the box
  Few<FloatBox> boxes_;
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
  // Centers as kernels take points: four floats each. They do not use the fourth, which is the triangle's id.
  static_assert(sizeof(PrimitiveRef) == 4 * sizeof(float));
  const float* const points = primitives.data()->center.data();
  simd::FewLeast found = simd::kernels().least_of_few(points, axis, primitives.size(), n);
  // The kernel finds more than n where several share the greatest coordinate: drops the largest triangle ids there.
  for (auto count = static_cast<std::size_t>(std::popcount(found.least)); count > n; --count) {
    auto last = std::countr_zero(found.greatest);
    for (std::uint64_t others = found.greatest; others != 0; others &= others - 1) {
      const int other = std::countr_zero(others);
      if (primitives[other].triangle > primitives[last].triangle) last = other;
    }
    found.greatest &= ~(std::uint64_t{1} << last), found.least &= ~(std::uint64_t{1} << last);
  }
  return found.least;
}

void partition_few(std::span<PrimitiveRef> primitives, const BuildRange& range, const PrimitiveSource& source) {
  const std::span<PrimitiveRef> used = primitives.subspan(range.begin, range.end - range.begin);
  FewPrimitives few(used, source);
  partition(few, {0, used.size(), range.children});
  std::copy_n(few.first(used.size()).begin(), used.size(), used.begin());
}

}  // namespace limber::bvh
