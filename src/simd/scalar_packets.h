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

/// A vector of one number.
template <typename T>
struct Vector {
  static constexpr std::uint32_t lanes = 1;
  struct Mask {
    bool m;

    friend Mask operator&(Mask a, Mask b) { return {a.m && b.m}; }
    friend Mask operator|(Mask a, Mask b) { return {a.m || b.m}; }
    friend Mask operator^(Mask a, Mask b) { return {a.m != b.m}; }
    friend unsigned bits(Mask a) { return a.m ? 1 : 0; }
    friend bool all_of(Mask a) { return a.m; }
  };
  T v;

  static Vector set(T x) { return {x}; }
  static Vector load(const T* p) { return {*p}; }
  static Vector from_int16(const std::int16_t* p) { return {static_cast<T>(*p)}; }
  static Vector from_floats(const float* p) { return {T{*p}}; }
  void store(T* p) const { *p = v; }
  void store_int16(std::int16_t* p) const { *p = static_cast<std::int16_t>(v); }
  void store_rounded(float* p) const { *p = static_cast<float>(v); }

  friend Vector operator+(Vector a, Vector b) { return {a.v + b.v}; }
  friend Vector operator-(Vector a, Vector b) { return {a.v - b.v}; }
  friend Vector operator*(Vector a, Vector b) { return {a.v * b.v}; }
  friend Vector operator/(Vector a, Vector b) { return {a.v / b.v}; }
  friend Vector sqrt(Vector a) { return {std::sqrt(a.v)}; }
  friend Vector abs(Vector a) { return {std::abs(a.v)}; }
  friend Vector max(Vector a, Vector b) { return {a.v > b.v ? a.v : b.v}; }
  friend Vector min(Vector a, Vector b) { return {a.v < b.v ? a.v : b.v}; }
  friend Vector largest_in_all(Vector a) { return a; }
  friend T largest(Vector a) { return a.v; }
  friend Mask operator>(Vector a, Vector b) { return {a.v > b.v}; }
  friend Mask operator<(Vector a, Vector b) { return {a.v < b.v}; }
  friend Mask operator<=(Vector a, Vector b) { return {a.v <= b.v}; }
  friend Mask operator>=(Vector a, Vector b) { return {a.v >= b.v}; }
  friend Vector select(Mask m, Vector a, Vector b) { return m.m ? a : b; }
  friend Vector flipped_as(Vector a, Vector sign) { return {std::signbit(sign.v) ? -a.v : a.v}; }
};
using Packet = Vector<float>;
using Mask = Packet::Mask;
using Doubles = Vector<double>;
using DoublesMask = Doubles::Mask;
using Quad = Doubles;
using QuadMask = DoublesMask;

inline Packet numbered(Packet a, std::uint32_t first) {
  return {std::bit_cast<float>((std::bit_cast<std::uint32_t>(a.v) & ~(width - 1)) | first)};
}

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

}  // namespace
}  // namespace limber::simd::scalar
