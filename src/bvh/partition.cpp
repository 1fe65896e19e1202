// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Assigns triangles to the leaves of a tree: splits ranges of them in two along the longest side of their centers,
// until each is a leaf, and writes the leaves.
//
// Split makes one such split: it finds the middle, the primitive at which the second half begins, by sampling, as
// [FloydRivest1975]. The window is the part of the range that still holds the middle, at first all. The phases, which
// can be interrupted between chunks:
//   measuring       finds the longest side of the bounding box of all centers.
//   sampling        draws a sample of the window, and from it two limits that probably enclose the middle.
//   moving_below    moves the primitives of the window below the lower limit to its front.
//   moving_between  moves the primitives between the two limits behind them; is left out if the middle is already among
//                   the primitives below the lower limit.
//                   After either, the part that holds the middle becomes the window: back to sampling if it is large.
//   finishing       selects the middle of a small window directly, and moves what is less to the front.
// Primitives are ordered by a key, the coordinate followed by the triangle's id, so all keys are distinct, and which
// primitives go to which half does not depend on the samples. Limits are compared with coordinates only, which is
// faster. If the next window has more than three quarters of the last one, many coordinates may be equal, and from then
// on limits are compared with keys. After an unlucky sample another is drawn, with new random numbers.
#include "bvh/partition.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/check.h"
#include "base/parallel.h"
#include "simd/kernels.h"

namespace limber::bvh {
namespace {

// Primitives below which another task costs more than it saves (docs/design/one_query.md).
constexpr std::size_t worth_a_task = 8192;

// Windows up to this size are finished directly: by a kernel up to simd::few_points primitives, else by quickselect.
constexpr std::size_t finished_directly = 512;

// Primitives in a sample. The limits are those of its elements whose rank is `sample_margin` below and above the rank
// that is expected of the middle: two standard deviations, of at most sqrt(128) / 2 = 5.7 each.
constexpr std::size_t sample_size = 128, sample_margin = 12;

// Primitives in one chunk of a pass over the window.
constexpr std::size_t primitives_at_once = 1024;

// Upper bounds of what one primitive costs, in ns (docs/design/real_time.md).
constexpr double ns_to_measure = 2, ns_to_move = 5, ns_to_select = 10;

/// Moves primitives to the front: each from `begin` to `end` for whose index is_below() is true changes places with the
/// one at `below_end`, which goes up by 1. Returns the final `below_end`. No branch depends on the primitives, because
/// it could not be predicted: all are swapped, but `below_end` only goes up after one that is below.
/// Pre: is_below() is false for all from `below_end` to `begin`.
template <typename IsBelow>
std::size_t move_below_to_front(std::span<PrimitiveRef> primitives, std::size_t below_end, std::size_t begin,
                                std::size_t end, const IsBelow& is_below) {
  for (std::size_t i = begin; i < end; ++i) {
    // is_below() comes before the copy, or GCC would write the copy to memory to read one of its coordinates.
    const bool moves = is_below(i);
    const PrimitiveRef primitive = primitives[i];
    primitives[i] = primitives[below_end];
    primitives[below_end] = primitive;
    below_end += moves ? 1 : 0;
  }
  return below_end;
}

/// The number of rank `n` among some numbers, of which the least has rank 0; reorders them. Quickselect, without
/// branches on single numbers. Numbers may be equal. Quadratic at worst, so it is meant for a few hundred numbers.
std::uint64_t nth_least(std::span<std::uint64_t> numbers, std::size_t n) {
  LIMBER_ASSERT(n < numbers.size());
  while (true) {
    const std::size_t last = numbers.size() - 1;
    std::uint64_t &at_front = numbers[0], &at_middle = numbers[last / 2], &at_back = numbers[last];
    // After two lines the largest of the three is at the middle, after the third the median at the back: the pivot.
    if (at_front > at_middle) std::swap(at_front, at_middle);
    if (at_middle < at_back) std::swap(at_middle, at_back);
    if (at_front > at_back) std::swap(at_front, at_back);
    const std::uint64_t pivot = at_back;
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
      // Leaves out the pivot, too, which is still at the back.
      numbers = numbers.subspan(less, last - less);
      n -= less + 1;
    }
  }
}

/// An unsigned number in the order of coordinates: the bits of the float, all flipped if it is negative, else only the
/// sign bit.
std::uint32_t sortable_bits(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x + 0.0F);  // -0 becomes 0
  return (bits >> 31) != 0 ? ~bits : bits | 0x80000000U;
}
float from_sortable_bits(std::uint32_t bits) {
  return std::bit_cast<float>((bits >> 31) != 0 ? bits & 0x7fffffffU : ~bits);
}
float coordinate_of(std::uint64_t key) { return from_sortable_bits(static_cast<std::uint32_t>(key >> 32)); }

}  // namespace

std::uint32_t leaf_count(std::size_t triangles) { return static_cast<std::uint32_t>((triangles + width - 1) / width); }

std::uint32_t child_count(std::uint32_t leaves) {
  std::uint64_t full = 1;  // leaves below one child, if it is full
  while (full * width < leaves) full *= width;
  return static_cast<std::uint32_t>((leaves + full - 1) / full);
}

