// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "command/output.h"
#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"

namespace limber::program {
namespace {

constexpr std::size_t line_width = 80;
constexpr std::size_t name_width = 30;
constexpr const char* version_line = "limber " LIMBER_VERSION;

/// Help in lines that fit into a terminal, the same with every version of CLI11.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode /*mode*/) const override {
    std::string usage = "Usage: " + name + " [OPTIONS]";
    std::string arguments, options, verbs;
    for (const CLI::Option* option : app->get_options()) {
      const bool is_argument = option->get_positional();
      if (is_argument) usage += ' ' + make_option_usage(option);
      const std::string line = entry(option->get_name(is_argument, true) + details(option), option->get_description());
      if (!option->get_group().empty()) (is_argument ? arguments : options) += line;
    }
    for (const CLI::App* verb : app->get_subcommands({})) verbs += entry(verb->get_name(), verb->get_description());
    if (!verbs.empty()) usage += " VERB";
    std::string help = wrapped(app->get_description(), line_width) + "\n\n" + usage + '\n';
    if (!arguments.empty()) help += "\nArguments:\n" + arguments;
    help += "\nOptions:\n" + options;
    if (!verbs.empty()) help += "\nVerbs:\n" + verbs;
    const std::string footer = app->get_footer();
    return help + '\n' + (footer.empty() ? std::string() : wrapped(trimmed(footer), line_width) + '\n');
  }

 private:
  /// The type and the default of an option, as help shows them behind its name.
  static std::string details(const CLI::Option* option) {
    std::string text;
    if (option->get_type_size() != 0) {
      if (const std::string type = option->get_type_name(); !type.empty()) text += ' ' + type;
      if (const std::string value = option->get_default_str(); !value.empty()) text += '=' + value;
      if (option->get_expected_max() > 1) text += " ...";
      if (option->get_required()) text += " REQUIRED";
    }
    return text;
  }

  static std::string entry(const std::string& name, const std::string& description) {
    std::string text = fmt::format("  {:<{}}", name, name_width - 2);
    const std::string next_line = '\n' + std::string(name_width, ' ');
    if (name.size() + 2 >= name_width) text += next_line;
    for (const char c : wrapped(description, line_width - name_width)) {
      text += c == '\n' ? next_line : std::string(1, c);
    }
    return text + '\n';
  }
};

std::vector<std::string> verb_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

bool is_option(std::string_view word) { return word.size() > 1 && word.front() == '-'; }

std::string no_such_verb(const CLI::App& app, const std::string& word) {
  const std::vector<std::string> names = verb_names(app);
  const std::optional<std::string> meant = nearest(word, names);
  return meant ? fmt::format("'{}' is no verb; did you mean {}?", word, *meant)
               : fmt::format("'{}' is no verb; there are {}", word, fmt::join(names, ", "));
}

/// What is said about options that a command does not have, in the order in which they were typed; empty without one.
std::string no_such_options(const CLI::App& command) {
  std::string text;
  for (const std::string& word : command.remaining()) {
    if (!is_option(word)) continue;
    const std::string name = word.substr(0, word.find('='));
    text += fmt::format("{}'{}' is no option", text.empty() ? "" : "; ", name);
    if (const auto meant = nearest(name, option_names(command))) text += fmt::format(", did you mean {}?", *meant);
  }
  return text;
}

std::string verb_error(const CLI::App& app, const CLI::App& verb, const CLI::ParseError& error) {
  if (std::string text = no_such_options(verb); !text.empty()) return text;
  if (const std::vector<std::string> words = app.remaining(); !words.empty()) {
    return fmt::format("'{}' stands before the verb; options follow it", words.front());
  }
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) {
    const std::vector<std::string> words = verb.remaining();
    return fmt::format("there is no place for '{}'", fmt::join(words, "' and '"));
  }
  return error.what();
}

std::string help_of(const CLI::App& app, const CLI::App& command) {
  const std::string& name = app.get_name();
  return app.get_formatter()->make_help(&command, &command == &app ? name : name + ' ' + command.get_name(),
                                        CLI::AppFormatMode::Normal);
}

std::string help_about(const CLI::App& app, const std::string& word) {
  if (word.empty()) return help_of(app, app);
  for (const CLI::App* verb : app.get_subcommands({})) {
    if (verb->get_name() == word) return help_of(app, *verb);
  }
  throw BadInput(no_such_verb(app, word));
}

