// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/haptic_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "command/output.h"
#include "command/text.h"

namespace limber::program {
namespace {

double us(std::uint32_t ns) { return rounded_us(1e-3 * ns); }

const std::vector<TickSample>& main_ticks(const HapticRun& run) {
  return run.options.is_empty ? run.empty_ticks : run.ticks;
}

std::string granted_text(const HapticRun& run) {
  const auto text = [](const Granted& granted, const std::string& what) {
    return granted ? what : fmt::format("no {} ({})", what, granted.refusal);
  };
  return fmt::format("core {}, {}, {}, sleeps until {:g} us before a tick", run.options.core,
                     text(run.priority, fmt::format("SCHED_FIFO {}", fifo_priority)),
                     text(run.locked_memory, "locked memory"), run.options.spin_us);
}

std::string part_text(std::uint64_t part, std::size_t all) {
  if (part == 0) return "none";
  return fmt::format("{} of {}", grouped(part), grouped(all));
}

std::string answers_text(const HapticRun& run, const HapticSummary& summary) {
  const auto count = [&](DistanceStatus status) { return grouped(summary.answers.at(status)); };
  return fmt::format("{} exact, {} within {:g} %, {} collisions, {} beyond reach, {} interrupted",
                     count(DistanceStatus::exact), count(DistanceStatus::within_error),
                     100 * run.options.scene.relative_error, count(DistanceStatus::collision),
                     count(DistanceStatus::beyond_limit), count(DistanceStatus::interrupted));
}

std::string width_text(const Percentiles& width) {
  const auto percent = [](const std::optional<double>& part) {
    return part ? fmt::format("{:.3g} %", 100 * *part) : std::string("-");
  };
  return fmt::format("median {}, p99 {}, max {} of upper", percent(width.at[0]), percent(width.at[2]),
                     percent(width.max));
}

Json json_of(const std::optional<Percentiles>& percentiles) {
  if (!percentiles) return nullptr;
  Json json = Json::object();
  for (std::size_t i = 0; i < percentile_levels.size(); ++i) {
    if (percentiles->at[i]) json[percentile_levels[i].name] = *percentiles->at[i];
  }
  json["max"] = percentiles->max;
  return json;
}

Json json_of(const Granted& granted) { return granted ? Json("granted") : Json(granted.refusal); }

}  // namespace

Json json_of(const LogHistogram& histogram) {
  Json json = Json::array();
  for (std::size_t i = 0; i < histogram.counts().size(); ++i) {
    if (histogram.counts()[i] == 0) continue;
    json.push_back(
        {{"from_us", histogram.edge(i)}, {"to_us", histogram.edge(i + 1)}, {"ticks", histogram.counts()[i]}});
  }
  return json;
}

std::vector<double> times_of(const std::vector<TickSample>& ticks, const TickPart& part) {
  std::vector<double> times;
  times.reserve(ticks.size());
  for (const TickSample& tick : ticks) times.push_back(us(tick.*part.ns));
  return times;
}

std::vector<double> wake_up_times(const std::vector<TickSample>& ticks) {
  std::vector<double> times;
  times.reserve(ticks.size());
  for (const TickSample& tick : ticks) {
    if (tick.has_waited) times.push_back(us(tick.late));
  }
  return times;
}

HapticSummary summary_of(const HapticRun& run) {
  HapticSummary summary;
  std::vector<double> widths;
  for (const auto& [status, word] : status_words) summary.answers[status] = 0;
  for (const TickSample& tick : main_ticks(run)) {
    summary.missed += tick.is_missed ? 1 : 0;
    summary.late_starts += tick.has_waited ? 0 : 1;
  }
  for (const TickSample& tick : run.ticks) {
    ++summary.answers[tick.status];
    if (tick.status == DistanceStatus::interrupted) widths.push_back(static_cast<double>(1 - tick.lower / tick.upper));
    summary.largest_force_n = std::max(summary.largest_force_n, static_cast<double>(tick.force_n));
    summary.moved_vertices += tick.moved_vertices;
  }
  for (std::size_t i = 0; i < tick_parts.size(); ++i) {
    summary.parts[i] = percentiles_of(times_of(run.ticks, tick_parts[i]));
  }
  summary.wake_up = percentiles_of(wake_up_times(run.ticks));
  summary.empty_wake_up = percentiles_of(wake_up_times(run.empty_ticks));
  summary.interrupted_width = percentiles_of(std::move(widths));
  return summary;
}

std::vector<std::pair<std::string, std::optional<Percentiles>>> time_rows(const HapticSummary& summary) {
  std::vector<std::pair<std::string, std::optional<Percentiles>>> rows;
  for (std::size_t i = 0; i < tick_parts.size(); ++i) {
    if (summary.parts[i]) rows.emplace_back(tick_parts[i].name, summary.parts[i]);
  }
  if (summary.wake_up) rows.emplace_back("late wake-up", summary.wake_up);
  if (summary.empty_wake_up) rows.emplace_back("late wake-up, empty loop", summary.empty_wake_up);
  return rows;
}

std::vector<std::pair<std::string, std::string>> summary_rows(const HapticRun& run, const HapticSummary& summary) {
  const LoopOptions& options = run.options;
  const std::size_t count = main_ticks(run).size();
  std::vector<std::pair<std::string, std::string>> rows = {
      {"ticks", fmt::format("{} at {:g} Hz, a period of {:.6g} us", grouped(count), options.scene.rate_hz,
                            1e6 / options.scene.rate_hz)},
      {"loop", granted_text(run)},
      {"missed ticks", part_text(summary.missed, count)},
      {"late starts", part_text(summary.late_starts, count)},
  };
  if (!options.is_empty) {
    rows.insert(rows.end(),
                {{"models", fmt::format("tissue of {} triangles, tool of {}", grouped(run.tissue_triangles),
                                        grouped(run.tool_triangles))},
                 {"vertices moved", fmt::format("{}, {} in a tick on average", grouped(summary.moved_vertices),
                                                grouped(summary.moved_vertices / count))},
                 {"answers", answers_text(run, summary)},
                 {"interrupted interval", summary.interrupted_width ? width_text(*summary.interrupted_width) : "none"},
                 {"largest force", fmt::format("{:.3g} N", summary.largest_force_n)},
                 {"tree", fmt::format("{} triangles rebuilt; at the end {:.3f} times the node tests of a new tree",
                                      grouped(run.rebuilt_triangles), run.node_tests_over_new_tree)}});
  }
#ifdef LIMBER_CHECKS
  rows.emplace_back("build", "with checks on, so times are much longer than in a release build");
#endif
  return rows;
}

std::string summary_text(const HapticRun& run, const HapticSummary& summary) {
  std::string text = fmt::format("{:<26}", "us");
  for (const PercentileLevel& level : percentile_levels) text += fmt::format("{:>9}", level.name);
  text += fmt::format("{:>9}\n", "max");
  for (const auto& [name, percentiles] : time_rows(summary)) {
    text += fmt::format("{:<26}", name);
    for (const std::optional<double>& at : percentiles->at) {
      text += at ? fmt::format("{:>9.1f}", *at) : fmt::format("{:>9}", "-");
    }
    text += fmt::format("{:>9.1f}\n", percentiles->max);
  }
  text += '\n';
  for (const auto& [name, words] : summary_rows(run, summary)) text += fmt::format("{:<26}{}\n", name, words);
  return text;
}

Json to_json(const HapticRun& run, const HapticSummary& summary) {
  const LoopOptions& options = run.options;
  Json json = {{"query", "haptics"},
               {"rate_hz", options.scene.rate_hz},
               {"ticks", main_ticks(run).size()},
               {"core", options.core},
               {"fifo_priority", json_of(run.priority)},
               {"locked_memory", json_of(run.locked_memory)},
               {"spin_us", options.spin_us},
               {"missed", summary.missed},
               {"late_starts", summary.late_starts},
               {"wake_up_us", json_of(summary.wake_up)},
               {"empty_wake_up_us", json_of(summary.empty_wake_up)}};
  if (options.is_empty) return json;
  json["tissue_triangles"] = run.tissue_triangles;
  json["tool_triangles"] = run.tool_triangles;
  json["relative_error"] = options.scene.relative_error;
  json["tick_budget_us"] = 1e-3 * static_cast<double>(options.scene.tick_budget.count());
  for (std::size_t i = 0; i < tick_parts.size(); ++i) json[tick_parts[i].key] = json_of(summary.parts[i]);
  json["work_histogram"] = json_of(LogHistogram(times_of(run.ticks, tick_parts[0])));
  for (const auto& [status, word] : status_words) json["answers"][word] = summary.answers.at(status);
  json["interrupted_width"] = json_of(summary.interrupted_width);
  json["largest_force_n"] = summary.largest_force_n;
  json["moved_vertices"] = summary.moved_vertices;
  json["rebuilt_triangles"] = run.rebuilt_triangles;
  json["node_tests_over_new_tree"] = run.node_tests_over_new_tree;
  return json;
}

std::string ticks_csv(const HapticRun& run) {
  fmt::memory_buffer csv;
  const auto out = std::back_inserter(csv);
  fmt::format_to(out, "tick,late_us,waited");
  for (const TickPart& part : tick_parts) fmt::format_to(out, ",{}", part.key);
  fmt::format_to(out, ",missed,moved_vertices,status,lower,upper,force_n\n");
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    const TickSample& tick = run.ticks[i];
    fmt::format_to(out, "{},{},{}", i, us(tick.late), tick.has_waited);
    for (const TickPart& part : tick_parts) fmt::format_to(out, ",{}", us(tick.*part.ns));
    fmt::format_to(out, ",{},{},{},{},{},{}\n", tick.is_missed, tick.moved_vertices, to_text(tick.status), tick.lower,
                   std::isfinite(tick.upper) ? fmt::format("{}", tick.upper) : "", tick.force_n);
  }
  return fmt::to_string(csv);
}

}  // namespace limber::program
