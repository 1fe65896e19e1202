// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Packets of numbers in Highway's vectors; see packets-inl.h.

#if defined(LIMBER_SIMD_HIGHWAY_PACKETS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_HIGHWAY_PACKETS_INL_H
#undef LIMBER_SIMD_HIGHWAY_PACKETS_INL_H
#else
#define LIMBER_SIMD_HIGHWAY_PACKETS_INL_H
#endif

#include <hwy/highway.h>

#include <cstdint>

#include "layout/node.h"

HWY_BEFORE_NAMESPACE();
namespace limber::simd::HWY_NAMESPACE {
namespace {
using bvh::width;
namespace hn = hwy::HWY_NAMESPACE;

/// A vector of at most `most` numbers.
template <typename T, std::size_t most>
struct Vector {
  using Tag = hn::CappedTag<T, most>;
  static constexpr std::uint32_t lanes = hn::MaxLanes(Tag());
  struct Mask {
    hn::Mask<Tag> m;

    friend HWY_INLINE Mask operator&(Mask a, Mask b) { return {hn::And(a.m, b.m)}; }
    friend HWY_INLINE Mask operator|(Mask a, Mask b) { return {hn::Or(a.m, b.m)}; }
    friend HWY_INLINE Mask operator^(Mask a, Mask b) { return {hn::Xor(a.m, b.m)}; }
    friend HWY_INLINE unsigned bits(Mask a) {
      std::uint8_t byte = 0;
      hn::StoreMaskBits(Tag(), a.m, &byte);
      return byte;
    }
    friend HWY_INLINE bool all_of(Mask a) { return hn::AllTrue(Tag(), a.m); }
  };
  hn::Vec<Tag> v;

  static HWY_INLINE Vector set(T x) { return {hn::Set(Tag(), x)}; }
  /// Pre: float32 is aligned.
  static HWY_INLINE Vector load(const T* p) {
    if constexpr (sizeof(T) == sizeof(float)) return {hn::Load(Tag(), p)};
    return {hn::LoadU(Tag(), p)};
  }
  static HWY_INLINE Vector from_int16(const std::int16_t* p) {
    const hn::Rebind<std::int16_t, Tag> narrow;
    return {hn::ConvertTo(Tag(), hn::PromoteTo(hn::RebindToSigned<Tag>(), hn::Load(narrow, p)))};
  }
  static HWY_INLINE Vector from_floats(const float* p) {
    return {hn::PromoteTo(Tag(), hn::Load(hn::Rebind<float, Tag>(), p))};
  }
  HWY_INLINE void store(T* p) const { hn::StoreU(v, Tag(), p); }
  /// Pre: whole numbers.
  HWY_INLINE void store_int16(std::int16_t* p) const {
    const hn::Rebind<std::int16_t, Tag> narrow;
    hn::Store(hn::DemoteTo(narrow, hn::NearestInt(v)), narrow, p);
  }
  HWY_INLINE void store_rounded(float* p) const {
    const hn::Rebind<float, Tag> narrow;
    hn::Store(hn::DemoteTo(narrow, v), narrow, p);
  }

