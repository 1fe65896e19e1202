// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>

#include "io/soup.h"

/// Words, lines and numbers of mesh files, independent of any locale.
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

/// Takes three coordinates off the front of `words`.
///
/// Errors   `non_finite` or `malformed_file` naming the vertex.
Result<void> take_position(std::string_view& words, std::size_t vertex, Vec3& position);

/// Why a word is no coordinate of a vertex.
Error bad_coordinate(std::string_view word, NumberKind kind, std::size_t vertex);

}  // namespace limber::io
