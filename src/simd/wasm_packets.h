// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Packets of four numbers in WebAssembly's vectors of 128 bits; see packets-inl.h.

#include <wasm_simd128.h>

#include <cstdint>

#include "layout/node.h"

#define LIMBER_WASM inline __attribute__((always_inline))

namespace limber::simd::wasm {
namespace {

using bvh::width;

struct Mask {
  v128_t m;
};

/// A vector of four numbers.
struct Packet {
  static constexpr std::uint32_t lanes = 4;
  v128_t v;

  static LIMBER_WASM Packet set(float x) { return {wasm_f32x4_splat(x)}; }
  static LIMBER_WASM Packet load(const float* p) { return {wasm_v128_load(p)}; }
  static LIMBER_WASM Packet from_int16(const std::int16_t* p) {
    return {wasm_f32x4_convert_i32x4(wasm_i32x4_load16x4(p))};
  }
  LIMBER_WASM void store(float* p) const { wasm_v128_store(p, v); }
};

LIMBER_WASM Packet operator+(Packet a, Packet b) { return {wasm_f32x4_add(a.v, b.v)}; }
LIMBER_WASM Packet operator-(Packet a, Packet b) { return {wasm_f32x4_sub(a.v, b.v)}; }
LIMBER_WASM Packet operator*(Packet a, Packet b) { return {wasm_f32x4_mul(a.v, b.v)}; }
LIMBER_WASM Packet operator/(Packet a, Packet b) { return {wasm_f32x4_div(a.v, b.v)}; }
LIMBER_WASM Packet sqrt(Packet a) { return {wasm_f32x4_sqrt(a.v)}; }
LIMBER_WASM Packet abs(Packet a) { return {wasm_f32x4_abs(a.v)}; }
// The pseudo-minimum and -maximum are single instructions of x86 and, with swapped arguments, a > b ? a : b.
LIMBER_WASM Packet max(Packet a, Packet b) { return {wasm_f32x4_pmax(b.v, a.v)}; }
LIMBER_WASM Packet min(Packet a, Packet b) { return {wasm_f32x4_pmin(b.v, a.v)}; }
LIMBER_WASM Mask operator>(Packet a, Packet b) { return {wasm_f32x4_gt(a.v, b.v)}; }
LIMBER_WASM Mask operator<(Packet a, Packet b) { return {wasm_f32x4_lt(a.v, b.v)}; }
LIMBER_WASM Mask operator<=(Packet a, Packet b) { return {wasm_f32x4_le(a.v, b.v)}; }
LIMBER_WASM Mask operator>=(Packet a, Packet b) { return {wasm_f32x4_ge(a.v, b.v)}; }
LIMBER_WASM Mask operator&(Mask a, Mask b) { return {wasm_v128_and(a.m, b.m)}; }
LIMBER_WASM Mask operator|(Mask a, Mask b) { return {wasm_v128_or(a.m, b.m)}; }
LIMBER_WASM Mask operator^(Mask a, Mask b) { return {wasm_v128_xor(a.m, b.m)}; }
/// a, or -a where `sign` is negative.
LIMBER_WASM Packet flipped_as(Packet a, Packet sign) {
  return {wasm_v128_xor(a.v, wasm_v128_and(sign.v, wasm_f32x4_const_splat(-0.0F)))};
}
/// a, with its three last bits replaced by the number of its slot, which is `first` in the first lane.
LIMBER_WASM Packet numbered(Packet a, std::uint32_t first) {
  const v128_t slot = wasm_i32x4_add(wasm_u32x4_splat(first), wasm_u32x4_const(0, 1, 2, 3));
  return {wasm_v128_or(wasm_v128_andnot(a.v, wasm_u32x4_const_splat(width - 1)), slot)};
}
LIMBER_WASM Packet select(Mask m, Packet a, Packet b) { return {wasm_v128_bitselect(a.v, b.v, m.m)}; }

/// Slots of a leaf, one in each lane; numbers and ids that are picked by them from tables of `width`.
struct Slots {
  v128_t bytes;  // of the picked numbers, in a table

