// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace limber::program {

/// A verb of the program: its part of the command line, and what it does once that is parsed.
///
/// Errors   `run` throws: BadInput for what the user can mend, anything else for what only we can.
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
