// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command/text.h"
#include "haptics/haptic_report.h"
#include "reports/page_template.h"

namespace limber::program {
namespace {

constexpr const TickPart& whole_tick = tick_parts[0];
constexpr const TickPart& query = tick_parts[3];

std::string introduction(const HapticRun& run) {
  return fmt::format(
      "A tool of {} triangles comes down on tissue of {}, presses and is drawn along. Every tick moves the tool, dents "
      "the tissue and lets it come back, repairs its tree, asks for the distance within {:g} %, and answers with a "
      "force, in {} us.",
      grouped(run.tool_triangles), grouped(run.tissue_triangles), 100 * run.options.scene.relative_error,
      static_cast<double>(run.options.scene.tick_budget.count()) / 1000);
}

using Tiles = std::vector<std::pair<std::string, std::string>>;

/// Numbers that stand out, and what they are.
Tiles tiles(const HapticRun& run, const HapticSummary& summary) {
  const auto text = [](const std::optional<double>& us) { return us ? duration_text(*us) : std::string("-"); };
  const Percentiles& work = *summary.parts[0];
  return {{text(work.at[0]), "median work of a tick"},
          {text(work.at[3]), "99.9th percentile"},
          {duration_text(work.max), "slowest tick"},
          {grouped(summary.missed), fmt::format("missed of {} ticks", grouped(run.ticks.size()))}};
}

Json histogram(const char* name, const std::vector<double>& times) {
  return {{"name", name}, {"bins", json_of(LogHistogram(times))}};
}

/// The largest of every `group` consecutive values.
std::vector<double> largest_of_each(std::size_t group, const std::vector<double>& values) {
  std::vector<double> largest;
  for (auto begin = values.begin(); begin != values.end();) {
    const auto end = begin + std::min(static_cast<std::ptrdiff_t>(group), values.end() - begin);
    largest.push_back(*std::max_element(begin, end));
    begin = end;
  }
  return largest;
}

/// Ticks in groups, as many as a screen has columns: how many each has, its slowest, and those with a missed one.
Json slowest(const HapticRun& run) {
  constexpr std::size_t most_groups = 1000;
  const std::size_t group = (run.ticks.size() + most_groups - 1) / most_groups;
  Json missed = Json::array();
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    if (run.ticks[i].is_missed && (missed.empty() || missed.back() != i / group)) missed.push_back(i / group);
  }
  return {{"group", group},
          {"work_us", largest_of_each(group, times_of(run.ticks, whole_tick))},
          {"query_us", largest_of_each(group, times_of(run.ticks, query))},
          {"missed", std::move(missed)}};
}

std::vector<Names> table_of_times(const HapticSummary& summary) {
  Names header = {""};
  for (const PercentileLevel& level : percentile_levels) header.push_back(level.name);
  header.push_back("max");
  std::vector<Names> rows = {std::move(header)};
  for (const auto& [name, percentiles] : time_rows(summary)) {
    Names row = {name};
    for (const std::optional<double>& at : percentiles->at) row.push_back(at ? fmt::format("{:.1f}", *at) : "-");
    row.push_back(fmt::format("{:.1f}", percentiles->max));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::string haptic_page(const HapticRun& run, const HapticSummary& summary, const std::string& command_line) {
  const Json data = {
      {"rate_hz", run.options.scene.rate_hz},
      {"introduction", introduction(run)},
      {"tiles", tiles(run, summary)},
      {"work",
       {histogram("whole tick", times_of(run.ticks, whole_tick)), histogram("query", times_of(run.ticks, query))}},
      {"wake_up",
       {histogram("this loop", wake_up_times(run.ticks)), histogram("empty loop", wake_up_times(run.empty_ticks))}},
      {"slowest", slowest(run)},
      {"times", table_of_times(summary)},
      {"summary", summary_rows(run, summary)}};
  return filled_page({{"haptics", data}}, command_line);
}

}  // namespace limber::program
