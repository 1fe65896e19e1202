// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "limber/distance.h"

/// Options whose errors are all reported in the same form. Targets hold the defaults and outlive the parsing.
namespace limber::program {

/// The range of a number.
struct NumberRange {
  double low = 0, high = 0;
  std::string text;  ///< after "must be ": "a finite number >= 0"
};
CLI::Option* add_number(CLI::App& command, const std::string& name, double& target, const NumberRange& range,
                        const std::string& description);

/// The same, without a default.
CLI::Option* add_optional_number(CLI::App& command, const std::string& name, std::optional<double>& target,
                                 const NumberRange& range, const std::string& description);

/// A whole number from `low` to `high`.
CLI::Option* add_count(CLI::App& command, const std::string& name, std::uint64_t& target, std::uint64_t low,
                       std::uint64_t high, const std::string& description);

/// The same, without a default.
CLI::Option* add_optional_count(CLI::App& command, const std::string& name, std::optional<std::uint64_t>& target,
                                std::uint64_t low, std::uint64_t high, const std::string& description);

/// One of several words.
template <typename T>
CLI::Option* add_choice(CLI::App& command, const std::string& name, T& target,
                        const std::vector<std::pair<std::string, T>>& choices, const std::string& description) {
  std::string words, default_word;
  for (const auto& [word, value] : choices) {
    words += (words.empty() ? "" : "|") + word;
    if (value == target) default_word = word;
  }
  const auto read = [&target, choices, words, name](const std::string& text) {
    for (const auto& [word, value] : choices) {
      if (text != word) continue;
      target = value;
      return;
    }
    throw CLI::ValidationError(name, "must be one of " + words + ", not '" + text + "'");
  };
  return command.add_option_function<std::string>(name, read, description)->type_name(words)->default_str(default_word);
}

/// `--json`.
CLI::Option* add_json(CLI::App& command, bool& target, const std::string& description);

/// `--exit-code`, with what it tells: "the models collide".
CLI::Option* add_exit_code(CLI::App& command, bool& target, const std::string& told);

/// `--relative-error`.
CLI::Option* add_relative_error(CLI::App& command, double& target);

/// `--relative-error`, `--absolute-error`, `--max-distance`.
void add_distance_options(CLI::App& command, DistanceOptions& target);

}  // namespace limber::program
