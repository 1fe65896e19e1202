// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "base/check.h"
#include "io/soup.h"

/// Words, lines and numbers of text files, independent of any locale, and numbers of binary files, whatever the byte
/// order of the machine.
namespace limber::io {

inline bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Takes the first line, ended by LF, CR LF or CR, off the front of `rest`.
inline std::string_view take_line(std::string_view& rest) {
  std::size_t end = 0;
  while (end < rest.size() && rest[end] != '\n' && rest[end] != '\r') ++end;
  const std::string_view line = rest.substr(0, end);
  if (end < rest.size()) end += rest[end] == '\r' && end + 1 < rest.size() && rest[end + 1] == '\n' ? 2 : 1;
  rest.remove_prefix(end);
  return line;
}

/// Takes the first word off the front of `rest`; empty at the end.
inline std::string_view take_word(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_blank(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

/// Takes blanks off both ends.
std::string_view trimmed(std::string_view text);

/// The front of `line` up to a comment, which "1.#INF" is not.
std::string_view without_comment(std::string_view line);

inline std::string_view without_byte_order_mark(std::string_view file) {
  return file.substr(file.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0);
}

/// Takes off a plus sign, which std::from_chars does not read.
inline std::string_view without_plus(std::string_view word) {
  return word.substr(word.size() > 1 && word[0] == '+' && word[1] != '-' ? 1 : 0);
}

/// The word as an integer, if all of it is one and it fits.
template <typename Integer>
std::optional<Integer> integer(std::string_view word) {
  word = without_plus(word);
  Integer value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return {};
  return value;
}

enum class NumberKind { finite, non_finite, none };

struct Number {
  NumberKind kind = NumberKind::none;
  double value = 0;  ///< of a finite number
};

/// The float64 nearest to a decimal of any length that fills the word.
///
/// Decimals below the range of float64 become zero of the same sign, those above it are not finite. "1.#INF" and the
/// like, which Microsoft's runtime wrote, are not finite either.
Number number(std::string_view word);

/// The number that a word is, or else an error that names the vertex.
double coordinate(std::string_view word, std::size_t vertex);
/// Takes three coordinates off the front of `words`.
Vec3 take_position(std::string_view& words, std::size_t vertex);

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