/// All help of the program and its verbs as a manual page: lines of man(7), which stay as they are.
std::string manual_page(const CLI::App& app) {
  std::string page = fmt::format(
      ".TH LIMBER 1 \"\" \"{}\" \"User Commands\"\n.SH NAME\nlimber \\- {}\n.SH SYNOPSIS\nlimber [OPTIONS] VERB\n",
      version_line, app.get_description());
  const auto add_section = [&](const std::string& heading, const CLI::App& command) {
    page += heading + "\n.nf\n.in 0\n";
    char before = '\n';
    for (const char c : help_of(app, command)) {
      if (before == '\n' && (c == '.' || c == '\'')) page += "\\&";
      page += c == '\\' ? std::string("\\(rs") : c == '-' ? "\\-" : std::string(1, c);
      before = c;
    }
  };
  add_section(".SH DESCRIPTION", app);
  for (const CLI::App* verb : app.get_subcommands({})) add_section(".SH limber " + verb->get_name(), *verb);
  return page;
}

/// A word as a shell reads it back.
std::string shell_word(std::string_view word) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789%+,-./:=@_";
  if (!word.empty() && word.find_first_not_of(plain) == std::string_view::npos) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + '\'';
}

/// The command line as it could be typed into a shell, the program called limber.
std::string typed_line(int argc, const char* const* argv) {
  std::string line = "limber";
  for (int i = 1; i < argc; ++i) line += ' ' + shell_word(argv[i]);
  return line;
}

/// What the program says about itself. Verbs that are added later take over how help is written.
void describe(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "print this help");
  app.set_version_flag("-v,--version", version_line, "print the version");
  app.require_subcommand(1);
  app.footer(R"(
limber VERB --help, or limber help VERB, tells more. Models are mesh files (.obj .ply .stl .off .gltf .glb) or built-in
meshes scene:square, scene:ball, scene:sheet. In help, OPTION TYPE=VALUE tells the default of an option.

Exit status:

  0  there is an answer
  1  the program has failed, or the answer could not be written
  2  bad usage or bad input; one line on standard error says what and where
  3  there is an answer, and something was found; only where options say so
  4  the same, but it is open whether something is found, because of --mesh-error

Examples:

    limber demo
    limber info gear.obj
    limber distance gear.obj housing.stl --pose-b 0,0,12.5,1,0,0,0
    limber contacts gear.obj housing.stl --margin 0.1 --out contacts.csv
    limber track --a cloth_*.ply --b scene:ball > distances.csv
)");
}

Verb add_help(CLI::App& app) {
  const auto word = std::make_shared<std::string>();
  const auto as_manual = std::make_shared<bool>(false);
  CLI::App& command = *app.add_subcommand("help", "This help, or that of a verb");
  command.add_option("VERB", *word, "the verb; without it, the help of the program")->type_name("");
  command.add_flag("--man", *as_manual, "all help as a manual page, in the language of man");
  command.footer("");
  command.parse_complete_callback([word, as_manual] {
    if (*as_manual && !word->empty()) throw CLI::ValidationError("--man", "leaves no room for VERB");
  });
  return {&command, [&app, word, as_manual] {
            write(*as_manual ? manual_page(app) : help_about(app, *word));
            return ExitCode::answered;
          }};
}

/// One line about a command line that `app` did not understand: where, and what is wrong.
struct UsageError {
  std::string place;  ///< "distance: ", or empty
  std::string text;
};

UsageError usage_error(const CLI::App& app, const CLI::ParseError& error) {
  for (const CLI::App* verb : app.get_subcommands()) return {verb->get_name() + ": ", verb_error(app, *verb, error)};
  const auto and_see_help = [](const std::string& text) {
    return text + (text.ends_with('?') ? " See limber --help" : "; see limber --help");
  };
  if (const std::string text = no_such_options(app); !text.empty()) return {{}, and_see_help(text)};
  const std::vector<std::string> words = app.remaining();
  if (!words.empty()) return {{}, and_see_help(no_such_verb(app, words.front()))};
  const bool is_missing = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError);
  if (!is_missing) return {{}, error.what()};
  return {{}, and_see_help(fmt::format("a verb is missing; there are {}", fmt::join(verb_names(app), ", ")))};
}

/// Every failure ends with this line on standard error.
ExitCode fail(ExitCode exit_code, const std::string& place, const std::string& text) {
  const std::string line = on_one_line("limber: " + place + text) + '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
  return exit_code;
}

ExitCode run(const std::string& place, const std::function<ExitCode()>& body) {
  try {
    const ExitCode exit_code = body();
    place_outputs();
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
      add_self(app), add_points(app),          add_track(app, typed), add_demo(app, typed), add_help(app)};
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
  limber::program::prepare_streams();
  try {
    return static_cast<int>(limber::program::main_program(argc, argv));
  } catch (...) {
    std::fputs("limber: internal error before anything was read\n", stderr);
    return 1;
  }
}
