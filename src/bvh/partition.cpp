// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/partition.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/parallel.h"
#include "simd/kernels.h"

namespace limber::bvh {
namespace {

// Primitives below which another task costs more than it saves (docs/design/fast_engine.md).
constexpr std::size_t worth_a_task = 8192;

// A bounding box is found in parts: at least so many triangles in each, and at most so many parts.
constexpr std::size_t triangles_per_box = 8192, most_boxes = 64;

// Primitives among which the median is found at once: by quickselect, or by counting up to simd::few_points.
constexpr std::size_t few = 512;

// Primitives of a sample, and how far from the median of it those are between which the median of all is likely to be:
// two standard deviations.
constexpr std::size_t sample_size = 128, sample_margin = 12;

// Primitives in one step of a split, and what each of them costs at most, in ns (docs/design/real_time.md): in a
// pass, in a pass that moves some, and when it is one of few.
constexpr std::size_t primitives_at_once = 1024;
constexpr double ns_per_primitive = 2, ns_per_move = 5, ns_per_one_of_few = 10;

/// Moves those of the primitives `begin` to `end` for which is_first() holds, by their index, before the others. Those
/// from `first_end` to `begin` are not. Returns where the first ones end then. No branch depends on the primitives:
/// nobody could predict it.
template <typename IsFirst>
std::size_t move_first(std::span<PrimitiveRef> primitives, std::size_t first_end, std::size_t begin, std::size_t end,
                       const IsFirst& is_first) {
  for (std::size_t i = begin; i < end; ++i) {
    // Before the primitive is copied: to read one coordinate of a copy, GCC writes it to memory first.
    const bool goes_first = is_first(i);
    const PrimitiveRef primitive = primitives[i];
    primitives[i] = primitives[first_end];
    primitives[first_end] = primitive;
    first_end += goes_first ? 1 : 0;
  }
  return first_end;
}

/// The `n`-th least of some numbers, from 0 on; their order changes. By quickselect, again without branches on
/// single numbers.
std::uint64_t nth_least(std::span<std::uint64_t> numbers, std::size_t n) {
  LIMBER_ASSERT(n < numbers.size());
  while (true) {
    const std::size_t last = numbers.size() - 1;
    std::uint64_t &low = numbers[0], &middle = numbers[last / 2], &high = numbers[last];
    // The median of the three becomes the last.
    if (low > middle) std::swap(low, middle);
    if (middle < high) std::swap(middle, high);
    if (low > high) std::swap(low, high);
    const std::uint64_t pivot = high;
    std::size_t less = 0;
    for (std::size_t i = 0; i < last; ++i) {
      const std::uint64_t number = numbers[i];
      numbers[i] = numbers[less];
      numbers[less] = number;
      less += number < pivot ? 1 : 0;
    }
    if (n == less) return pivot;
    if (n < less) {
      numbers = numbers.first(less);
    } else {
      // The pivot is at the end; what was not less is between.
      numbers = numbers.subspan(less, last - less);
      n -= less + 1;
    }
  }
}

/// A number that is larger for a larger coordinate.
std::uint32_t ordered(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x + 0.0F);  // -0 becomes 0
  return (bits >> 31) != 0 ? ~bits : bits | 0x80000000U;
}
/// The coordinate of such a number.
float unordered(std::uint32_t number) {
  return std::bit_cast<float>((number >> 31) != 0 ? number & 0x7fffffffU : ~number);
}

/// The `n` least of at most simd::few_points primitives along an axis, of equal ones those of the first triangles, as a
/// bit mask.
std::uint64_t least_of_few(std::span<const PrimitiveRef> primitives, std::size_t axis, std::size_t n) {
  if (n == 0) return 0;
  simd::FewLeast found = simd::kernels().least_of_few(primitives.front().center.data(), axis, primitives.size(), n);
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
      done_(range.begin),
      random_(range.end - range.begin) {
  LIMBER_ASSERT(range.children > 1);
  std::fill(std::begin(box_.low), std::end(box_.low), std::numeric_limits<float>::infinity());
  std::fill(std::begin(box_.high), std::end(box_.high), -std::numeric_limits<float>::infinity());
}

std::uint64_t Split::key(const PrimitiveRef& primitive) const {
  return std::uint64_t{ordered(primitive.center[axis_])} << 32 | primitive.triangle;
}

void Split::choose_axis() {
  const float x = box_.high[0] - box_.low[0], y = box_.high[1] - box_.low[1], z = box_.high[2] - box_.low[2];
  axis_ = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
}

void Split::search(std::size_t begin, std::size_t end) {
  // Too many are left: many coordinates may be equal, which only keys tell apart.
  moves_by_key_ |= 4 * (end - begin) > 3 * (end_ - begin_);
  begin_ = begin, end_ = end;
  step_ = end_ - begin_ <= few ? Step::finishing : Step::sampling;
}

void Split::sample(std::span<const PrimitiveRef> primitives) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::size_t count = end_ - begin_;
  std::array<std::uint64_t, sample_size> keys;
  // At random: what is taken at equal steps might be one row of a grid. The random numbers are those of Knuth's MMIX.
  for (std::uint64_t& k : keys) {
    random_ = random_ * 6364136223846793005 + 1442695040888963407;
    k = key(primitives[begin_ + static_cast<std::size_t>((random_ >> 32) * count >> 32)]);
  }
  const std::size_t at = (middle_ - begin_) * sample_size / count;
  lower_ = {0, -infinity}, upper_ = {std::numeric_limits<std::uint64_t>::max(), infinity};
  if (at >= sample_margin) {
    lower_.key = nth_least(keys, at - sample_margin);
    lower_.coordinate = unordered(static_cast<std::uint32_t>(lower_.key >> 32));
  }
  if (at + sample_margin < sample_size) {
    const std::uint64_t last = nth_least(keys, at + sample_margin);
    upper_ = {last + 1, std::nextafter(unordered(static_cast<std::uint32_t>(last >> 32)), infinity)};
  }
  step_ = Step::moving_below, done_ = below_ = begin_;
}

std::size_t Split::move_below(std::span<PrimitiveRef> primitives, std::size_t first_end, std::size_t end,
                              const Limit& limit) const {
  if (moves_by_key_) {
    const auto is_below = [&](std::size_t i) { return key(primitives[i]) < limit.key; };
    return move_first(primitives, first_end, done_, end, is_below);
  }
  const auto is_below = [&, axis = axis_, most = limit.coordinate](std::size_t i) {
    return primitives[i].center[axis] < most;
  };
  return move_first(primitives, first_end, done_, end, is_below);
}

void Split::finish(std::span<PrimitiveRef> primitives) {
  const std::span<PrimitiveRef> rest = primitives.subspan(begin_, end_ - begin_);
  const std::size_t first_count = middle_ - begin_;
  step_ = Step::done;
  if (rest.size() <= simd::few_points) {
    const std::uint64_t least = least_of_few(rest, axis_, first_count);
    const auto is_least = [least](std::size_t i) { return (least >> i & 1) != 0; };
    const std::size_t moved = move_first(rest, 0, 0, rest.size(), is_least);
    LIMBER_ASSERT(moved == first_count);
    return;
  }
  std::array<std::uint64_t, few> keys;
  const std::span<std::uint64_t> used = std::span(keys).first(rest.size());
  for (std::size_t i = 0; i < used.size(); ++i) used[i] = key(rest[i]);
  const std::uint64_t median = nth_least(used, first_count);
  // The same as comparing keys, but without computing them once more.
  const float coordinate = unordered(static_cast<std::uint32_t>(median >> 32));
  const auto triangle = static_cast<TriangleId>(median);
  const auto is_below = [&, axis = axis_](std::size_t i) {
    const float x = rest[i].center[axis];
    return (static_cast<int>(x < coordinate) |
            (static_cast<int>(x == coordinate) & static_cast<int>(rest[i].triangle < triangle))) != 0;
  };
  const std::size_t moved = move_first(rest, 0, 0, rest.size(), is_below);
  LIMBER_ASSERT(moved == first_count);
}

bool Split::work(std::span<PrimitiveRef> primitives, base::WorkBudget& budget) {
  while (step_ != Step::done && !budget.is_spent()) {
    const std::size_t end = std::min(done_ + primitives_at_once, end_);
    const double count = static_cast<double>(end - done_);
    switch (step_) {
      case Step::measuring:
        budget.spend(ns_per_primitive * count);
        simd::kernels().extend_box(primitives[done_].center.data(), end - done_, box_);
        done_ = end;
        if (done_ < end_) break;
        choose_axis();
        search(begin_, end_);
        moves_by_key_ = false;  // at first everything is left
        break;
      case Step::sampling:
        budget.spend(ns_per_one_of_few * sample_size);
        sample(primitives);
        break;
      case Step::moving_below:
        budget.spend(ns_per_move * count);
        below_ = move_below(primitives, below_, end, lower_);
        done_ = end;
        if (done_ < end_) break;
        if (below_ > middle_) {
          search(begin_, below_);
        } else {
          step_ = Step::moving_between, done_ = between_ = below_;
        }
        break;
      case Step::moving_between:
        budget.spend(ns_per_move * count);
        between_ = move_below(primitives, between_, end, upper_);
        done_ = end;
        if (done_ < end_) break;
        if (between_ > middle_) {
          search(below_, between_);
        } else {
          search(between_, end_);
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
  base::WorkBudget unlimited = base::WorkBudget::unlimited();
  split.work(primitives, unlimited);
  return split.halves();
}

void partition_into_leaves(std::span<PrimitiveRef> primitives, const BuildRange& range) {
  if (range.children <= 1) return;
  const std::array<BuildRange, 2> halves = split(primitives, range);
  base::parallel_invoke(
      range.end - range.begin > worth_a_task, [&] { partition_into_leaves(primitives, halves[0]); },
      [&] { partition_into_leaves(primitives, halves[1]); });
}

BoundingBox bounding_box_of(MeshView mesh) {
  const std::size_t count = mesh.triangles.size();
  const std::size_t size = std::max(triangles_per_box, (count + most_boxes - 1) / most_boxes);
  std::array<BoundingBox, most_boxes> boxes;  // no vector: commits must not allocate
  base::parallel_for_ranges(count, size, [&](std::size_t begin, std::size_t end) {
    BoundingBox box;  // a local variable stays in registers
    for (std::size_t t = begin; t < end; ++t) box.add(mesh.triangle(static_cast<TriangleId>(t)));
    boxes[begin / size] = box;
  });
  BoundingBox all;
  for (const BoundingBox& box : boxes) all.add(box);
  return all;
}

void write_leaf(Leaf& leaf, MeshView mesh, std::span<const PrimitiveRef> primitives) {
  LIMBER_ASSERT(!primitives.empty() && primitives.size() <= width);
  // Splits leave primitives in any order; queries are to find pairs in the same order anywhere. Sorted by counting,
  // which takes no branches.
  const std::size_t count = primitives.size();
  TriangleId triangles[width];
  for (std::size_t k = 0; k < width; ++k) triangles[k] = k < count ? primitives[k].triangle : no_id;
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t before = 0;
    for (const TriangleId other : triangles) before += other < triangles[k] ? 1 : 0;
    leaf.triangle[before] = triangles[k];
  }
  std::fill(leaf.triangle + count, leaf.triangle + width, leaf.triangle[count - 1]);
  for (std::size_t k = 0; k < width; ++k) leaf.vertices[k] = mesh.triangles[leaf.triangle[k]];
}

std::span<const PrimitiveRef> primitives_of_leaf(std::span<const PrimitiveRef> primitives, std::size_t i) {
  return primitives.subspan(i * width, std::min(primitives.size() - i * width, std::size_t{width}));
}

std::uint64_t new_build_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace limber::bvh
