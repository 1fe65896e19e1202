// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::least_of_few.

#if defined(LIMBER_SIMD_LEAST_OF_FEW_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_LEAST_OF_FEW_INL_H
#undef LIMBER_SIMD_LEAST_OF_FEW_INL_H
#else
#define LIMBER_SIMD_LEAST_OF_FEW_INL_H
#endif

#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/check.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Counts how many are less than each, without any branch on numbers. Of two packets at once, and of numbers with even
// and odd index apart: additions that need not wait for each other.
LIMBER_KERNEL FewLeast least_of_few(const float* points, std::size_t axis, std::size_t count, std::size_t n) {
  LIMBER_ASSERT(0 < n && n <= count && count <= few_points);
  constexpr std::size_t at_once = std::size_t{2} * Packet::lanes;
  static_assert(few_points == 64 && few_points % at_once == 0);
  alignas(32) float numbers[few_points];
  for (std::size_t i = 0; i < count; ++i) numbers[i] = points[4 * i + axis];
  const std::size_t end = (count + at_once - 1) / at_once * at_once;
  // Padding. Where most numbers are infinite it may be among the least, so it is left out below.
  for (std::size_t i = count; i < end; ++i) numbers[i] = std::numeric_limits<float>::infinity();
  const Packet one = Packet::set(1), wanted = Packet::set(static_cast<float>(n));
  alignas(32) float less[few_points];
  Packet most = zero();  // that are less than one of the least
  FewLeast found{0, 0};
  for (std::size_t i = 0; i < end; i += at_once) {
    const Packet x = Packet::load(numbers + i), y = Packet::load(numbers + i + Packet::lanes);
    Packet less_x = zero(), less_y = zero(), odd_x = zero(), odd_y = zero();
    for (std::size_t k = 0; k < end; k += 2) {
      const Packet even = Packet::set(numbers[k]), odd = Packet::set(numbers[k + 1]);
      less_x = less_x + select(even < x, one, zero()), less_y = less_y + select(even < y, one, zero());
      odd_x = odd_x + select(odd < x, one, zero()), odd_y = odd_y + select(odd < y, one, zero());
    }
    less_x = less_x + odd_x, less_y = less_y + odd_y;
    less_x.store(less + i), less_y.store(less + i + Packet::lanes);
    const Mask least_x = less_x < wanted, least_y = less_y < wanted;
    most = max(most, max(select(least_x, less_x, zero()), select(least_y, less_y, zero())));
    found.least |= std::uint64_t{bits(least_x)} << i | std::uint64_t{bits(least_y)} << (i + Packet::lanes);
  }
  const Packet of_greatest = Packet::set(largest(most));
  for (std::size_t i = 0; i < end; i += Packet::lanes) {
    found.greatest |= std::uint64_t{bits(Packet::load(less + i) >= of_greatest)} << i;
  }
  const std::uint64_t used = ~std::uint64_t{0} >> (few_points - count);
  found.least &= used;
  found.greatest &= found.least;
  return found;
}

LIMBER_KERNEL BoxRow join_rows(const BoxRow* rows, std::uint64_t which) {
  BoxRow joined;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    Packet least = Packet::load(rows[std::countr_zero(which)].least + i);
    for (std::uint64_t rest = which & (which - 1); rest != 0; rest &= rest - 1) {
      least = min(least, Packet::load(rows[std::countr_zero(rest)].least + i));
    }
    least.store(joined.least + i);
  }
  return joined;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
