// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace limber::testing {

/// How many cases a long test draws: the number in an environment variable, or the usual one.
inline std::uint64_t count_from(const char* variable, std::uint64_t usual) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::stoull(text) : usual;
}

/// The values of an enumeration that ends with `count`.
template <typename Kind>
std::vector<Kind> every_kind() {
  std::vector<Kind> kinds;
  for (int i = 0; i < static_cast<int>(Kind::count); ++i) kinds.push_back(static_cast<Kind>(i));
  return kinds;
}

}  // namespace limber::testing
