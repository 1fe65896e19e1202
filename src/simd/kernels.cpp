// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Highway's way of compiling one source for many instruction sets and choosing at run time.
// Differs   Whole kernels are dispatched, through one table, so the traversal exists once.
#include "simd/kernels.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
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
HWY_INLINE float largest(Packet a) { return hn::GetLane(hn::MaxOfLanes(Lanes(), a.v)); }
HWY_INLINE unsigned bits(Mask m) {
  std::uint8_t byte = 0;
  hn::StoreMaskBits(Lanes(), m.m, &byte);
  return byte;
}

#include "simd/kernels-inl.h"

#undef LIMBER_KERNEL

const Kernels* table() {
  static const Kernels set{hwy::TargetName(HWY_TARGET), bound_lanes, leaf_candidates};
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
