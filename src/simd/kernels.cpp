// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Highway's way of compiling one source for many instruction sets and choosing at run time.
// Differs   Whole kernels are dispatched, through one table, so the traversal exists once.
#include "simd/kernels.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/rounding.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limber::simd::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<float, width>;
#define LIMBER_KERNEL HWY_INLINE

struct Mask {
  hn::Mask<Lanes> m;
};

/// A vector of at most `width` numbers.
struct Packet {
  static constexpr std::uint32_t lanes = hn::MaxLanes(Lanes());
  hn::Vec<Lanes> v;

  static HWY_INLINE Packet set(float x) { return {hn::Set(Lanes(), x)}; }
  static HWY_INLINE Packet load(const float* p) { return {hn::Load(Lanes(), p)}; }
  static HWY_INLINE Packet from_int16(const std::int16_t* p) {
    const hn::RebindToSigned<Lanes> wide;
    const hn::Rebind<std::int16_t, Lanes> narrow;
    return {hn::ConvertTo(Lanes(), hn::PromoteTo(wide, hn::Load(narrow, p)))};
  }
  HWY_INLINE void store(float* p) const { hn::StoreU(v, Lanes(), p); }
  HWY_INLINE void round_to(std::int32_t* p) const {
    const hn::RebindToSigned<Lanes> whole;
    hn::StoreU(hn::NearestInt(v), whole, p);
  }
};

