// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "limber/math.h"

/// Numbers as the program reads and writes them, whatever the locale; words and lines; what is said of bad ones.
namespace limber::program {

/// Bad usage or bad input: the program says the text on one line and exits with 2.
class BadInput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The value, or its error as BadInput, after `prefix`.
template <typename T>
T value_or_bad_input(Result<T> result, const std::string& prefix = {}) {
  if (!result) throw BadInput(prefix + result.error().text);
  return std::move(result).value();
}
inline void value_or_bad_input(const Result<void>& result, const std::string& prefix = {}) {
  if (!result) throw BadInput(prefix + result.error().text);
}

/// A finite or infinite number or NaN. Nothing but spaces may stand around it.
std::optional<double> parsed_number(std::string_view text);

/// The shortest text that reads back as the same float64.
std::string to_text(double number);
std::string to_text(const Vec3& point);  ///< with spaces between

/// Digits in groups of three.
std::string grouped(std::uint64_t count);

/// A time in microseconds, the one unit of short times: "0.39 us", "8 820 us".
std::string duration_text(double microseconds);

std::string_view trimmed(std::string_view text);

/// The fields between separators, trimmed; an empty text is one empty field.
std::vector<std::string_view> fields_of(std::string_view text, char separator);

/// A text from a file as it may appear in a message: short and printable.
std::string shown(std::string_view text);

/// The candidate that was probably meant by a mistyped word, if there is one: it takes few insertions, deletions,
/// replacements and swaps of neighbours to get there, or one of the two words starts with the other.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates);

/// Paragraphs broken into lines of at most `width` columns, unless a word is longer. Blank lines and lines that start
/// with a space stay as they are; other lines are joined first.
std::string wrapped(std::string_view text, std::size_t width);

}  // namespace limber::program