  friend HWY_INLINE Vector operator+(Vector a, Vector b) { return {hn::Add(a.v, b.v)}; }
  friend HWY_INLINE Vector operator-(Vector a, Vector b) { return {hn::Sub(a.v, b.v)}; }
  friend HWY_INLINE Vector operator*(Vector a, Vector b) { return {hn::Mul(a.v, b.v)}; }
  friend HWY_INLINE Vector operator/(Vector a, Vector b) { return {hn::Div(a.v, b.v)}; }
  friend HWY_INLINE Vector sqrt(Vector a) { return {hn::Sqrt(a.v)}; }
  friend HWY_INLINE Vector abs(Vector a) { return {hn::Abs(a.v)}; }
  friend HWY_INLINE Vector max(Vector a, Vector b) { return {hn::Max(a.v, b.v)}; }
  friend HWY_INLINE Vector min(Vector a, Vector b) { return {hn::Min(a.v, b.v)}; }
  friend HWY_INLINE Vector largest_in_all(Vector a) { return {hn::MaxOfLanes(Tag(), a.v)}; }
  friend HWY_INLINE T largest(Vector a) { return hn::GetLane(largest_in_all(a).v); }
  friend HWY_INLINE Mask operator>(Vector a, Vector b) { return {hn::Gt(a.v, b.v)}; }
  friend HWY_INLINE Mask operator<(Vector a, Vector b) { return {hn::Lt(a.v, b.v)}; }
  friend HWY_INLINE Mask operator<=(Vector a, Vector b) { return {hn::Le(a.v, b.v)}; }
  friend HWY_INLINE Mask operator>=(Vector a, Vector b) { return {hn::Ge(a.v, b.v)}; }
  friend HWY_INLINE Vector select(Mask m, Vector a, Vector b) { return {hn::IfThenElse(m.m, a.v, b.v)}; }
  /// a, or -a where `sign` is negative.
  friend HWY_INLINE Vector flipped_as(Vector a, Vector sign) {
    return {hn::Xor(a.v, hn::And(sign.v, hn::Set(Tag(), T{-0.0F})))};
  }
};
using Packet = Vector<float, width>;
using Mask = Packet::Mask;
using Lanes = Packet::Tag;
using Doubles = Vector<double, width>;
using DoublesMask = Doubles::Mask;
using Quad = Vector<double, 4>;
using QuadMask = Quad::Mask;

/// a, with its three last bits replaced by the number of its slot, which is `first` in the first lane.
HWY_INLINE Packet numbered(Packet a, std::uint32_t first) {
  const hn::RebindToUnsigned<Lanes> whole;
  const auto slot = hn::Iota(whole, first);
  return {hn::BitCast(Lanes(), hn::Or(hn::AndNot(hn::Set(whole, width - 1), hn::BitCast(whole, a.v)), slot))};
}

/// Slots of a leaf, one in each lane; numbers and ids that are picked by them from tables of `width`.
struct Slots {
  using Whole = hn::RebindToSigned<Lanes>;
#if HWY_TARGET == HWY_SCALAR
  std::uint32_t slot;
#else
  decltype(hn::IndicesFromVec(Lanes(), hn::Zero(Whole()))) in_vector;
  hn::Mask<Lanes> is_upper;  // of two vectors, where one does not hold a table
#endif

  /// The first or the second slots of as many pairs as there are lanes; a pair is 8 * first + second.
  static HWY_INLINE Slots first_of(const std::uint8_t* pairs) { return from(hn::ShiftRight<3>(load(pairs))); }
  static HWY_INLINE Slots second_of(const std::uint8_t* pairs) {
    return from(hn::And(load(pairs), hn::Set(Whole(), width - 1)));
  }

  template <typename Tag, typename T>
  HWY_INLINE hn::Vec<Tag> pick(Tag tag, const T* table) const {
#if HWY_TARGET == HWY_SCALAR
    return hn::Load(tag, table + slot);
#else
    const auto first = hn::BitCast(Lanes(), hn::Load(tag, table));
    if constexpr (Packet::lanes == width) {
      return hn::BitCast(tag, hn::TableLookupLanes(first, in_vector));
    } else {
      const auto second = hn::BitCast(Lanes(), hn::Load(tag, table + Packet::lanes));
      return hn::BitCast(tag, hn::IfThenElse(is_upper, hn::TableLookupLanes(second, in_vector),
                                             hn::TableLookupLanes(first, in_vector)));
    }
#endif
  }

