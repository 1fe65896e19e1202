// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "output.h"

/// Pages with a view in 3D, which are built from web/pages into apps/limber/pages and are part of the program.
namespace limber::program {

extern const std::string_view report_template;  ///< of `limber distance`
extern const std::string_view replay_template;  ///< of `limber track`

/// The page with its data in place.
///
/// Pre      All numbers are finite.
std::string filled_page(std::string_view page, const Json& data);

}  // namespace limber::program
