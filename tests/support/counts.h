// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef LIMBER_TESTS_SUPPORT_COUNTS_H
#define LIMBER_TESTS_SUPPORT_COUNTS_H

#include <cstdint>
#include <cstdlib>
#include <string>

namespace limber::testing {

/// How many cases a long test draws: the number in an environment variable, or the usual one.
inline std::uint64_t count_from(const char* variable, std::uint64_t usual) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::stoull(text) : usual;
}

}  // namespace limber::testing

#endif  // LIMBER_TESTS_SUPPORT_COUNTS_H
