// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/decimal.h"

#if defined(_LIBCPP_VERSION) && (_LIBCPP_VERSION < 200000 || defined(__APPLE__))
#include <algorithm>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#if defined(__APPLE__)
#include <xlocale.h>
#endif
#define LIMBER_WITHOUT_FROM_CHARS
#endif

namespace limber::io {

#if defined(LIMBER_WITHOUT_FROM_CHARS)
namespace {

constexpr std::string_view digits = "0123456789";

/// The length of the decimal at the front of `text`, which has no sign; 0 if there is none.
std::size_t length_of(std::string_view text) {
  for (const std::string_view word : {std::string_view("infinity"), std::string_view("inf"), std::string_view("nan")}) {
    std::size_t i = 0;
    while (i < word.size() && i < text.size() && (text[i] | 0x20) == word[i]) ++i;
    if (i == word.size()) return i;
  }
  const auto past_digits = [&](std::size_t from) {
    return std::min(text.find_first_not_of(digits, from), text.size());
  };
  std::size_t end = past_digits(0), count = end;
  if (end < text.size() && text[end] == '.') {
    const std::size_t fraction_end = past_digits(end + 1);
    count += fraction_end - end - 1;
    end = fraction_end;
  }
  if (count == 0) return 0;
  if (end < text.size() && (text[end] | 0x20) == 'e') {
    std::size_t power = end + 1;
    if (power < text.size() && (text[power] == '+' || text[power] == '-')) ++power;
    if (past_digits(power) > power) end = past_digits(power);
  }
  return end;
}

}  // namespace

// strtod rounds as std::from_chars does. It reads more than decimals, so these are cut out first; and it asks a locale
// for the point.
std::from_chars_result from_decimal(const char* first, const char* last, double& value) {
  static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
  const std::string_view text(first, static_cast<std::size_t>(last - first));
  const std::size_t sign = text.starts_with('-') ? 1 : 0, length = length_of(text.substr(sign));
  if (length == 0) return {first, std::errc::invalid_argument};
  const std::string decimal(text.substr(0, sign + length));
  const char* const end = first + decimal.size();
  const double number = strtod_l(decimal.c_str(), nullptr, plain);
  const bool has_digits = digits.find(decimal.back()) != digits.npos || decimal.back() == '.';
  const bool is_zero = decimal.substr(0, decimal.find_first_of("eE")).find_first_of("123456789") == decimal.npos;
  if (has_digits && (std::isinf(number) || (number == 0 && !is_zero))) return {end, std::errc::result_out_of_range};
  value = number;
  return {end, std::errc()};
}

#else

std::from_chars_result from_decimal(const char* first, const char* last, double& value) {
  return std::from_chars(first, last, value);
}

#endif

}  // namespace limber::io
