// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "missing_from_libcxx.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#if _LIBCPP_VERSION < 20000
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// How many characters of `text` are digits, from `at` on.
std::size_t digits_at(std::string_view text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && is_digit(text[end])) ++end;
  return end - at;
}

/// How many characters at the front of `text` are a decimal without a sign; 0 if it begins with none.
std::size_t decimal_size(std::string_view text) {
  const std::size_t whole = digits_at(text, 0);
  std::size_t end = whole, fraction = 0;
  if (end < text.size() && text[end] == '.') {
    fraction = digits_at(text, end + 1);
    if (whole + fraction > 0) end += 1 + fraction;
  }
  if (whole + fraction == 0) return 0;
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    const bool has_sign = end + 1 < text.size() && (text[end + 1] == '-' || text[end + 1] == '+');
    const std::size_t exponent = digits_at(text, end + 1 + (has_sign ? 1 : 0));
    if (exponent > 0) end += 1 + (has_sign ? 1 : 0) + exponent;
  }
  return end;
}

bool starts_with_word(std::string_view text, std::string_view lower_case) {
  if (text.size() < lower_case.size()) return false;
  for (std::size_t i = 0; i < lower_case.size(); ++i) {
    if ((text[i] | 0x20) != lower_case[i]) return false;
  }
  return true;
}

/// How many characters at the front of `text` stand for a NaN.
std::size_t nan_size(std::string_view text) {
  std::size_t end = 3;
  if (end == text.size() || text[end] != '(') return end;
  for (++end; end < text.size() && (is_digit(text[end]) || text[end] == '_' || std::isalpha(text[end]) != 0);) ++end;
  return end < text.size() && text[end] == ')' ? end + 1 : 3;
}

/// The value of a decimal of few digits: both its digits and the power of ten are numbers of float64, so that their
/// product or quotient is rounded once. Based on [Clinger1990].
std::optional<double> short_decimal(std::string_view text) {
  static constexpr double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr int most_digits = 15, most_exponent = 22;
  const std::size_t exponent_at = std::min(text.find_first_of("eE"), text.size());
  double digits = 0;
  int count = 0, exponent = 0;
  bool is_fraction = false;
  for (const char c : text.substr(0, exponent_at)) {
    if (c == '.') {
      is_fraction = true;
      continue;
    }
    digits = 10 * digits + (c - '0');
    if (digits != 0) ++count;
    if (is_fraction) --exponent;
  }
  if (exponent_at < text.size()) {
    std::string_view word = text.substr(exponent_at + 1);
    word.remove_prefix(word.starts_with('+') ? 1 : 0);
    int written = 0;
    if (std::from_chars(word.data(), word.data() + word.size(), written).ec != std::errc()) return {};
    if (written > 400 || written < -400) return {};
    exponent += written;
  }
  if (count > most_digits || exponent > most_exponent || exponent < -most_exponent) return {};
  return exponent < 0 ? digits / powers[-exponent] : digits * powers[exponent];
}

}  // namespace

std::from_chars_result std::from_chars(const char* first, const char* last, double& value) {
  std::string_view text(first, static_cast<std::size_t>(last - first));
  const bool is_negative = text.starts_with('-');
  text.remove_prefix(is_negative ? 1 : 0);
  const auto after = [&](std::size_t size) { return text.data() + size; };
  if (starts_with_word(text, "nan")) {
    value = std::numeric_limits<double>::quiet_NaN();
    return {after(nan_size(text)), std::errc()};
  }
  if (starts_with_word(text, "inf")) {
    value = is_negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    return {after(starts_with_word(text, "infinity") ? 8 : 3), std::errc()};
  }
  const std::size_t size = decimal_size(text);
  if (size == 0) return {first, std::errc::invalid_argument};
  if (const std::optional<double> size_of_value = short_decimal(text.substr(0, size))) {
    value = is_negative ? -*size_of_value : *size_of_value;
    return {after(size), std::errc()};
  }
  // The C library reads decimals of any length, rounded correctly; it wants them ended by a zero.
  const double size_of_value = std::strtod(std::string(text.substr(0, size)).c_str(), nullptr);
  const std::string_view mantissa = text.substr(0, std::min(text.find_first_of("eE"), size));
  const bool is_zero = mantissa.find_first_of("123456789") == mantissa.npos;
  if (std::isinf(size_of_value) || (size_of_value == 0 && !is_zero)) {
    return {after(size), std::errc::result_out_of_range};
  }
  value = is_negative ? -size_of_value : size_of_value;
  return {after(size), std::errc()};
}
#endif
