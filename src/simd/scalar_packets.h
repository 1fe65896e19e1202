// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Packets of one number, in plain C++; see packets-inl.h.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "layout/node.h"

namespace limber::simd::scalar {
namespace {

using bvh::width;

struct Mask {
  bool m;
};

/// A vector of one number.
struct Packet {
  static constexpr std::uint32_t lanes = 1;
  float v;

  static Packet set(float x) { return {x}; }
  static Packet load(const float* p) { return {*p}; }
  static Packet from_int16(const std::int16_t* p) { return {static_cast<float>(*p)}; }
  void store(float* p) const { *p = v; }
};

inline Packet operator+(Packet a, Packet b) { return {a.v + b.v}; }
inline Packet operator-(Packet a, Packet b) { return {a.v - b.v}; }
inline Packet operator*(Packet a, Packet b) { return {a.v * b.v}; }
inline Packet operator/(Packet a, Packet b) { return {a.v / b.v}; }
inline Packet sqrt(Packet a) { return {std::sqrt(a.v)}; }
inline Packet abs(Packet a) { return {std::abs(a.v)}; }
inline Packet max(Packet a, Packet b) { return {a.v > b.v ? a.v : b.v}; }
inline Packet min(Packet a, Packet b) { return {a.v < b.v ? a.v : b.v}; }
inline Mask operator>(Packet a, Packet b) { return {a.v > b.v}; }
inline Mask operator<(Packet a, Packet b) { return {a.v < b.v}; }
inline Mask operator<=(Packet a, Packet b) { return {a.v <= b.v}; }
inline Mask operator>=(Packet a, Packet b) { return {a.v >= b.v}; }
inline Mask operator&(Mask a, Mask b) { return {a.m && b.m}; }
inline Mask operator|(Mask a, Mask b) { return {a.m || b.m}; }
inline Mask operator^(Mask a, Mask b) { return {a.m != b.m}; }
inline Packet flipped_as(Packet a, Packet sign) { return {std::signbit(sign.v) ? -a.v : a.v}; }
inline Packet numbered(Packet a, std::uint32_t first) {
  return {std::bit_cast<float>((std::bit_cast<std::uint32_t>(a.v) & ~(width - 1)) | first)};
}
inline Packet select(Mask m, Packet a, Packet b) { return m.m ? a : b; }

struct Slots {
  std::uint32_t slot;

  static Slots first_of(const std::uint8_t* pairs) { return {*pairs / width}; }
  static Slots second_of(const std::uint8_t* pairs) { return {*pairs % width}; }
};
inline Packet pick(const float* table, const Slots& slots) { return {table[slots.slot]}; }

struct Ids {
  std::uint32_t v;

  static Ids set(std::uint32_t id) { return {id}; }
  static Ids load(const std::uint32_t* ids) { return {*ids}; }
  void store(std::uint32_t* ids) const { *ids = v; }
};
inline Ids pick(const std::uint32_t* table, const Slots& slots) { return {table[slots.slot]}; }
inline Mask operator==(Ids a, Ids b) { return {a.v == b.v}; }
inline void deinterleave(const std::uint32_t* ids, std::uint32_t* first, std::uint32_t* second, std::uint32_t* third) {
  *first = ids[0], *second = ids[1], *third = ids[2];
}

using WidePacket = Packet;
inline constexpr std::uint32_t corners_at_once = 1;
inline Packet duplicated(Packet a) { return a; }
inline Packet first_of(Packet a) { return a; }
inline Packet last_of(Packet a) { return a; }
inline Packet larger_half(Packet a) { return a; }
inline Packet smaller_half(Packet a) { return a; }

/// A number in float64.
struct Doubles {
  static constexpr std::uint32_t lanes = 1;
  double v;

  static Doubles set(double x) { return {x}; }
  static Doubles load(const double* p) { return {*p}; }
  static Doubles from_floats(const float* p) { return {static_cast<double>(*p)}; }
  void store(double* p) const { *p = v; }
  void store_rounded(float* p) const { *p = static_cast<float>(v); }
};
using Quad = Doubles;

inline Doubles operator+(Doubles a, Doubles b) { return {a.v + b.v}; }
inline Doubles operator-(Doubles a, Doubles b) { return {a.v - b.v}; }
inline Doubles operator*(Doubles a, Doubles b) { return {a.v * b.v}; }
inline Doubles operator/(Doubles a, Doubles b) { return {a.v / b.v}; }
inline Doubles sqrt(Doubles a) { return {std::sqrt(a.v)}; }
inline Doubles abs(Doubles a) { return {std::abs(a.v)}; }
inline Doubles min(Doubles a, Doubles b) { return {a.v < b.v ? a.v : b.v}; }
inline Doubles max(Doubles a, Doubles b) { return {a.v > b.v ? a.v : b.v}; }
inline double largest(Doubles a) { return a.v; }

struct DoublesMask {
  bool m;
};
using QuadMask = DoublesMask;
inline DoublesMask operator>(Doubles a, Doubles b) { return {a.v > b.v}; }
inline DoublesMask operator<(Doubles a, Doubles b) { return {a.v < b.v}; }
inline DoublesMask operator<=(Doubles a, Doubles b) { return {a.v <= b.v}; }
inline DoublesMask operator>=(Doubles a, Doubles b) { return {a.v >= b.v}; }
inline DoublesMask operator&(DoublesMask a, DoublesMask b) { return {a.m && b.m}; }
inline Doubles select(DoublesMask m, Doubles a, Doubles b) { return m.m ? a : b; }
inline unsigned bits(DoublesMask a) { return a.m ? 1 : 0; }
inline bool all_of(DoublesMask a) { return a.m; }

inline void load_points(const double* p, Doubles& x, Doubles& y, Doubles& z) { x = {p[0]}, y = {p[1]}, z = {p[2]}; }
inline Doubles or_zero(Doubles x, Doubles size_of, double least) { return {std::abs(size_of.v) >= least ? x.v : 0}; }

struct PointScaler {
  const double* origin;
  double factor;

  using Points = const double* const[1];
  PointScaler(const Points& from, double per_length) : origin(from[0]), factor(per_length) {}
  void scale(const Points& points, float* scaled) const {
    for (int axis = 0; axis < 3; ++axis) scaled[axis] = static_cast<float>((points[0][axis] - origin[axis]) * factor);
  }
};

inline void load_points(const float* p, Packet& x, Packet& y, Packet& z) { x = {p[0]}, y = {p[1]}, z = {p[2]}; }

inline void load_interleaved(const float* p, Packet& x, Packet& y, Packet& z) { x = {p[0]}, y = {p[1]}, z = {p[2]}; }
inline void store_interleaved(Packet x, Packet y, Packet z, float* p) {
  p[0] = x.v, p[1] = y.v, p[2] = z.v, p[3] = x.v;
}

struct Int16Tile {
  std::int16_t v[width * width];

  void put(std::uint32_t at, Packet p) { v[at] = static_cast<std::int16_t>(std::lrint(p.v)); }
  void store_columns(std::int16_t* const (&columns)[width]) const {
    for (std::uint32_t i = 0; i < width * width; ++i) columns[i % width][i / width] = v[i];
  }
};
inline float largest(Packet a) { return a.v; }
inline unsigned bits(Mask m) { return m.m ? 1 : 0; }

}  // namespace
}  // namespace limber::simd::scalar
