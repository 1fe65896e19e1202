// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/options.h"
#include "limber/distance.h"

#include <fmt/format.h>

#include <limits>

#include "command/text.h"
#include "command/verb.h"

namespace limber::program {
namespace {

constexpr double largest = std::numeric_limits<double>::max();

double read_number(const std::string& text, const std::string& name, const NumberRange& range) {
  const std::optional<double> number = parsed_number(text);
  if (!number || !(*number >= range.low && *number <= range.high)) {
    throw CLI::ValidationError(name, fmt::format("must be {}, not '{}'", range.text, text));
  }
  return *number;
}

std::uint64_t read_count(const std::string& text, const std::string& name, std::uint64_t low, std::uint64_t high) {
  const std::optional<std::uint64_t> count = parsed_count(text);
  if (!count || *count < low || *count > high) {
    throw CLI::ValidationError(name, fmt::format("must be a whole number from {} to {}, not '{}'", low, high, text));
  }
  return *count;
}

}  // namespace

CLI::Option* add_number(CLI::App& command, const std::string& name, double& target, const NumberRange& range,
                        const std::string& description) {
  const auto read = [&target, range, name](const std::string& text) { target = read_number(text, name, range); };
  return command.add_option_function<std::string>(name, read, description)
      ->type_name("NUMBER")
      ->default_str(fmt::format("{}", target));
}

CLI::Option* add_optional_number(CLI::App& command, const std::string& name, std::optional<double>& target,
                                 const NumberRange& range, const std::string& description) {
  const auto read = [&target, range, name](const std::string& text) { target = read_number(text, name, range); };
  return command.add_option_function<std::string>(name, read, description)->type_name("NUMBER");
}

CLI::Option* add_count(CLI::App& command, const std::string& name, std::uint64_t& target, std::uint64_t low,
                       std::uint64_t high, const std::string& description) {
  const auto read = [&target, low, high, name](const std::string& text) { target = read_count(text, name, low, high); };
  return command.add_option_function<std::string>(name, read, description)
      ->type_name("COUNT")
      ->default_str(fmt::format("{}", target));
}

CLI::Option* add_optional_count(CLI::App& command, const std::string& name, std::optional<std::uint64_t>& target,
                                std::uint64_t low, std::uint64_t high, const std::string& description) {
  const auto read = [&target, low, high, name](const std::string& text) { target = read_count(text, name, low, high); };
  return command.add_option_function<std::string>(name, read, description)->type_name("COUNT");
}

CLI::Option* add_json(CLI::App& command, bool& target, const std::string& description) {
  return command.add_flag("--json", target, description);
}

CLI::Option* add_exit_code(CLI::App& command, bool& target, const std::string& told) {
  return command.add_flag("--exit-code", target,
                          fmt::format("exit with {} instead of 0 when {}", static_cast<int>(ExitCode::found), told));
}

CLI::Option* add_relative_error(CLI::App& command, double& target) {
  return add_number(command, "--relative-error", target, {0, largest, "a finite number >= 0"},
                    "the answer may exceed the true distance by this fraction of it; 0 is exact");
}

void add_distance_options(CLI::App& command, DistanceOptions& target) {
  add_relative_error(command, target.relative_error);
  add_number(command, "--absolute-error", target.absolute_error, {0, largest, "a finite number >= 0"},
             "the answer may exceed the true distance by this length; either error will do")
      ->type_name("LENGTH");
  add_number(command, "--max-distance", target.max_distance,
             {0, std::numeric_limits<double>::infinity(), "a number >= 0"},
             "stop with beyond_limit when the models are farther apart than this length")
      ->type_name("LENGTH");
}

}  // namespace limber::program