  /// The first or the second slots of as many pairs as there are lanes; a pair is 8 * first + second.
  static LIMBER_WASM Slots first_of(const std::uint8_t* pairs) { return from(wasm_u32x4_shr(load(pairs), 3)); }
  static LIMBER_WASM Slots second_of(const std::uint8_t* pairs) {
    return from(wasm_v128_and(load(pairs), wasm_u32x4_const_splat(width - 1)));
  }

  LIMBER_WASM v128_t pick(const void* table) const {
    // Bytes that a vector does not have are picked as 0.
    const v128_t first = wasm_v128_load(table);
    const v128_t second = wasm_v128_load(static_cast<const char*>(table) + sizeof(v128_t));
    const v128_t bytes_of_second = wasm_i8x16_sub(bytes, wasm_u8x16_const_splat(sizeof(v128_t)));
    return wasm_v128_or(wasm_i8x16_swizzle(first, bytes), wasm_i8x16_swizzle(second, bytes_of_second));
  }

 private:
  static LIMBER_WASM v128_t load(const std::uint8_t* pairs) {
    return wasm_u32x4_extend_low_u16x8(wasm_u16x8_extend_low_u8x16(wasm_v128_load32_zero(pairs)));
  }
  static LIMBER_WASM Slots from(v128_t slots) {
    return {
        wasm_i32x4_add(wasm_i32x4_mul(slots, wasm_u32x4_const_splat(0x04040404)), wasm_u32x4_const_splat(0x03020100))};
  }
};
LIMBER_WASM Packet pick(const float* table, const Slots& slots) { return {slots.pick(table)}; }

/// Four ids.
struct Ids {
  v128_t v;

  static LIMBER_WASM Ids set(std::uint32_t id) { return {wasm_u32x4_splat(id)}; }
  static LIMBER_WASM Ids load(const std::uint32_t* ids) { return {wasm_v128_load(ids)}; }
  LIMBER_WASM void store(std::uint32_t* ids) const { wasm_v128_store(ids, v); }
};
LIMBER_WASM Ids pick(const std::uint32_t* table, const Slots& slots) { return {slots.pick(table)}; }
LIMBER_WASM Mask operator==(Ids a, Ids b) { return {wasm_i32x4_eq(a.v, b.v)}; }
/// The first, second and third of each three ids, as many as there are lanes.
LIMBER_WASM void deinterleave(const std::uint32_t* ids, std::uint32_t* first, std::uint32_t* second,
                              std::uint32_t* third) {
  const v128_t a = wasm_v128_load(ids), b = wasm_v128_load(ids + 4), c = wasm_v128_load(ids + 8);
  wasm_v128_store(first, wasm_i32x4_shuffle(wasm_i32x4_shuffle(a, b, 0, 3, 6, 6), c, 0, 1, 2, 5));
  wasm_v128_store(second, wasm_i32x4_shuffle(wasm_i32x4_shuffle(a, b, 1, 4, 7, 7), c, 0, 1, 2, 6));
  wasm_v128_store(third, wasm_i32x4_shuffle(wasm_i32x4_shuffle(a, b, 2, 5, 5, 5), c, 0, 1, 4, 7));
}

using WidePacket = Packet;
inline constexpr std::uint32_t corners_at_once = 1;

/// A vector of two numbers in float64.
struct Doubles {
  static constexpr std::uint32_t lanes = 2;
  v128_t v;

