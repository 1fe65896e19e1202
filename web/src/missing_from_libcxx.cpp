// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "missing_from_libcxx.h"

#if _LIBCPP_VERSION < 20000
#include <fast_float/fast_float.h>

std::from_chars_result std::from_chars(const char* first, const char* last, double& value) {
  const auto [end, error] = fast_float::from_chars(first, last, value);
  return {end, error};
}
#endif
