// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace limber::program {

/// A verb of the program: its part of the command line, and the function to be run after parsing.
///
/// Errors   `run` throws BadInput for mistakes of the user, and anything else for failures of the program.
struct Verb {
  CLI::App* command = nullptr;
  std::function<void()> run;
};

Verb add_info(CLI::App& app);
Verb add_distance(CLI::App& app);
Verb add_collide(CLI::App& app);
Verb add_track(CLI::App& app);
Verb add_demo(CLI::App& app);

}  // namespace limber::program
