// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "output.h"

/// Pages with a view in 3D, which are built from web/pages into apps/limber/pages and are part of the program.
namespace limber::program {

extern const std::string_view report_template;  ///< of `limber distance`
extern const std::string_view replay_template;  ///< of `limber track` and `limber demo`

/// The page with its data in place, to which the program's version and the command line are added.
///
/// Pre      All numbers are finite.
std::string filled_page(std::string_view page, Json data, const std::string& command_line);

}  // namespace limber::program
