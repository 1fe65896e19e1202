// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace limber::program {

/// SHA-256 of bytes that come in parts, as `sha256sum` prints it.
///
/// Source   FIPS 180-4 [NIST2015].
class Sha256 {
 public:
  void add(std::string_view bytes);

  /// The digest of all bytes that were added, in 64 hexadecimal digits. Nothing may be added afterwards.
  std::string digest();

 private:
  static constexpr std::size_t block_bytes = 64;

  void add(std::uint8_t byte);
  void take_block();

  std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                         0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, block_bytes> block_{};
  std::uint64_t byte_count_ = 0;
};

}  // namespace limber::program
