// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <sstream>
#include <vector>

#include "command/bad_input.h"
#include "command/command_line.h"
#include "command/output.h"
#include "command/verb.h"

namespace limber::program {
namespace {

/// Every failure ends with this line on standard error.
ExitCode fail(ExitCode exit_code, const std::string& place, const std::string& text) {
  const std::string line = on_one_line("limber: " + place + text) + '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
  return exit_code;
}

ExitCode run(const std::string& place, const std::function<ExitCode()>& body) {
  try {
    const ExitCode exit_code = body();
    flush();
    return exit_code;
  } catch (const BadInput& error) {
    return fail(ExitCode::bad_input, place, error.what());
  } catch (const OutputFailed& error) {
    const bool reader_is_gone = std::strlen(error.what()) == 0;
    return reader_is_gone ? ExitCode::failure : fail(ExitCode::failure, place, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::failure, place, "out of memory");
  } catch (const std::exception& error) {
    return fail(ExitCode::failure, place, std::string("internal error: ") + error.what());
  } catch (...) {
    return fail(ExitCode::failure, place, "internal error");
  }
}

ExitCode main_program(int argc, const char* const* argv) {
  CLI::App app{"Collision and distance of triangle meshes that deform", "limber"};
  describe(app);
  const std::string typed = typed_line(argc, argv);
  const std::vector<Verb> verbs = {
      add_info(app), add_distance(app, typed), add_collide(app),      add_within(app),      add_contacts(app),
      add_self(app), add_points(app),          add_track(app, typed), add_demo(app, typed), add_haptics(app),
      add_help(app), add_version(app)};
  for (const Verb& verb : verbs) verb.command->group("Verbs");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return run({}, [&] {
      std::ostringstream text;
      app.exit(help_or_version, text, text);
      write(text.str());
      return ExitCode::answered;
    });
  } catch (const CLI::ParseError& error) {
    const auto [place, text] = usage_error(app, error);
    return fail(ExitCode::bad_input, place, text);
  }
  for (const Verb& verb : verbs) {
    if (verb.command->parsed()) return run(verb.command->get_name() + ": ", verb.run);
  }
  return fail(ExitCode::failure, {}, "internal error: no verb was parsed");
}

}  // namespace
}  // namespace limber::program

int main(int argc, char** argv) {
  // When the reader of standard output is gone, a write fails, instead of a signal ending the program.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return static_cast<int>(limber::program::main_program(argc, argv));
  } catch (...) {
    std::fputs("limber: internal error before anything was read\n", stderr);
    return 1;
  }
}
