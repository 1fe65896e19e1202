// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "limber/base.h"

/// Words, lines and numbers of mesh files, independent of any locale.
namespace limber::io {

inline Error malformed(std::string reason) { return {ErrorCode::malformed_file, std::move(reason), {}}; }

/// The same for a place that can be counted: "vertex 7: reason".
inline Error malformed(std::string_view what, std::size_t where, std::string_view reason) {
  return {ErrorCode::malformed_file, std::string(what) + " " + std::to_string(where) + ": " + std::string(reason),
          where};
}

inline Error not_finite(std::size_t vertex) {
  return {ErrorCode::non_finite, "vertex " + std::to_string(vertex) + " is not finite", vertex};
}

/// A word as it may appear in a message: short and printable.
inline std::string quoted(std::string_view word) {
  std::string text = "'";
  for (const char c : word.substr(0, 20)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > 20 ? "...'" : "'");
}

/// Takes the first line, ended by LF, CR LF or CR, off the front of `rest`.
inline std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find_first_of("\r\n");
  const std::string_view line = rest.substr(0, end);
  if (end == std::string_view::npos) {
    rest = {};
  } else {
    rest.remove_prefix(end + (rest.substr(end, 2) == "\r\n" ? 2 : 1));
  }
  return line;
}

/// Takes the first word off the front of `rest`; empty at the end.
inline std::string_view take_word(std::string_view& rest) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
  const std::string_view word = rest.substr(0, rest.find_first_of(blanks));
  rest.remove_prefix(word.size());
  return word;
}

/// The front of `line` up to a comment, which "1.#INF" is not.
inline std::string_view without_comment(std::string_view line) {
  std::size_t at = line.find('#');
  while (at != line.npos && at > 0 && line[at - 1] == '.' && at + 1 < line.size() && line[at + 1] >= 'I' &&
         line[at + 1] <= 'S') {
    at = line.find('#', at + 1);
  }
  return line.substr(0, at);
}

inline std::string_view without_byte_order_mark(std::string_view file) {
  return file.substr(file.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0);
}

/// The word as an integer, if all of it is one and it fits.
template <typename Integer>
std::optional<Integer> integer(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Integer value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return {};
  return value;
}

enum class NumberKind { finite, non_finite, none };

/// Whether the word is a number from end to end. "1.#INF" and the like, which Microsoft's runtime wrote, are not
/// finite, nor is a number beyond the range of float64.
inline NumberKind number_kind(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) {
    const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
    return tiny ? NumberKind::finite : NumberKind::non_finite;
  }
  if (error != std::errc()) return NumberKind::none;
  if (end != word.data() + word.size()) {
    return word.find("#I") != word.npos || word.find("#Q") != word.npos || word.find("#S") != word.npos
               ? NumberKind::non_finite
               : NumberKind::none;
  }
  return std::isfinite(value) ? NumberKind::finite : NumberKind::non_finite;
}

/// Checks a coordinate of a vertex.
inline Result<void> check_coordinate(std::string_view word, std::size_t vertex) {
  switch (number_kind(word)) {
    case NumberKind::finite:
      return {};
    case NumberKind::non_finite:
      return not_finite(vertex);
    case NumberKind::none:
      break;
  }
  return malformed("vertex", vertex, word.empty() ? "fewer than three coordinates" : quoted(word) + " is not a number");
}

}  // namespace limber::io
