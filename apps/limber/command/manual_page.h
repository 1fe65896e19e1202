// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace limber::program {

/// All help of a program and its verbs as a manual page, in the language of man(7).
///
/// In the footer of the program, a line that ends with a colon starts a section. In all footers, indented lines of the
/// form `what  its meaning` are a list, and other indented lines stay as they are.
std::string manual_page(const CLI::App& app, const std::string& version);

}  // namespace limber::program
