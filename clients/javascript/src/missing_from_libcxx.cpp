// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "missing_from_libcxx.h"

#include <cstdio>

#if _LIBCPP_VERSION < 20000
#include <fast_float/fast_float.h>

std::from_chars_result std::from_chars(const char* first, const char* last, double& value) {
  const auto [end, error] = fast_float::from_chars(first, last, value);
  return {end, error};
}
#endif

#if _LIBCPP_VERSION < 14000
std::to_chars_result std::to_chars(char* first, char* last, double value, chars_format, int precision) {
  const int size = std::snprintf(first, static_cast<size_t>(last - first), "%.*g", precision, value);
  return size < last - first ? to_chars_result{first + size, {}} : to_chars_result{last, errc::value_too_large};
}
#endif
