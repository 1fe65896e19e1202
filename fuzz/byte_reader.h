// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace limber::fuzz {

/// Turns an input into choices and numbers, front to back. Reads zeros once the input is used up, so that every input
/// is a complete scene and cutting an input short keeps the meaning of its first part.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool is_empty() const { return bytes_.empty(); }

  std::uint8_t byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }

  /// A number below `count`, from one byte. Pre: 1 <= count <= 256.
  std::uint32_t below(std::uint32_t count) { return byte() % count; }

  bool flag() { return below(2) == 1; }

  /// Any float64 pattern, from eight bytes.
  double any_double() {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8U | byte();
    return std::bit_cast<double>(bits);
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace limber::fuzz