  static LIMBER_WASM Doubles set(double x) { return {wasm_f64x2_splat(x)}; }
  static LIMBER_WASM Doubles load(const double* p) { return {wasm_v128_load(p)}; }
  static LIMBER_WASM Doubles from_floats(const float* p) {
    return {wasm_f64x2_promote_low_f32x4(wasm_v128_load64_zero(p))};
  }
  LIMBER_WASM void store(double* p) const { wasm_v128_store(p, v); }
  LIMBER_WASM void store_rounded(float* p) const { wasm_v128_store64_lane(p, wasm_f32x4_demote_f64x2_zero(v), 0); }
};
using Quad = Doubles;

LIMBER_WASM Doubles operator+(Doubles a, Doubles b) { return {wasm_f64x2_add(a.v, b.v)}; }
LIMBER_WASM Doubles operator-(Doubles a, Doubles b) { return {wasm_f64x2_sub(a.v, b.v)}; }
LIMBER_WASM Doubles operator*(Doubles a, Doubles b) { return {wasm_f64x2_mul(a.v, b.v)}; }
LIMBER_WASM Doubles operator/(Doubles a, Doubles b) { return {wasm_f64x2_div(a.v, b.v)}; }
LIMBER_WASM Doubles sqrt(Doubles a) { return {wasm_f64x2_sqrt(a.v)}; }
LIMBER_WASM Doubles abs(Doubles a) { return {wasm_f64x2_abs(a.v)}; }
LIMBER_WASM Doubles min(Doubles a, Doubles b) { return {wasm_f64x2_pmin(b.v, a.v)}; }
LIMBER_WASM Doubles max(Doubles a, Doubles b) { return {wasm_f64x2_pmax(b.v, a.v)}; }
LIMBER_WASM double largest(Doubles a) {
  const double first = wasm_f64x2_extract_lane(a.v, 0), second = wasm_f64x2_extract_lane(a.v, 1);
  return first > second ? first : second;
}

struct DoublesMask {
  v128_t m;
};
using QuadMask = DoublesMask;
LIMBER_WASM DoublesMask operator>(Doubles a, Doubles b) { return {wasm_f64x2_gt(a.v, b.v)}; }
LIMBER_WASM DoublesMask operator<(Doubles a, Doubles b) { return {wasm_f64x2_lt(a.v, b.v)}; }
LIMBER_WASM DoublesMask operator<=(Doubles a, Doubles b) { return {wasm_f64x2_le(a.v, b.v)}; }
LIMBER_WASM DoublesMask operator>=(Doubles a, Doubles b) { return {wasm_f64x2_ge(a.v, b.v)}; }
LIMBER_WASM DoublesMask operator&(DoublesMask a, DoublesMask b) { return {wasm_v128_and(a.m, b.m)}; }
LIMBER_WASM Doubles select(DoublesMask m, Doubles a, Doubles b) { return {wasm_v128_bitselect(a.v, b.v, m.m)}; }
LIMBER_WASM unsigned bits(DoublesMask a) { return wasm_i64x2_bitmask(a.m); }
LIMBER_WASM bool all_of(DoublesMask a) { return wasm_i64x2_all_true(a.m); }

/// Two points, each of three numbers, one after the other.
LIMBER_WASM void load_points(const double* p, Doubles& x, Doubles& y, Doubles& z) {
  const v128_t a = wasm_v128_load(p), b = wasm_v128_load(p + 2), c = wasm_v128_load(p + 4);
  x.v = wasm_i64x2_shuffle(a, b, 0, 3), y.v = wasm_i64x2_shuffle(a, c, 1, 2), z.v = wasm_i64x2_shuffle(b, c, 0, 3);
}
/// x where it is at least `least` in size, 0 elsewhere.
LIMBER_WASM Doubles or_zero(Doubles x, Doubles size_of, double least) {
  return {wasm_v128_and(wasm_f64x2_ge(wasm_f64x2_abs(size_of.v), wasm_f64x2_splat(least)), x.v)};
}

/// Moves a point to an origin and scales it: (p - origin) * factor. Four numbers are written.
struct PointScaler {
  using Points = const double* const[corners_at_once];
  v128_t origin_xy, origin_z, factor;

