// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/scan.h"

#include <algorithm>
#include <cmath>

// libc++ reads doubles from its version 20 on, and macOS on its newest systems alone.
#if defined(_LIBCPP_VERSION) && (_LIBCPP_VERSION < 200000 || defined(__APPLE__))
#include <cerrno>
#include <clocale>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <string>
#if defined(__APPLE__)
#include <xlocale.h>
#endif
#define LIMBER_WITHOUT_FROM_CHARS
#endif

namespace limber::io {
namespace {

#if defined(LIMBER_WITHOUT_FROM_CHARS)
/// As std::from_chars(), by strtod, which rounds as that does. It reads more than decimals, so what they are made of is
/// cut out first; and it asks a locale for the point.
std::from_chars_result from_decimal(const char* first, const char* last, double& value) {
  static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
  const std::string_view text(first, static_cast<std::size_t>(last - first));
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  for (const std::string_view word : {std::string_view("infinity"), std::string_view("inf"), std::string_view("nan")}) {
    std::size_t i = 0;
    while (i < word.size() && sign + i < text.size() && (text[sign + i] | 0x20) == word[i]) ++i;
    if (i < word.size()) continue;
    if (word == "nan" && text.substr(sign + i).starts_with('('))
      i = std::min(text.find(')'), text.size() - 1) + 1 - sign;
    value = std::numeric_limits<double>::quiet_NaN();  // or infinite: nobody tells these apart
    return {first + sign + i, std::errc()};
  }
  const std::string decimal(text.substr(0, text.find_first_not_of("0123456789.eE+-")));
  char* end = nullptr;
  errno = 0;
  const double number = strtod_l(decimal.c_str(), &end, plain);
  const std::ptrdiff_t length = end - decimal.c_str();
  if (length == 0 || decimal[0] == '+') return {first, std::errc::invalid_argument};
  if (errno == ERANGE && (number == 0 || std::isinf(number))) return {first + length, std::errc::result_out_of_range};
  value = number;
  return {first + length, std::errc()};
}

#else

std::from_chars_result from_decimal(const char* first, const char* last, double& value) {
  return std::from_chars(first, last, value);
}

#endif

/// Whether a non-zero decimal that std::from_chars found out of range is too small rather than too large.
///
/// Such a decimal is below 1e-300 or above 1e300, so the power of ten of its first digit decides.
bool is_below_range(std::string_view decimal) {
  const std::size_t exponent_at = std::min(decimal.find_first_of("eE"), decimal.size());
  const std::string_view digits = decimal.substr(0, exponent_at);
  const std::size_t first_digit = digits.find_first_of("123456789");
  const std::size_t point = std::min(digits.find('.'), digits.size());
  if (first_digit == digits.npos) return true;
  const auto power_of_digits = static_cast<std::int64_t>(point) - static_cast<std::int64_t>(first_digit);
  if (exponent_at == decimal.size()) return power_of_digits <= 0;
  const std::string_view exponent_word = decimal.substr(exponent_at + 1);
  const std::optional<std::int64_t> exponent = integer<std::int64_t>(exponent_word);
  // Files are far shorter than 2^62 bytes, so an exponent of more digits outweighs all others.
  constexpr std::int64_t largest = std::int64_t{1} << 62U;
  if (!exponent || *exponent < -largest || *exponent > largest) return exponent_word.starts_with('-');
  return power_of_digits + *exponent <= 0;
}

bool is_microsoft_infinity_or_nan(std::string_view word) {
  return word.find("#I") != word.npos || word.find("#Q") != word.npos || word.find("#S") != word.npos;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view without_comment(std::string_view line) {
  std::size_t at = line.find('#');
  while (at != line.npos && at > 0 && line[at - 1] == '.' && at + 1 < line.size() && line[at + 1] >= 'I' &&
         line[at + 1] <= 'S') {
    at = line.find('#', at + 1);
  }
  return line.substr(0, at);
}

Number number(std::string_view word) {
  word = without_plus(word);
  double value = 0;
  const auto [end, error] = from_decimal(word.data(), word.data() + word.size(), value);
  const bool is_whole_word = end == word.data() + word.size();
  if (error == std::errc::invalid_argument) return {};
  if (!is_whole_word) {
    return {is_microsoft_infinity_or_nan(word) ? NumberKind::non_finite : NumberKind::none, 0};
  }
  if (error == std::errc::result_out_of_range) {
    if (!is_below_range(word)) return {NumberKind::non_finite, 0};
    return {NumberKind::finite, word.starts_with('-') ? -0.0 : 0.0};
  }
  return std::isfinite(value) ? Number{NumberKind::finite, value} : Number{NumberKind::non_finite, 0};
}

double coordinate(std::string_view word, std::size_t vertex) {
  const Number read = number(word);
  if (read.kind == NumberKind::non_finite) {
    throw BadResult({ErrorCode::non_finite, "vertex " + std::to_string(vertex) + " is not finite", vertex});
  }
  if (read.kind == NumberKind::none) {
    throw malformed("vertex", vertex,
                    word.empty() ? "fewer than three coordinates" : in_quotes(word) + " is not a number");
  }
  return read.value;
}

Vec3 take_position(std::string_view& words, std::size_t vertex) {
  Vec3 position;
  for (std::size_t axis = 0; axis < 3; ++axis) position[axis] = coordinate(take_word(words), vertex);
  return position;
}

}  // namespace limber::io
