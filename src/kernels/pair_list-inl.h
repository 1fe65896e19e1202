// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs of triangles of two leaves: lists of them, and their corners, a pair in each lane.

#if defined(LIMBER_SIMD_PAIR_LIST_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_PAIR_LIST_INL_H
#undef LIMBER_SIMD_PAIR_LIST_INL_H
#else
#define LIMBER_SIMD_PAIR_LIST_INL_H
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// The numbers of the bits of a byte, from the lowest on; then zeros.
inline constexpr auto numbers_of_bits = [] {
  std::array<std::array<std::uint8_t, width>, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::size_t count = 0;
    for (std::uint8_t bit = 0; bit < width; ++bit) {
      if ((byte >> bit & 1) != 0) table[byte][count++] = bit;
    }
  }
  return table;
}();

inline constexpr std::uint64_t in_each_byte = 0x0101010101010101;

/// Corner `k` of the triangles in the slots `i` and following.
LIMBER_KERNEL Packet3 corners(const LeafCorners& c, int k, std::uint32_t i) {
  return {Packet::load(c.v[3 * k] + i), Packet::load(c.v[3 * k + 1] + i), Packet::load(c.v[3 * k + 2] + i)};
}
/// Corner `k` of the triangles in some slots.
LIMBER_KERNEL Packet3 corners(const LeafCorners& c, int k, const Slots& slots) {
  return {pick(c.v[3 * k], slots), pick(c.v[3 * k + 1], slots), pick(c.v[3 * k + 2], slots)};
}

/// Pairs of triangles of two leaves, as 8 * slot of the first + slot of the second.
struct PairList {
  alignas(64) std::uint8_t pair[width * width + width];
  std::uint32_t count = 0;

  /// Appends the pairs whose bits are set: bit 8 * i + j is triangle i of the first leaf and j of the second. Row by
  /// row: a loop over bits would end where nothing can predict it.
  LIMBER_KERNEL void add(std::uint64_t pairs) {
    std::uint32_t n = count;  // a local variable: bytes that are written could be any other
    for (std::uint32_t row = 0; row < width; ++row, pairs >>= width) {
      const auto& numbers = numbers_of_bits[pairs & 0xff];
      const std::uint64_t of_row = std::bit_cast<std::uint64_t>(numbers) + row * width * in_each_byte;
      std::memcpy(pair + n, &of_row, sizeof of_row);  // bytes that do not count are overwritten, or not used
      n += static_cast<std::uint32_t>(std::popcount(pairs & 0xff));
    }
    count = n;
  }
  /// Appends pairs of another list: of those from `i` on the ones whose lanes are in `which`.
  LIMBER_KERNEL void add(const PairList& list, std::uint32_t i, unsigned which) {
    std::uint32_t n = count;
    for (; which != 0; which &= which - 1) {
      pair[n++] = list.pair[i + static_cast<std::uint32_t>(std::countr_zero(which))];
    }
    count = n;
  }
  /// Makes lanes after the last pair hold some pair.
  LIMBER_KERNEL void fill_last_packet() { std::fill_n(pair + count, width, std::uint8_t{0}); }
  /// The lanes, from pair `i` on, that hold a pair of the list.
  LIMBER_KERNEL unsigned lanes_at(std::uint32_t i) const { return (1U << std::min(count - i, Packet::lanes)) - 1; }
};

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
