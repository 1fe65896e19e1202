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

#include "bad_input.h"
#include "output.h"
#include "verb.h"

namespace limber::program {
namespace {

constexpr int answered = 0;
constexpr int our_failure = 1;
constexpr int bad_input = 2;

/// Every failure ends with this line on standard error.
int fail(int exit_code, const std::string& place, const std::string& text) {
  const std::string line = on_one_line("limber: " + place + text) + '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
  return exit_code;
}

int run(const std::string& place, const std::function<void()>& body) {
  try {
    body();
    flush();
    return answered;
  } catch (const BadInput& error) {
    return fail(bad_input, place, error.what());
  } catch (const OutputFailed& error) {
    const bool reader_is_gone = std::strlen(error.what()) == 0;
    return reader_is_gone ? our_failure : fail(our_failure, place, error.what());
  } catch (const std::bad_alloc&) {
    return fail(our_failure, place, "out of memory");
  } catch (const std::exception& error) {
    return fail(our_failure, place, std::string("internal error: ") + error.what());
  } catch (...) {
    return fail(our_failure, place, "internal error");
  }
}

int usage_error(const CLI::App& app, const std::vector<Verb>& verbs, int argc, const char* const* argv,
                const CLI::ParseError& error) {
  for (const Verb& verb : verbs) {
    if (app.got_subcommand(verb.command)) return fail(bad_input, verb.command->get_name() + ": ", error.what());
  }
  std::string names;
  for (const Verb& verb : verbs) names += (names.empty() ? "" : ", ") + verb.command->get_name();
  const std::string problem = argc > 1 ? "'" + std::string(argv[1]) + "' is no verb" : "a verb is missing";
  return fail(bad_input, {}, problem + "; there are " + names + "; see limber --help");
}

int main_program(int argc, const char* const* argv) {
  CLI::App app{"Distance and collision of triangle meshes that bend.", "limber"};
  app.set_version_flag("--version", "limber " LIMBER_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.footer(
      "limber VERB --help tells more. Models are mesh files or scene:NAME, e.g. scene:ball.\n"
      "Exit code: 0 on an answer, 2 on bad usage or bad input with one line on standard error, 1 on a failure of "
      "ours.");
  const std::vector<Verb> verbs = {add_info(app), add_distance(app), add_collide(app), add_track(app), add_demo(app)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return run({}, [&] {
      std::ostringstream text;
      app.exit(help_or_version, text, text);
      write(text.str());
    });
  } catch (const CLI::ParseError& error) {
    return usage_error(app, verbs, argc, argv, error);
  }
  for (const Verb& verb : verbs) {
    if (verb.command->parsed()) return run(verb.command->get_name() + ": ", verb.run);
  }
  return fail(our_failure, {}, "internal error: no verb was parsed");
}

}  // namespace
}  // namespace limber::program

int main(int argc, char** argv) {
  // When the reader of standard output is gone, a write fails, instead of a signal ending the program.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return limber::program::main_program(argc, argv);
  } catch (...) {
    std::fputs("limber: internal error before anything was read\n", stderr);
    return 1;
  }
}
