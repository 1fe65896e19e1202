// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What kernels are written with. A Packet is as many numbers as a SIMD register holds, at most `width`; a Mask has an
// answer for each of its lanes; a WidePacket is two packets side by side where registers hold 64 bytes, else one. They
// come from scalar_packets.h or highway_packets-inl.h. Here follow vectors of three: operators, then loads and stores,
// then the way to wide packets and back.
//
// A kernel is compiled once per instruction set, in that set's namespace, and once in plain C++ by scalar_kernels.cpp,
// which defines LIMBER_SCALAR_KERNELS. The guard of its file lets it in once per set: Highway's foreach_target includes
// it again with HWY_TARGET_TOGGLE flipped, from defined to not defined or back.

#if defined(LIMBER_SIMD_PACKETS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_PACKETS_INL_H
#undef LIMBER_SIMD_PACKETS_INL_H
#else
#define LIMBER_SIMD_PACKETS_INL_H
#endif

#if defined(LIMBER_SCALAR_KERNELS)
#include "simd/scalar_packets.h"
#define LIMBER_BEFORE_KERNELS static_assert(true)  // does nothing, and takes the semicolon that follows
#define LIMBER_AFTER_KERNELS static_assert(true)
#define LIMBER_TARGET scalar
#define LIMBER_KERNEL inline
#define LIMBER_KERNEL_APART inline
#else
#include "simd/highway_packets-inl.h"
#undef LIMBER_BEFORE_KERNELS
#undef LIMBER_AFTER_KERNELS
#undef LIMBER_TARGET
#undef LIMBER_KERNEL
#undef LIMBER_KERNEL_APART
#define LIMBER_BEFORE_KERNELS HWY_BEFORE_NAMESPACE()
#define LIMBER_AFTER_KERNELS HWY_AFTER_NAMESPACE()
#define LIMBER_TARGET HWY_NAMESPACE
#define LIMBER_KERNEL HWY_INLINE
#define LIMBER_KERNEL_APART inline HWY_NOINLINE
#endif

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Beyond all lengths in units (base::max_units is 2^60), so minima and maxima may start there.
inline constexpr float far_off = 0x1p100F;

LIMBER_KERNEL Packet zero() { return Packet::set(0); }

/// A vector of three packets.
template <typename P>
struct Triple {
  P x, y, z;
};
using Packet3 = Triple<Packet>;

template <typename P>
LIMBER_KERNEL Triple<P> operator+(const Triple<P>& a, const Triple<P>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename P>
LIMBER_KERNEL Triple<P> operator-(const Triple<P>& a, const Triple<P>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename P>
LIMBER_KERNEL Triple<P> operator*(const Triple<P>& a, P s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <typename P>
LIMBER_KERNEL P dot(const Triple<P>& a, const Triple<P>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename P>
LIMBER_KERNEL Triple<P> cross(const Triple<P>& a, const Triple<P>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename P>
LIMBER_KERNEL Triple<P> min3(const Triple<P>& a, const Triple<P>& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
template <typename P>
LIMBER_KERNEL Triple<P> max3(const Triple<P>& a, const Triple<P>& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
template <typename P>
LIMBER_KERNEL P largest_abs(const Triple<P>& a) {
  return max(max(abs(a.x), abs(a.y)), abs(a.z));
}
template <typename M, typename P>
LIMBER_KERNEL Triple<P> select(M which, const Triple<P>& a, const Triple<P>& b) {
  return {select(which, a.x, b.x), select(which, a.y, b.y), select(which, a.z, b.z)};
}
/// v or -v, whichever has the nonnegative dot product with `side`.
template <typename P>
LIMBER_KERNEL Triple<P> aligned(const Triple<P>& v, const Triple<P>& side) {
  const P cosine = dot(v, side);
  return {flipped_as(v.x, cosine), flipped_as(v.y, cosine), flipped_as(v.z, cosine)};
}

/// The vector v in every lane.
LIMBER_KERNEL Packet3 broadcast(const float* v) { return {Packet::set(v[0]), Packet::set(v[1]), Packet::set(v[2])}; }
/// The vectors of the slots `i` and following: v[axis][slot].
template <std::size_t slots>
LIMBER_KERNEL Packet3 load3(const float (&v)[3][slots], std::uint32_t i) {
  return {Packet::load(v[0] + i), Packet::load(v[1] + i), Packet::load(v[2] + i)};
}
template <std::size_t slots>
LIMBER_KERNEL void store3(const Packet3& p, float (&v)[3][slots], std::uint32_t i) {
  p.x.store(v[0] + i), p.y.store(v[1] + i), p.z.store(v[2] + i);
}
/// As many points as a packet has numbers, of four numbers each, one after the other; the last number is not used.
LIMBER_KERNEL Packet3 load_points3(const float* p) {
  Packet3 points;
  load_points(p, points.x, points.y, points.z);
  return points;
}
/// Stores points where load_points3() reads them; the fourth number is x again.
LIMBER_KERNEL void store_points3(const Packet3& v, float* p) { store_interleaved(v.x, v.y, v.z, p); }

// A WidePacket that is one Packet has one half: itself. With AVX-512, where HWY_MAX_BYTES is 64, it is two, and
// highway_packets-inl.h defines these five.
#if !defined(HWY_MAX_BYTES) || HWY_MAX_BYTES != 64
LIMBER_KERNEL Packet duplicated(Packet a) { return a; }    // `a` as each half
LIMBER_KERNEL Packet first_of(Packet a) { return a; }      // the first half
LIMBER_KERNEL Packet last_of(Packet a) { return a; }       // the last half
LIMBER_KERNEL Packet larger_half(Packet a) { return a; }   // the larger number of both halves, in each lane
LIMBER_KERNEL Packet smaller_half(Packet a) { return a; }  // the smaller number
#endif
LIMBER_KERNEL Triple<WidePacket> duplicated(const Packet3& p) {
  return {duplicated(p.x), duplicated(p.y), duplicated(p.z)};
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif
