// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "command/verb.h"

/// The command line apart from the verbs: help, version, and what is said about a command line that cannot be read.
namespace limber::program {

/// What the program says about itself. Verbs that are added later take over how help is written.
void describe(CLI::App& app);

/// The command line as it could be typed into a shell, the program called limber.
std::string typed_line(int argc, const char* const* argv);

Verb add_help(CLI::App& app);
Verb add_version(CLI::App& app);

/// One line about a command line that `app` did not understand: where, and what is wrong.
struct UsageError {
  std::string place;  ///< "distance: ", or empty
  std::string text;
};
UsageError usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace limber::program
