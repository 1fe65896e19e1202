// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "limber/math.h"

/// Numbers as the program reads and writes them, whatever the locale.
namespace limber::program {

/// A finite or infinite number or NaN. Nothing but spaces may stand around it.
std::optional<double> parsed_number(std::string_view text);

/// A count. Nothing may stand around it.
std::optional<std::uint64_t> parsed_count(std::string_view text);

std::string_view trimmed(std::string_view text);

/// The fields between separators, trimmed; an empty text is one empty field.
std::vector<std::string_view> fields_of(std::string_view text, char separator);

/// 17 significant digits, so that reading gives the same float64 again.
std::string to_text(double number);
std::string to_text(const Vec3& point, const char* separator);

}  // namespace limber::program
