// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/check.h"

/// Numbers of binary files in either byte order, whatever the byte order of the machine.
namespace limber::io {

enum class ByteOrder { little, big };

/// The unsigned integer that all of `bytes`, at most eight of them, make up.
inline std::uint64_t unsigned_number(std::string_view bytes, ByteOrder order = ByteOrder::little) {
  LIMBER_ASSERT(bytes.size() <= 8);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bits = bits << 8U | static_cast<unsigned char>(bytes[order == ByteOrder::big ? i : bytes.size() - 1 - i]);
  }
  return bits;
}

/// A float32 of four bytes or a float64 of eight.
inline double float_number(std::string_view bytes, ByteOrder order = ByteOrder::little) {
  LIMBER_ASSERT(bytes.size() == 4 || bytes.size() == 8);
  const std::uint64_t bits = unsigned_number(bytes, order);
  if (bytes.size() == 8) return std::bit_cast<double>(bits);
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
}

}  // namespace limber::io
