// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "options.h"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>

#include "number_text.h"

namespace limber::program {
namespace {

const std::vector<std::pair<std::string, classic::Maintenance>> maintenance_words = {
    {"immediate", classic::Maintenance::immediate},
    {"batched", classic::Maintenance::batched},
    {"by-depth", classic::Maintenance::by_depth},
};

/// Slack multiplies from level to level; at most this much of it keeps every radius and its square finite in a tree of
/// 32 levels.
constexpr double max_slack = 100;
constexpr double max_stale_ratio = 1e6;

}  // namespace

CLI::Option* add_number(CLI::App& command, const std::string& name, double& target, const NumberRange& range,
                        const std::string& description) {
  const auto read = [&target, range, name](const std::string& text) {
    const std::optional<double> number = parsed_number(text);
    if (!number || !(*number >= range.low && *number <= range.high)) {
      throw CLI::ValidationError(name, fmt::format("must be {}, not '{}'", range.text, text));
    }
    target = *number;
  };
  return command.add_option_function<std::string>(name, read, description)
      ->type_name("NUMBER")
      ->default_str(fmt::format("{}", target));
}

CLI::Option* add_count(CLI::App& command, const std::string& name, std::uint64_t& target, std::uint64_t low,
                       std::uint64_t high, const std::string& description) {
  const auto read = [&target, low, high, name](const std::string& text) {
    const std::optional<std::uint64_t> count = parsed_count(text);
    if (!count || *count < low || *count > high) {
      throw CLI::ValidationError(name, fmt::format("must be a whole number from {} to {}, not '{}'", low, high, text));
    }
    target = *count;
  };
  return command.add_option_function<std::string>(name, read, description)
      ->type_name("COUNT")
      ->default_str(fmt::format("{}", target));
}

CLI::Option* add_json(CLI::App& command, bool& target, const std::string& description) {
  return command.add_flag("--json", target, description);
}

CLI::Option* add_relative_error(CLI::App& command, double& target) {
  constexpr double largest = std::numeric_limits<double>::max();
  return add_number(command, "--relative-error", target, {0, largest, "a finite number >= 0"},
                    "the answer may exceed the true distance by this fraction of it; 0 is exact");
}

void add_maintenance(CLI::App& command, classic::ModelOptions& target) {
  add_choice(command, "--mode", target.maintenance, maintenance_words,
             "when spheres above moved triangles are recomputed: at once, per triangle at the end of the update, or "
             "deepest first at the end");
  add_number(command, "--slack", target.looseness.slack, {0, max_slack, "a number from 0 to 100"},
             "extra radius of recomputed spheres, as a fraction of the radius, to absorb later motion");
  add_number(command, "--stale-ratio", target.looseness.stale_ratio, {1, max_stale_ratio, "a number from 1 to 1e6"},
             "a loose sphere is recomputed once its radius is this many times that of a new one");
}

const char* to_text(classic::Maintenance maintenance) {
  for (const auto& [word, value] : maintenance_words) {
    if (value == maintenance) return word.c_str();
  }
  throw std::logic_error("a maintenance mode has no word");
}

}  // namespace limber::program