  LIMBER_WASM PointScaler(const Points& from, double per_length)
      : origin_xy(wasm_v128_load(from[0])),
        origin_z(wasm_v128_load64_zero(from[0] + 2)),
        factor(wasm_f64x2_splat(per_length)) {}
  LIMBER_WASM void scale(const Points& points, float* scaled) const {
    const v128_t xy = wasm_f64x2_mul(wasm_f64x2_sub(wasm_v128_load(points[0]), origin_xy), factor);
    const v128_t z = wasm_f64x2_mul(wasm_f64x2_sub(wasm_v128_load64_zero(points[0] + 2), origin_z), factor);
    wasm_v128_store(scaled,
                    wasm_i64x2_shuffle(wasm_f32x4_demote_f64x2_zero(xy), wasm_f32x4_demote_f64x2_zero(z), 0, 2));
  }
};

/// Rows become columns.
LIMBER_WASM void transpose(v128_t a, v128_t b, v128_t c, v128_t d, v128_t (&columns)[4]) {
  const v128_t ab_low = wasm_i32x4_shuffle(a, b, 0, 4, 1, 5), ab_high = wasm_i32x4_shuffle(a, b, 2, 6, 3, 7);
  const v128_t cd_low = wasm_i32x4_shuffle(c, d, 0, 4, 1, 5), cd_high = wasm_i32x4_shuffle(c, d, 2, 6, 3, 7);
  columns[0] = wasm_i64x2_shuffle(ab_low, cd_low, 0, 2), columns[1] = wasm_i64x2_shuffle(ab_low, cd_low, 1, 3);
  columns[2] = wasm_i64x2_shuffle(ab_high, cd_high, 0, 2), columns[3] = wasm_i64x2_shuffle(ab_high, cd_high, 1, 3);
}

/// Four points, each as four numbers, of which the last does not matter.
LIMBER_WASM void load_points(const float* p, Packet& x, Packet& y, Packet& z) {
  v128_t columns[4];
  transpose(wasm_v128_load(p), wasm_v128_load(p + 4), wasm_v128_load(p + 8), wasm_v128_load(p + 12), columns);
  x.v = columns[0], y.v = columns[1], z.v = columns[2];
}
LIMBER_WASM void store_interleaved(Packet x, Packet y, Packet z, float* p) {
  v128_t points[4];
  transpose(x.v, y.v, z.v, x.v, points);
  for (int i = 0; i < 4; ++i) wasm_v128_store(p + 4 * i, points[i]);
}

/// `width` rows of as many numbers, rounded to int16, in which they fit.
struct Int16Tile {
  v128_t v[width * width / Packet::lanes];

  LIMBER_WASM void put(std::uint32_t at, Packet p) {
    v[at / Packet::lanes] = wasm_i32x4_trunc_sat_f32x4(wasm_f32x4_nearest(p.v));
  }
  LIMBER_WASM void store_columns(std::int16_t* const (&columns)[width]) const {
    v128_t rows[width], mixed[width];
    for (std::uint32_t i = 0; i < width; ++i) rows[i] = wasm_i16x8_narrow_i32x4(v[2 * i], v[2 * i + 1]);
    // Interleaving the first half with the second three times brings every number to its mirror image's place.
    for (int round = 0; round < 3; ++round) {
      for (std::uint32_t i = 0; i < width; i += 2) {
        const v128_t a = rows[i / 2], b = rows[i / 2 + 4];
        mixed[i] = wasm_i16x8_shuffle(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
        mixed[i + 1] = wasm_i16x8_shuffle(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
      }
      for (std::uint32_t i = 0; i < width; ++i) rows[i] = mixed[i];
    }
    for (std::uint32_t i = 0; i < width; ++i) wasm_v128_store(columns[i], rows[i]);
  }
};

LIMBER_WASM float largest(Packet a) {
  const v128_t pairs = wasm_f32x4_pmax(a.v, wasm_i32x4_shuffle(a.v, a.v, 2, 3, 0, 1));
  return wasm_f32x4_extract_lane(wasm_f32x4_pmax(pairs, wasm_i32x4_shuffle(pairs, pairs, 1, 0, 3, 2)), 0);
}
LIMBER_WASM unsigned bits(Mask m) { return wasm_i32x4_bitmask(m.m); }

}  // namespace
}  // namespace limber::simd::wasm

#undef LIMBER_WASM
