// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace limber::program {

/// The SHA-256 of bytes in 64 hexadecimal digits, as `sha256sum` prints it.
///
/// Source   FIPS 180-4 [NIST2015].
std::string sha256_of(std::string bytes);

}  // namespace limber::program