 private:
  static HWY_INLINE hn::Vec<Whole> load(const std::uint8_t* pairs) {
    const hn::Rebind<std::uint8_t, Whole> narrow;
    return hn::PromoteTo(Whole(), hn::Load(narrow, pairs));
  }
  static HWY_INLINE Slots from(hn::Vec<Whole> slots) {
#if HWY_TARGET == HWY_SCALAR
    return {static_cast<std::uint32_t>(hn::GetLane(slots))};
#else
    const auto last = hn::Set(Whole(), static_cast<std::int32_t>(Packet::lanes) - 1);
    return {hn::IndicesFromVec(Lanes(), hn::And(slots, last)), hn::RebindMask(Lanes(), hn::Gt(slots, last))};
#endif
  }
};
HWY_INLINE Packet pick(const float* table, const Slots& slots) { return {slots.pick(Lanes(), table)}; }

/// As many ids as a packet has numbers.
struct Ids {
  using Tag = hn::RebindToUnsigned<Lanes>;
  hn::Vec<Tag> v;

  static HWY_INLINE Ids set(std::uint32_t id) { return {hn::Set(Tag(), id)}; }
  static HWY_INLINE Ids load(const std::uint32_t* ids) { return {hn::Load(Tag(), ids)}; }
  HWY_INLINE void store(std::uint32_t* ids) const { hn::StoreU(v, Tag(), ids); }
};
HWY_INLINE Ids pick(const std::uint32_t* table, const Slots& slots) { return {slots.pick(Ids::Tag(), table)}; }
HWY_INLINE Mask operator==(Ids a, Ids b) { return {hn::RebindMask(Lanes(), hn::Eq(a.v, b.v))}; }
/// The first, second and third of each three ids, as many as there are lanes.
HWY_INLINE void deinterleave(const std::uint32_t* ids, std::uint32_t* first, std::uint32_t* second,
                             std::uint32_t* third) {
  const Ids::Tag tag;
  hn::Vec<Ids::Tag> x, y, z;
  hn::LoadInterleaved3(tag, ids, x, y, z);
  hn::Store(x, tag, first), hn::Store(y, tag, second), hn::Store(z, tag, third);
}

/// Two packets at once where there is room, otherwise one.
#if HWY_MAX_BYTES == 64
using WidePacket = Vector<float, 2 * width>;
HWY_INLINE WidePacket duplicated(Packet a) { return {hn::Combine(WidePacket::Tag(), a.v, a.v)}; }
HWY_INLINE Packet first_of(WidePacket a) { return {hn::LowerHalf(Lanes(), a.v)}; }
HWY_INLINE Packet last_of(WidePacket a) { return {hn::UpperHalf(Lanes(), a.v)}; }
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
#endif

/// As many points as there are numbers in a packet.
template <typename P>
HWY_INLINE void load_points(const double* p, P& x, P& y, P& z) {
  hn::LoadInterleaved3(typename P::Tag(), p, x.v, y.v, z.v);
}
/// x where it is at least `least` in size, 0 elsewhere.
HWY_INLINE Doubles or_zero(Doubles x, Doubles size_of, double least) {
  return {hn::IfThenElseZero(hn::Ge(hn::Abs(size_of.v), hn::Set(Doubles::Tag(), least)), x.v)};
}

/// Moves `corners_at_once` points to an origin and scales them: (p - origin) * factor. Writes four numbers for each.
struct PointScaler {
  using Tag = hn::CappedTag<double, 4 * corners_at_once>;
  static constexpr std::size_t parts = 4 * corners_at_once / hn::MaxLanes(Tag());
  struct Numbers {
    hn::Vec<Tag> part[parts];
  };
  using Points = const double* const[corners_at_once];
  Numbers origin;
  hn::Vec<Tag> factor;

  HWY_INLINE PointScaler(const Points& from, double per_length)
      : origin(load(from)), factor(hn::Set(Tag(), per_length)) {}
  HWY_INLINE void scale(const Points& points, float* scaled) const {
    const hn::Rebind<float, Tag> narrow;
    const Numbers p = load(points);
    for (std::size_t i = 0; i < parts; ++i) {
      const auto from_origin = hn::Mul(hn::Sub(p.part[i], origin.part[i]), factor);
      hn::Store(hn::DemoteTo(narrow, from_origin), narrow, scaled + i * hn::MaxLanes(Tag()));
    }
  }

