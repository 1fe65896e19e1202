// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/box_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "layout/node.h"

namespace limber::scene {
namespace {

constexpr unsigned bits_per_axis = 6, code_bits = 3 * bits_per_axis;
constexpr double cells_per_axis = 1 << bits_per_axis;

// Points closer than this have no order that matters.
constexpr double smallest_extent = 0x1p-900;

// Entries that are faster sorted by comparisons.
constexpr std::size_t few = 128;

/// Where the cells of a cube of 4 x 4 x 4 are on the Hilbert curve, for each of the ways in which it may pass through.
///
/// A way is the corner at which the curve enters, one bit for each axis, and the axis along which it leaves:
/// 8 * axis + corner. A cell is named by its coordinates, interleaved bit by bit.
class HilbertCurve {
 public:
  constexpr HilbertCurve() {
    for (unsigned way = 0; way < ways; ++way) {
      for (unsigned cell = 0; cell < cells; ++cell) {
        const Step first = step(way, cell / parts), second = step(first.way, cell % parts);
        steps_[way][cell] = static_cast<std::uint16_t>((second.way * parts + first.place) * parts + second.place);
      }
    }
    for (unsigned x = 0; x < 1U << bits_per_axis; ++x) {
      for (unsigned bit = 0; bit < bits_per_axis; ++bit) spread_[x] |= (x >> bit & 1) << 3 * bit;
    }
  }
  /// The place of a cell on the curve. Pre: coordinates are less than cells_per_axis.
  std::uint32_t operator()(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    const std::uint32_t interleaved = spread_[x] | spread_[y] << 1 | spread_[z] << 2;
    std::uint32_t place = 0, way = 0;
    static_assert(code_bits % 6 == 0);
    for (unsigned bit = code_bits; bit > 0; bit -= 6) {
      const std::uint16_t next = steps_[way][interleaved >> (bit - 6) & (cells - 1)];
      place = place << 6 | (next & (cells - 1));
      way = next >> 6;
    }
    return place;
  }

 private:
  static constexpr unsigned axes = 3, parts = 8, cells = parts * parts, ways = axes * parts;

  /// The place of a part of a cube among its eight, and the way through that part.
  struct Step {
    unsigned place, way;
  };
  static constexpr Step step(unsigned way, unsigned part) {
    const unsigned entry = way % parts, axis = way / parts;
    const unsigned turned = rotated_left(part ^ entry, 2 * axes - axis - 1);
    const unsigned place = turned ^ turned >> 1 ^ turned >> 2;
    const unsigned next_entry = place == 0 ? 0 : gray_code((place - 1) / 2 * 2);
    const int ones = place == 0 ? 0 : std::countr_one(place % 2 == 0 ? place - 1 : place);
    const unsigned next_axis = (axis + static_cast<unsigned>(ones) % axes + 1) % axes;
    return {place, next_axis * parts + (entry ^ rotated_left(next_entry, axis + 1))};
  }
  static constexpr unsigned rotated_left(unsigned part, unsigned by) {
    return (part << by % axes | part >> (axes - by % axes)) % parts;
  }
  static constexpr unsigned gray_code(unsigned i) { return i ^ i >> 1; }

  std::uint16_t steps_[ways][cells] = {};
  std::uint32_t spread_[1U << bits_per_axis] = {};
};
constexpr HilbertCurve place_on_curve;

std::uint32_t index_of(std::uint64_t entry) { return static_cast<std::uint32_t>(entry); }
std::uint64_t place_of(std::uint64_t entry) { return entry >> 32; }

}  // namespace

std::optional<HilbertGrid> HilbertGrid::of(const Vec3& low, const Vec3& high) {
  const double extent = max_abs(high - low);
  if (extent < smallest_extent) return std::nullopt;
  HilbertGrid grid;
  grid.low_ = low, grid.high_ = high, grid.per_length_ = cells_per_axis / extent;
  return grid;
}

std::uint32_t HilbertGrid::cell_of(const Vec3& p) const {
  const auto cell = [&](double from_low) {
    return static_cast<std::uint32_t>(std::min(from_low * per_length_, cells_per_axis - 1));
  };
  const Vec3 from_low = p - low_;
  return place_on_curve(cell(from_low.x), cell(from_low.y), cell(from_low.z));
}

std::span<const std::uint32_t> HilbertOrder::sort(std::span<const Vec3> centers, const HilbertGrid* grid) {
  entries_.resize(centers.size()), other_entries_.resize(centers.size()), order_.resize(centers.size());
  for (std::size_t i = 0; i < centers.size(); ++i) entries_[i] = i;
  grid == nullptr ? sort_range(centers, 0, centers.size()) : sort_range(centers, 0, centers.size(), *grid);
  for (std::size_t i = 0; i < centers.size(); ++i) order_[i] = index_of(entries_[i]);
  return order_;
}

void HilbertOrder::sort_range(std::span<const Vec3> centers, std::size_t begin, std::size_t end) {
  if (end - begin <= bvh::width) return;
  Vec3 low = centers[index_of(entries_[begin])], high = low;
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3& c = centers[index_of(entries_[i])];
    low = min(low, c), high = max(high, c);
  }
  if (const auto grid = HilbertGrid::of(low, high)) sort_range(centers, begin, end, *grid);
}

void HilbertOrder::sort_range(std::span<const Vec3> centers, std::size_t begin, std::size_t end,
                              const HilbertGrid& grid) {
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t index = index_of(entries_[i]);
    entries_[i] = std::uint64_t{grid.cell_of(centers[index])} << 32 | index;
  }
  sort_entries(begin, end);
  for (std::size_t i = begin; i < end;) {
    std::size_t next = i + 1;
    while (next < end && place_of(entries_[next]) == place_of(entries_[i])) ++next;
    sort_range(centers, i, next);
    i = next;
  }
}

void HilbertOrder::sort_entries(std::size_t begin, std::size_t end) {
  const std::span<Entry> entries(entries_.data() + begin, end - begin);
  if (entries.size() <= few) return std::sort(entries.begin(), entries.end());
  // By digits, the last one first. Entries of one cell stay in the order of their indices, if they were.
  constexpr unsigned digits = 2, digit_bits = code_bits / digits;
  constexpr std::size_t values = std::size_t{1} << digit_bits;
  std::array<std::array<std::uint32_t, values>, digits> counts{};
  const auto digit = [](Entry entry, unsigned k) {
    return static_cast<std::size_t>(entry >> (32 + k * digit_bits)) % values;
  };
  for (const Entry entry : entries) {
    for (unsigned k = 0; k < digits; ++k) ++counts[k][digit(entry, k)];
  }
  std::span<Entry> from = entries, to(other_entries_.data() + begin, entries.size());
  static_assert(digits % 2 == 0);  // so that they end where they were
  for (unsigned k = 0; k < digits; ++k) {
    std::uint32_t first = 0;
    for (std::uint32_t& count : counts[k]) first += std::exchange(count, first);
    for (const Entry entry : from) to[counts[k][digit(entry, k)]++] = entry;
    std::swap(from, to);
  }
}

}  // namespace limber::scene
