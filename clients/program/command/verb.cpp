// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/verb.h"

#include <charconv>

#include "command/text.h"

namespace limber::program {
double read_number(const std::string& text, const std::string& name, const NumberRange& range) {
  const std::optional<double> number = parsed_number(text);
  if (!number || !(*number >= range.low && *number <= range.high)) {
    throw CLI::ValidationError(name, fmt::format("must be {}, not '{}'", range.text, text));
  }
  return *number;
}

std::uint64_t read_count(const std::string& text, const std::string& name, const CountRange& range) {
  std::uint64_t count = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc{} || stop != text.data() + text.size() || count < range.low || count > range.high) {
    throw CLI::ValidationError(
        name, fmt::format("must be a whole number from {} to {}, not '{}'", range.low, range.high, text));
  }
  return count;
}

CLI::Option* add_file(CLI::App& command, const std::string& name, std::string& target, const std::string& kind,
                      const std::string& description) {
  CLI::Option* const option = command.add_option(name, target, description)->type_name(kind);
  return target.empty() ? option : option->capture_default_str();
}

void add_out(CLI::App& command, std::string& target, const std::string& where) {
  add_file(command, "--out", target, "FILE", where + "where the answer is written, - for standard output");
}

void add_exit_code(CLI::App& command, bool& target, const std::string& told) {
  command.add_flag("--exit-code", target,
                   fmt::format("exit with {} instead of 0 when {}", static_cast<int>(ExitCode::found), told));
}

void add_relative_error(CLI::App& command, double& target) {
  add_number(command, "--relative-error", target, not_negative,
             "the answer may exceed the true distance by this fraction of it; 0 is exact")
      ->type_name("NUMBER");
}

void add_min_clearance(CLI::App& command, std::optional<double>& target, const std::string& description) {
  add_number(command, "--min-clearance", target,
             {std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max(), "a finite number > 0"},
             description);
}

void add_distance_options(CLI::App& command, DistanceOptions& target) {
  add_relative_error(command, target.relative_error);
  add_number(command, "--absolute-error", target.absolute_error, not_negative,
             "the answer may exceed the true distance by this length; either error will do");
  add_number(command, "--max-distance", target.max_distance, not_negative_or_infinite,
             "stop with beyond_limit when the models are farther apart than this length");
}

void add_motion_margin(CLI::App& command, ModelOptions& target) {
  add_number(command, "--motion-margin", target.motion_margin, not_negative,
             "how far a vertex may move before its bounds are refitted");
}

std::string words_of(const ModelOptions& options) { return fmt::format("motion margin {}", options.motion_margin); }

}  // namespace limber::program