 private:
  static HWY_INLINE Numbers load(const Points& points) {
    const Tag all;
#if HWY_TARGET == HWY_SCALAR
    const double* const p = points[0];
    return {hn::Set(all, p[0]), hn::Set(all, p[1]), hn::Set(all, p[2]), hn::Zero(all)};
#elif HWY_MAX_BYTES == 16
    return {hn::LoadU(all, points[0]), hn::Set(all, points[0][2])};
#elif HWY_MAX_BYTES == 32
    return {load_three(all, points[0])};
#elif HWY_MAX_BYTES == 64
    const hn::Half<Tag> one;
    return {hn::Combine(all, load_three(one, points[1]), load_three(one, points[0]))};
#endif
  }
#if HWY_MAX_BYTES >= 32
  template <typename Four>
  static HWY_INLINE hn::Vec<Four> load_three(Four four, const double* p) {
#if HWY_MEM_OPS_MIGHT_FAULT
    const hn::Half<Four> two;
    return hn::Combine(four, hn::Set(two, p[2]), hn::LoadU(two, p));
#else
    return hn::MaskedLoad(hn::FirstN(four, 3), four, p);
#endif
  }
#endif
};

/// As many points as a packet has numbers, each as four numbers, of which the last does not matter.
HWY_INLINE void load_points(const float* p, Packet& x, Packet& y, Packet& z) {
  hn::Vec<Lanes> rest;
  hn::LoadInterleaved4(Lanes(), p, x.v, y.v, z.v, rest);
}
#if HWY_MAX_BYTES == 64
HWY_INLINE void load_points(const float* p, WidePacket& x, WidePacket& y, WidePacket& z) {
  // Pairs of points, first those of one row, then those of the other. 4 x 4 of each 128-bit block of four vectors, then
  // the blocks in the middle change places.
  const WidePacket::Tag d;
  const hn::Half<WidePacket::Tag> pair;
  const hn::Repartition<double, WidePacket::Tag> twos;
  const auto load = [&](const float* p) { return hn::Combine(d, hn::Load(pair, p + 32), hn::Load(pair, p)); };
  const auto a = load(p), b = load(p + 8), c = load(p + 16), e = load(p + 24);
  const auto xy_ab = hn::BitCast(twos, hn::InterleaveLower(d, a, b));
  const auto xy_ce = hn::BitCast(twos, hn::InterleaveLower(d, c, e));
  const auto z_ab = hn::BitCast(twos, hn::InterleaveUpper(d, a, b));
  const auto z_ce = hn::BitCast(twos, hn::InterleaveUpper(d, c, e));
  alignas(64) static constexpr std::int64_t swapped[8] = {0, 1, 4, 5, 2, 3, 6, 7};
  const auto in_order = [&](auto v) {
    return hn::BitCast(d, hn::TableLookupLanes(v, hn::SetTableIndices(twos, swapped)));
  };
  x.v = in_order(hn::InterleaveLower(twos, xy_ab, xy_ce));
  y.v = in_order(hn::InterleaveUpper(twos, xy_ab, xy_ce));
  z.v = in_order(hn::InterleaveLower(twos, z_ab, z_ce));
}
#endif
HWY_INLINE void store_interleaved(Packet x, Packet y, Packet z, float* p) {
  hn::StoreInterleaved4(x.v, y.v, z.v, x.v, Lanes(), p);
}

/// `width` rows of as many numbers, rounded to int16, in which they fit.
struct Int16Tile {
#if HWY_TARGET == HWY_SCALAR
  std::int16_t v[width * width];

  HWY_INLINE void put(std::uint32_t at, WidePacket p) {
    v[at] = static_cast<std::int16_t>(hn::GetLane(hn::NearestInt(p.v)));
  }
  HWY_INLINE void store_columns(std::int16_t* const (&columns)[width]) const {
    for (std::uint32_t i = 0; i < width * width; ++i) columns[i % width][i / width] = v[i];
  }
#elif HWY_MAX_BYTES == 64
  using Wide = hn::Full512<std::int32_t>;
  using Narrow = hn::Full512<std::int16_t>;
  hn::Vec<Wide> v[width / 2];  // two rows each

