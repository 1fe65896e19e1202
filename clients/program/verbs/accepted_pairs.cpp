// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/accepted_pairs.h"

#include <array>
#include <string_view>
#include <utility>

#include "command/text.h"
#include "formats/csv.h"

namespace limber::program {
namespace {

constexpr std::array<std::string_view, 3> accept_columns = {"name_a", "name_b", "allowed"};

/// Whether a pattern with * and ? is that of a name. Each * takes as little as will do; none has to take more.
bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, after_star = std::string_view::npos, resumed = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      after_star = ++p, resumed = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (after_star != std::string_view::npos) {
      p = after_star, n = ++resumed;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

/// Whether the parts touch or may touch, and nothing worse is possible.
bool is_touching(const DistanceAnswer& answer) {
  const bool may_touch = answer.clash == Clash::cannot_tell && !answer.may_clash && answer.result.lower == 0;
  return answer.clash == Clash::touching || may_touch;
}

}  // namespace

AcceptedPairs::AcceptedPairs(std::string path) : path_(std::move(path)) {
  if (path_.empty()) return;
  const CsvFormat format{"pair", accept_columns, 2, true, "; the first row names the columns: name_a,name_b,allowed",
                         true};
  read_csv(path_, format, [&](const std::vector<std::string>& fields, std::size_t line) {
    const std::string& allowed = fields[2];
    if (allowed != "all" && allowed != "touching" && !allowed.empty()) {
      throw BadInput(fmt::format("column allowed: must be touching or all, not '{}'", shown(allowed)));
    }
    rules_.push_back({fields[0], fields[1], allowed == "all", false, line});
  });
}

std::optional<std::size_t> AcceptedPairs::accept(const std::string& name_a, const std::string& name_b,
                                                 const DistanceAnswer& answer) {
  if (answer.clash == Clash::clear || answer.clash == Clash::surfaces_apart) return std::nullopt;
  std::optional<std::size_t> first;
  for (Rule& rule : rules_) {
    if (!rule.allows_all && !is_touching(answer)) continue;
    const bool is_meant =
        (matches(rule.a, name_a) && matches(rule.b, name_b)) || (matches(rule.a, name_b) && matches(rule.b, name_a));
    if (!is_meant) continue;
    rule.is_used = true;
    if (!first) first = rule.line;
  }
  return first;
}

void AcceptedPairs::warn_about_unused() const {
  for (const Rule& rule : rules_) {
    if (!rule.is_used) warn("distance", fmt::format("{}: line {}: accepts no pair", path_, rule.line));
  }
}

}  // namespace limber::program
