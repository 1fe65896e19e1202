// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>

namespace limber::io {

/// std::from_chars of a double, which libc++ has from its version 20 on, and macOS on its newest systems alone.
std::from_chars_result from_decimal(const char* first, const char* last, double& value);

}  // namespace limber::io