  HWY_INLINE void put(std::uint32_t at, WidePacket p) { v[at / (2 * width)] = hn::NearestInt(p.v); }
  HWY_INLINE void store_columns(std::int16_t* const (&columns)[width]) const {
    const Narrow d;
    const Wide pairs;
    // By 128-bit blocks, digits being rows: 0|4 0|4 1|5 1|5 and 2|6 2|6 3|7 3|7; then 02 02 13 13 and 46 46 57 57, of
    // four columns each; then 0246 0246 1357 1357, of two; then one column each.
    const auto first = hn::ReorderDemote2To(d, v[0], v[2]), second = hn::ReorderDemote2To(d, v[1], v[3]);
    const auto upper_rows = hn::BitCast(pairs, hn::InterleaveLower(d, first, second));
    const auto lower_rows = hn::BitCast(pairs, hn::InterleaveUpper(d, first, second));
    const auto left = hn::BitCast(d, hn::InterleaveLower(pairs, upper_rows, lower_rows));
    const auto right = hn::BitCast(d, hn::InterleaveUpper(pairs, upper_rows, lower_rows));
    const auto even = hn::ConcatLowerLower(d, right, left), odd = hn::ConcatUpperUpper(d, right, left);
    store_four(hn::InterleaveLower(d, even, odd), columns[0], columns[4], columns[2], columns[6]);
    store_four(hn::InterleaveUpper(d, even, odd), columns[1], columns[5], columns[3], columns[7]);
  }

 private:
  static HWY_INLINE void store_four(hn::Vec<Narrow> four, std::int16_t* a, std::int16_t* b, std::int16_t* c,
                                    std::int16_t* e) {
    const hn::Half<Narrow> two;
    const hn::Half<hn::Half<Narrow> > one;
    const auto lower = hn::LowerHalf(two, four), upper = hn::UpperHalf(two, four);
    hn::Store(hn::LowerHalf(one, lower), one, a), hn::Store(hn::UpperHalf(one, lower), one, b);
    hn::Store(hn::LowerHalf(one, upper), one, c), hn::Store(hn::UpperHalf(one, upper), one, e);
  }
#else
  alignas(64) std::int32_t v[width * width];

  HWY_INLINE void put(std::uint32_t at, WidePacket p) {
    const hn::RebindToSigned<Lanes> whole;
    hn::Store(hn::NearestInt(p.v), whole, v + at);
  }
  HWY_INLINE void store_columns(std::int16_t* const (&columns)[width]) const {
    const hn::Full128<std::int16_t> narrow;
    const hn::Full128<std::int32_t> wide;
    hn::Vec<decltype(narrow)> rows[width], mixed[width];
    for (std::uint32_t i = 0; i < width; ++i) {
      // In vectors of 16 bytes there is nothing to be reordered.
      const std::int32_t* const row = v + i * width;
      rows[i] = hn::ReorderDemote2To(narrow, hn::Load(wide, row), hn::Load(wide, row + width / 2));
    }
    // Interleaving the first half with the second three times brings every number to its mirror image's place.
    for (int round = 0; round < 3; ++round) {
      for (std::uint32_t i = 0; i < width; i += 2) {
        mixed[i] = hn::InterleaveLower(narrow, rows[i / 2], rows[i / 2 + 4]);
        mixed[i + 1] = hn::InterleaveUpper(narrow, rows[i / 2], rows[i / 2 + 4]);
      }
      for (std::uint32_t i = 0; i < width; ++i) rows[i] = mixed[i];
    }
    for (std::uint32_t i = 0; i < width; ++i) hn::Store(rows[i], narrow, columns[i]);
  }
#endif
};

}  // namespace
}  // namespace limber::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
