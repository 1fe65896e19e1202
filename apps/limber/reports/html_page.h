// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

/// The parts of a self-contained page: no scripts, nothing from elsewhere, light or dark as the reader's screen is.
namespace limber::program {

/// Everything before the content, with classes for the charts of chart_svg.h and histogram_svg.h, and with the page's
/// own style after them.
std::string page_head(const std::string& title, const std::string& own_style);
std::string page_end();

std::string page_section(const std::string& id, const std::string& title, const std::string& caption,
                         const std::string& content);

/// A number that stands out, and what it is.
std::string page_tile(const std::string& number, const std::string& name);

/// A table of names and texts.
std::string page_rows(const std::vector<std::pair<std::string, std::string>>& rows);

/// "&micro;s" instead of the "us" of plain text; numbers and their units do not break.
std::string in_html(const std::string& text);

}  // namespace limber::program
