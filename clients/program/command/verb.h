// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

#include "limber/distance.h"
#include "limber/model.h"

/// Verbs; and options whose errors are all reported in the same form. Targets hold the defaults and outlive the
/// parsing.
namespace limber::program {

/// What the program ends with.
enum class ExitCode {
  answered = 0,
  failure = 1,    ///< of the program, or of writing the answer
  bad_input = 2,  ///< bad usage or bad input
  found = 3,      ///< answered, and something was found, where --exit-code or --min-clearance asks
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

/// The range of a number.
struct NumberRange {
  double low = 0, high = 0;
  std::string text;  ///< after "must be ": "a finite number >= 0"
};
inline const NumberRange not_negative{0, std::numeric_limits<double>::max(), "a finite number >= 0"};
inline const NumberRange not_negative_or_infinite{0, std::numeric_limits<double>::infinity(), "a number >= 0"};

/// Errors   CLI::ValidationError naming the option and the range.
double read_number(const std::string& text, const std::string& name, const NumberRange& range);

/// A length, or another number. The target is a number, which is the default, or an optional one without a default.
template <typename Number>
CLI::Option* add_number(CLI::App& command, const std::string& name, Number& target, const NumberRange& range,
                        const std::string& description) {
  const auto read = [&target, range, name](const std::string& text) { target = read_number(text, name, range); };
  CLI::Option* const option = command.add_option_function<std::string>(name, read, description)->type_name("LENGTH");
  if constexpr (std::is_same_v<Number, double>) option->default_str(fmt::format("{}", target));
  return option;
}

/// The whole numbers that an option takes, ends included.
struct CountRange {
  std::uint64_t low = 0, high = std::numeric_limits<std::uint64_t>::max();
};
std::uint64_t read_count(const std::string& text, const std::string& name, const CountRange& range);
template <typename Count>
CLI::Option* add_count(CLI::App& command, const std::string& name, Count& target, const CountRange& range,
                       const std::string& description) {
  const auto read = [&target, range, name](const std::string& text) { target = read_count(text, name, range); };
  CLI::Option* const option = command.add_option_function<std::string>(name, read, description)->type_name("COUNT");
  if constexpr (std::is_same_v<Count, std::uint64_t>) option->default_str(fmt::format("{}", target));
  return option;
}

/// A file of a kind, such as "CSV".
CLI::Option* add_file(CLI::App& command, const std::string& name, std::string& target, const std::string& kind,
                      const std::string& description);

/// `--out`, of a verb whose answer is a table; "-" is standard output.
void add_out(CLI::App& command, std::string& target, const std::string& where = {});

/// `--exit-code`, with what it tells: "the models collide".
void add_exit_code(CLI::App& command, bool& target, const std::string& told);

/// `--relative-error`.
void add_relative_error(CLI::App& command, double& target);

/// `--min-clearance`, with what it means.
void add_min_clearance(CLI::App& command, std::optional<double>& target, const std::string& description);

/// `--relative-error`, `--absolute-error`, `--max-distance`.
void add_distance_options(CLI::App& command, DistanceOptions& target);

/// `--motion-margin`.
void add_motion_margin(CLI::App& command, ModelOptions& target);
std::string words_of(const ModelOptions& options);

}  // namespace limber::program
