// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace limber::program {

/// What the program ends with.
enum class ExitCode {
  answered = 0,
  failure = 1,    ///< of the program, or of writing the answer
  bad_input = 2,  ///< bad usage or bad input
  found = 3,      ///< answered, and something was found, where --exit-code, --min-clearance or --max-missed asks
  undecided = 4,  ///< answered, but the errors of the meshes leave open whether something is found
};

/// A verb of the program: its part of the command line, and the function to be run after parsing.
///
/// Errors   `run` throws BadInput for mistakes of the user, and anything else for failures of the program.
struct Verb {
  CLI::App* command = nullptr;
  std::function<ExitCode()> run;
};

Verb add_info(CLI::App& app);
/// `command_line` is what reports say about their making.
Verb add_distance(CLI::App& app, const std::string& command_line);
Verb add_collide(CLI::App& app);
Verb add_within(CLI::App& app);
Verb add_contacts(CLI::App& app);
Verb add_self(CLI::App& app);
Verb add_points(CLI::App& app);
Verb add_track(CLI::App& app, const std::string& command_line);
Verb add_demo(CLI::App& app, const std::string& command_line);

}  // namespace limber::program