std::uint32_t first_half_leaves(std::uint32_t leaves, std::uint32_t children) {
  return static_cast<std::uint32_t>(std::uint64_t{leaves} * (children / 2) / children);
}

std::size_t middle_of(const BuildRange& range) {
  LIMBER_ASSERT(range.children > 1);
  return range.begin + std::size_t{first_half_leaves(leaf_count(range.end - range.begin), range.children)} * width;
}

std::array<BuildRange, 2> halves_of(const BuildRange& range, std::size_t middle) {
  // A half with several children is split again. A half with a single child becomes the range of that child's children.
  const auto half = [](std::size_t begin, std::size_t end, std::uint32_t children) {
    return children > 1 ? BuildRange{begin, end, children} : build_range(begin, end);
  };
  const std::uint32_t first = range.children / 2;
  return {half(range.begin, middle, first), half(middle, range.end, range.children - first)};
}

BuildRange build_range(std::size_t begin, std::size_t end) {
  const std::uint32_t leaves = leaf_count(end - begin);
  return {begin, end, leaves > 1 ? child_count(leaves) : 1};
}

Split::Split(const BuildRange& range)
    : range_(range),
      middle_(middle_of(range)),
      begin_(range.begin),
      end_(range.end),
      next_(range.begin),
      random_(range.end - range.begin) {  // a fixed seed: the same mesh takes the same steps every time
  std::fill(std::begin(box_.low), std::end(box_.low), std::numeric_limits<float>::infinity());
  std::fill(std::begin(box_.high), std::end(box_.high), -std::numeric_limits<float>::infinity());
}

std::uint64_t Split::key(const PrimitiveRef& primitive) const {
  return std::uint64_t{sortable_bits(primitive.center[axis_])} << 32 | primitive.triangle;
}

void Split::choose_axis() {
  const float x = box_.high[0] - box_.low[0], y = box_.high[1] - box_.low[1], z = box_.high[2] - box_.low[2];
  axis_ = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
}

/// Makes the window smaller and goes on with it; with keys from now on if it is still large.
void Split::narrow_to(std::size_t begin, std::size_t end) {
  compares_keys_ |= 4 * (end - begin) > 3 * (end_ - begin_);
  continue_within(begin, end);
}

void Split::continue_within(std::size_t begin, std::size_t end) {
  begin_ = begin, end_ = end;
  phase_ = end_ - begin_ <= finished_directly ? Phase::finishing : Phase::sampling;
}

void Split::draw_limits(std::span<const PrimitiveRef> primitives) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::size_t count = end_ - begin_;
  std::array<std::uint64_t, sample_size> keys;
  // At random, with replacement: every k-th primitive might be from one row of a grid. The generator is that of Knuth's
  // MMIX; its upper 32 bits, times count / 2^32, are an index.
  for (std::uint64_t& k : keys) {
    random_ = random_ * 6364136223846793005 + 1442695040888963407;
    k = key(primitives[begin_ + static_cast<std::size_t>(((random_ >> 32) * count) >> 32)]);
  }
  const std::size_t expected_rank = (middle_ - begin_) * sample_size / count;
  // Without limits: moving_below moves nothing, moving_between all.
  lower_ = {0, -infinity}, upper_ = {std::numeric_limits<std::uint64_t>::max(), infinity};
  if (expected_rank >= sample_margin) {
    lower_.key = nth_least(keys, expected_rank - sample_margin);
    lower_.coordinate = coordinate_of(lower_.key);
  }
  if (expected_rank + sample_margin < sample_size) {
    const std::uint64_t last = nth_least(keys, expected_rank + sample_margin);
    upper_ = {last + 1, std::nextafter(coordinate_of(last), infinity)};  // the next above: limits are exclusive
  }
  phase_ = Phase::moving_below, next_ = below_ = begin_;
}

/// Of the primitives next_ to `end`, swaps those below a limit to the places from `below_end` on. Returns the new
/// `below_end`.
std::size_t Split::move_below(std::span<PrimitiveRef> primitives, std::size_t below_end, std::size_t end,
                              const Limit& limit) const {
  if (compares_keys_) {
    const auto is_below = [&](std::size_t i) { return key(primitives[i]) < limit.key; };
    return move_below_to_front(primitives, below_end, next_, end, is_below);
  }
  const auto is_below = [&, axis = axis_, coordinate = limit.coordinate](std::size_t i) {
    return primitives[i].center[axis] < coordinate;
  };
  return move_below_to_front(primitives, below_end, next_, end, is_below);
}

