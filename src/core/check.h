// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace limber::core {

/// Hands a violated precondition to the process's handler.
void report_violation(const char* expression, const char* file, int line);

/// Throws std::invalid_argument.
[[noreturn]] void throw_invalid_argument(const char* text);

}  // namespace limber::core

/// LIMBER_REQUIRE: what the caller of a public function must get right, checked in every build. `text` names function
/// and argument.
#define LIMBER_REQUIRE(condition, text) \
  ((condition) ? static_cast<void>(0) : ::limber::core::throw_invalid_argument(text))

/// LIMBER_ASSERT: an O(1) precondition. LIMBER_VALIDATE: a whole-structure check, a Result<void>, after structural
/// changes.
#if defined(LIMBER_CHECKS)
#define LIMBER_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::limber::core::report_violation(#condition, __FILE__, __LINE__))
#define LIMBER_VALIDATE(result) LIMBER_ASSERT(static_cast<bool>(result))
#else
#define LIMBER_ASSERT(condition) static_cast<void>(sizeof(!(condition)))
#define LIMBER_VALIDATE(result) static_cast<void>(sizeof(!(result)))
#endif
