// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "limber/base.h"

namespace limber::base {

/// Hands a violated precondition to the process's handler.
inline void report_violation(const char* expression, const char* file, int line) {
  assert_handler()(expression, file, line);
}

/// Hands the error of a whole-structure check, which says what is broken, to the process's handler.
inline void report_violation(const Result<void>& result, const char* file, int line) {
  if (!result) report_violation(result.error().text.c_str(), file, line);
}

/// Throws std::invalid_argument.
[[noreturn]] void throw_invalid_argument(const char* text);
/// Throws std::invalid_argument about an entry of a list: "list[index] text".
[[noreturn]] void throw_invalid_entry(const char* list, std::size_t index, const char* text);

}  // namespace limber::base

/// LIMBER_REQUIRE: what the caller of a public function must get right, checked in every build. `text` names function
/// and argument.
#define LIMBER_REQUIRE(condition, text) \
  ((condition) ? static_cast<void>(0) : ::limber::base::throw_invalid_argument(text))

/// LIMBER_REQUIRE_ENTRY: the same of an entry of a list that the caller has given, such as "limber::function: points".
#define LIMBER_REQUIRE_ENTRY(condition, list, index, text) \
  ((condition) ? static_cast<void>(0) : ::limber::base::throw_invalid_entry(list, index, text))

/// LIMBER_ASSERT: an O(1) precondition. LIMBER_VALIDATE: a whole-structure check, a Result<void>, after structural
/// changes.
#if defined(LIMBER_CHECKS)
#define LIMBER_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::limber::base::report_violation(#condition, __FILE__, __LINE__))
#define LIMBER_VALIDATE(result) ::limber::base::report_violation(result, __FILE__, __LINE__)
#else
#define LIMBER_ASSERT(condition) static_cast<void>(sizeof(!(condition)))
#define LIMBER_VALIDATE(result) static_cast<void>(sizeof(!(result)))
#endif