void Split::finish(std::span<PrimitiveRef> primitives) {
  const std::span<PrimitiveRef> window = primitives.subspan(begin_, end_ - begin_);
  const std::size_t rank = middle_ - begin_;
  phase_ = Phase::done;
  if (window.size() <= simd::few_points) {
    const std::uint64_t least = least_of_few(window, axis_, rank);
    const auto is_least = [least](std::size_t i) { return (least >> i & 1) != 0; };
    const std::size_t moved = move_below_to_front(window, 0, 0, window.size(), is_least);
    LIMBER_ASSERT(moved == rank);
    return;
  }
  std::array<std::uint64_t, finished_directly> keys;
  const std::span<std::uint64_t> used = std::span(keys).first(window.size());
  for (std::size_t i = 0; i < used.size(); ++i) used[i] = key(window[i]);
  const std::uint64_t median = nth_least(used, rank);
  // key(window[i]) < median, from its two parts, which is faster; with & and | because && and || are branches.
  const float coordinate = coordinate_of(median);
  const auto triangle = static_cast<TriangleId>(median);
  const auto is_below = [&, axis = axis_](std::size_t i) {
    const float x = window[i].center[axis];
    return (static_cast<int>(x < coordinate) |
            (static_cast<int>(x == coordinate) & static_cast<int>(window[i].triangle < triangle))) != 0;
  };
  const std::size_t moved = move_below_to_front(window, 0, 0, window.size(), is_below);
  LIMBER_ASSERT(moved == rank);
}

bool Split::work(std::span<PrimitiveRef> primitives, base::WorkBudget& budget) {
  // Pays for the next chunk of a pass over the window, which begins at next_. Returns its end.
  const auto spend_on_chunk = [&](double ns) {
    const std::size_t end = std::min(next_ + primitives_at_once, end_);
    budget.spend(ns * static_cast<double>(end - next_));
    return end;
  };
  while (phase_ != Phase::done && !budget.is_spent()) {
    switch (phase_) {
      case Phase::measuring: {
        const std::size_t end = spend_on_chunk(ns_to_measure);
        simd::kernels().extend_box(as_points(primitives.data() + next_), end - next_, box_);
        next_ = end;
        if (next_ < end_) break;
        choose_axis();
        continue_within(begin_, end_);
        break;
      }
      case Phase::sampling:
        budget.spend(ns_to_select * sample_size);
        draw_limits(primitives);
        break;
      case Phase::moving_below: {
        const std::size_t end = spend_on_chunk(ns_to_move);
        below_ = move_below(primitives, below_, end, lower_);
        next_ = end;
        if (next_ < end_) break;
        if (below_ > middle_) {
          narrow_to(begin_, below_);
        } else {
          phase_ = Phase::moving_between, next_ = between_ = below_;
        }
        break;
      }
      case Phase::moving_between: {
        const std::size_t end = spend_on_chunk(ns_to_move);
        between_ = move_below(primitives, between_, end, upper_);
        next_ = end;
        if (next_ < end_) break;
        if (between_ > middle_) {
          narrow_to(below_, between_);
        } else {
          narrow_to(between_, end_);
        }
        break;
      }
      case Phase::finishing:
        budget.spend(ns_to_select * static_cast<double>(end_ - begin_));
        finish(primitives);
        break;
      case Phase::done:
        break;
    }
  }
  return phase_ == Phase::done;
}

std::array<BuildRange, 2> Split::halves() const {
  LIMBER_ASSERT(phase_ == Phase::done);
  return halves_of(range_, middle_);
}

std::array<BuildRange, 2> split(std::span<PrimitiveRef> primitives, const BuildRange& range) {
  Split splitting(range);
  base::WorkBudget unlimited = base::WorkBudget::unlimited();
  splitting.work(primitives, unlimited);
  return splitting.halves();
}

void partition_into_leaves(std::span<PrimitiveRef> primitives, const BuildRange& range,
                           std::span<const HalfSides> half_sides) {
  if (range.children <= 1) return;
  if (range.end - range.begin <= simd::few_points) return partition_few(primitives, range, half_sides);
  const std::array<BuildRange, 2> halves = split(primitives, range);
  base::parallel_invoke(
      range.end - range.begin > worth_a_task, [&] { partition_into_leaves(primitives, halves[0], half_sides); },
      [&] { partition_into_leaves(primitives, halves[1], half_sides); });
}

void write_leaf(Leaf& leaf, MeshView mesh, std::span<const PrimitiveRef> primitives) {
  LIMBER_ASSERT(!primitives.empty() && primitives.size() <= width);
  // Splits leave the primitives of a leaf in an order that depends on the samples. Queries visit triangles in the order
  // of the leaf. So they are sorted by id: the place of each is the number of smaller ids, which takes no branches.
  const std::size_t count = primitives.size();
  TriangleId triangles[width];
  for (std::size_t k = 0; k < width; ++k) triangles[k] = k < count ? primitives[k].triangle : no_id;
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t before = 0;
    for (const TriangleId other : triangles) before += other < triangles[k] ? 1 : 0;
    leaf.triangle[before] = triangles[k];
  }
  std::fill(leaf.triangle + count, leaf.triangle + width, leaf.triangle[count - 1]);  // copies of the last fill it up
  for (std::size_t k = 0; k < width; ++k) leaf.vertices[k] = mesh.triangles[leaf.triangle[k]];
}

std::span<const PrimitiveRef> primitives_of_leaf(std::span<const PrimitiveRef> primitives, std::size_t i) {
  return primitives.subspan(i * width, std::min(primitives.size() - i * width, std::size_t{width}));
}

}  // namespace limber::bvh
