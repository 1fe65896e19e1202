// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "command/output.h"

/// The page with a view in 3D, which is built from web/pages into apps/limber/pages and is part of the program.
namespace limber::program {

extern const std::string_view viewer_template;

/// The page with its data in place, to which the program's version and the command line are added. It shows a sequence
/// if the data has "rows", as that of Replay, and otherwise what distance_report() gives.
///
/// Pre      All numbers are finite.
std::string filled_page(Json data, const std::string& command_line);

}  // namespace limber::program