HWY_INLINE Packet operator+(Packet a, Packet b) { return {hn::Add(a.v, b.v)}; }
HWY_INLINE Packet operator-(Packet a, Packet b) { return {hn::Sub(a.v, b.v)}; }
HWY_INLINE Packet operator*(Packet a, Packet b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE Packet operator/(Packet a, Packet b) { return {hn::Div(a.v, b.v)}; }
HWY_INLINE Packet sqrt(Packet a) { return {hn::Sqrt(a.v)}; }
HWY_INLINE Packet abs(Packet a) { return {hn::Abs(a.v)}; }
HWY_INLINE Packet max(Packet a, Packet b) { return {hn::Max(a.v, b.v)}; }
HWY_INLINE Packet min(Packet a, Packet b) { return {hn::Min(a.v, b.v)}; }
HWY_INLINE Mask operator>(Packet a, Packet b) { return {hn::Gt(a.v, b.v)}; }
HWY_INLINE Mask operator<(Packet a, Packet b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE Mask operator<=(Packet a, Packet b) { return {hn::Le(a.v, b.v)}; }
HWY_INLINE Mask operator>=(Packet a, Packet b) { return {hn::Ge(a.v, b.v)}; }
HWY_INLINE Mask operator&(Mask a, Mask b) { return {hn::And(a.m, b.m)}; }
HWY_INLINE Packet select(Mask m, Packet a, Packet b) { return {hn::IfThenElse(m.m, a.v, b.v)}; }

/// Two packets at once where there is room, otherwise one.
#if HWY_MAX_BYTES == 64
struct WidePacket {
  using Tag = hn::CappedTag<float, 2 * width>;
  hn::Vec<Tag> v;

  static HWY_INLINE WidePacket load(const float* p) { return {hn::Load(Tag(), p)}; }
  HWY_INLINE void round_to(std::int32_t* p) const {
    const hn::RebindToSigned<Tag> whole;
    hn::StoreU(hn::NearestInt(v), whole, p);
  }
};

HWY_INLINE WidePacket operator+(WidePacket a, WidePacket b) { return {hn::Add(a.v, b.v)}; }
HWY_INLINE WidePacket operator-(WidePacket a, WidePacket b) { return {hn::Sub(a.v, b.v)}; }
HWY_INLINE WidePacket operator*(WidePacket a, WidePacket b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE WidePacket max(WidePacket a, WidePacket b) { return {hn::Max(a.v, b.v)}; }
HWY_INLINE WidePacket min(WidePacket a, WidePacket b) { return {hn::Min(a.v, b.v)}; }
HWY_INLINE WidePacket twice(Packet a) { return {hn::Combine(WidePacket::Tag(), a.v, a.v)}; }
HWY_INLINE Packet larger_half(WidePacket a) {
  return {hn::Max(hn::LowerHalf(Lanes(), a.v), hn::UpperHalf(Lanes(), a.v))};
}
HWY_INLINE Packet smaller_half(WidePacket a) {
  return {hn::Min(hn::LowerHalf(Lanes(), a.v), hn::UpperHalf(Lanes(), a.v))};
}
inline constexpr std::uint32_t corners_at_once = 2;  // in a WidePacket
#else
using WidePacket = Packet;
inline constexpr std::uint32_t corners_at_once = 1;
HWY_INLINE Packet twice(Packet a) { return a; }
HWY_INLINE Packet larger_half(Packet a) { return a; }
HWY_INLINE Packet smaller_half(Packet a) { return a; }
#endif

/// A vector of at most `width` numbers in float64.
struct Doubles {
  using Tag = hn::CappedTag<double, width>;
  using Narrow = hn::Rebind<float, Tag>;
  static constexpr std::uint32_t lanes = hn::MaxLanes(Tag());
  hn::Vec<Tag> v;

  static HWY_INLINE Doubles set(double x) { return {hn::Set(Tag(), x)}; }
  static HWY_INLINE Doubles load(const double* p) { return {hn::Load(Tag(), p)}; }
  static HWY_INLINE Doubles from_floats(const float* p) { return {hn::PromoteTo(Tag(), hn::Load(Narrow(), p))}; }
  HWY_INLINE void store_rounded(float* p) const { hn::Store(hn::DemoteTo(Narrow(), v), Narrow(), p); }
};

HWY_INLINE Doubles operator+(Doubles a, Doubles b) { return {hn::Add(a.v, b.v)}; }
HWY_INLINE Doubles operator-(Doubles a, Doubles b) { return {hn::Sub(a.v, b.v)}; }
HWY_INLINE Doubles operator*(Doubles a, Doubles b) { return {hn::Mul(a.v, b.v)}; }
/// x where it is at least `least` in size, 0 elsewhere.
HWY_INLINE Doubles or_zero(Doubles x, Doubles size_of, double least) {
  return {hn::IfThenElseZero(hn::Ge(hn::Abs(size_of.v), hn::Set(Doubles::Tag(), least)), x.v)};
}

/// (p - from) * scale for three numbers; four are written.
HWY_INLINE void place_three(const double* p, const double* from, double scale, float* placed) {
  const hn::CappedTag<double, 4> some;
  const hn::Rebind<float, decltype(some)> narrow;
  const auto place = [&](auto at, auto origin, float* to) {
    hn::Store(hn::DemoteTo(narrow, hn::Mul(hn::Sub(at, origin), hn::Set(some, scale))), narrow, to);
  };
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t i = 0; i < 3; ++i) place(hn::Set(some, p[i]), hn::Set(some, from[i]), placed + i);
#elif HWY_MAX_BYTES == 16
  place(hn::LoadU(some, p), hn::LoadU(some, from), placed);
  place(hn::Set(some, p[2]), hn::Set(some, from[2]), placed + 2);
#else
  const hn::Half<decltype(some)> two;
  const auto whole = [&](const double* v) { return hn::Combine(some, hn::Set(two, v[2]), hn::LoadU(two, v)); };
  place(whole(p), whole(from), placed);
#endif
}
/// The first three of each four numbers.
HWY_INLINE void load_points(const float* p, Packet& x, Packet& y, Packet& z) {
  hn::Vec<Lanes> rest;
  hn::LoadInterleaved4(Lanes(), p, x.v, y.v, z.v, rest);
}
/// Columns for rows, of numbers that fit.
HWY_INLINE void narrow_columns(const std::int32_t (&rows)[width][width], std::int16_t (&columns)[width][width]) {
#if HWY_TARGET == HWY_SCALAR
  for (std::uint32_t i = 0; i < width * width; ++i) {
    columns[i % width][i / width] = static_cast<std::int16_t>(rows[i / width][i % width]);
  }
#else
  const hn::Full128<std::int16_t> narrow;
  const hn::Full128<std::int32_t> wide;
  hn::Vec<decltype(narrow)> v[width], w[width];
  for (std::uint32_t i = 0; i < width; ++i) {
    // In vectors of 16 bytes there is nothing to be reordered.
    v[i] = hn::ReorderDemote2To(narrow, hn::Load(wide, rows[i]), hn::Load(wide, rows[i] + 4));
  }
  // Interleaving the first half with the second three times brings every number to its mirror image's place.
  for (int round = 0; round < 3; ++round) {
    for (std::uint32_t i = 0; i < width; i += 2) {
      w[i] = hn::InterleaveLower(narrow, v[i / 2], v[i / 2 + 4]);
      w[i + 1] = hn::InterleaveUpper(narrow, v[i / 2], v[i / 2 + 4]);
    }
    for (std::uint32_t i = 0; i < width; ++i) v[i] = w[i];
  }
  for (std::uint32_t i = 0; i < width; ++i) hn::Store(v[i], narrow, columns[i]);
#endif
}
HWY_INLINE float largest(Packet a) { return hn::GetLane(hn::MaxOfLanes(Lanes(), a.v)); }
HWY_INLINE unsigned bits(Mask m) {
  std::uint8_t byte = 0;
  hn::StoreMaskBits(Lanes(), m.m, &byte);
  return byte;
}

#include "simd/kernels-inl.h"

#undef LIMBER_KERNEL

const Kernels* table() {
  static const Kernels set{hwy::TargetName(HWY_TARGET), bound_lanes, leaf_candidates, fit_leaves, enclose};
  return &set;
}

}  // namespace

const Kernels* kernel_table() { return table(); }

}  // namespace limber::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limber::simd {
namespace {

HWY_EXPORT(kernel_table);

const Kernels& best_kernels() {
  static const Kernels best = *HWY_DYNAMIC_DISPATCH(kernel_table)();
  return best;
}

std::vector<Kernels> find_all() {
  std::vector<Kernels> found;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    found.push_back(*HWY_DYNAMIC_DISPATCH(kernel_table)());
  }
  hwy::SetSupportedTargetsForTest(0);
  found.push_back(scalar_kernels);
  return found;
}

std::atomic<const Kernels*> chosen_kernels{nullptr};

}  // namespace

const Kernels& kernels() {
  const Kernels* const chosen = chosen_kernels.load(std::memory_order_acquire);
  return chosen != nullptr ? *chosen : best_kernels();
}

std::span<const Kernels> all_kernels() {
  static const std::vector<Kernels> found = find_all();
  return found;
}

void use_kernels(const Kernels* chosen) { chosen_kernels.store(chosen, std::memory_order_release); }

}  // namespace limber::simd
#endif
