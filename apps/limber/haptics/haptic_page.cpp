// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/haptic_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "command/text.h"
#include "reports/chart_svg.h"
#include "reports/histogram_svg.h"
#include "reports/html_page.h"

namespace limber::program {
namespace {

constexpr std::size_t most_points = 1000;  // of a curve; as many as a screen has columns

// The table of percentiles; names stay on one line, numbers stand below each other.
constexpr const char* style_of_times =
    R"(.times { overflow-x: auto; }
.times th, .times td { width: auto; max-width: none; white-space: pre; text-align: right; padding: 7px 0 7px 14px; }
.times th:first-child { text-align: left; padding-left: 0; }
)";

constexpr const TickPart& whole_tick = tick_parts[0];
constexpr const TickPart& query = tick_parts[3];

double period_us(const HapticRun& run) { return 1e6 / run.options.scene.rate_hz; }

std::string drawn(const HistogramChart& chart) { return histogram_legend(chart) + histogram_svg(chart); }

std::string work_histogram(const HapticRun& run) {
  return drawn({"&micro;s",
                {{"whole tick", "first", LogHistogram(times_of(run.ticks, whole_tick))},
                 {"query", "second", LogHistogram(times_of(run.ticks, query))}},
                period_us(run),
                "period"});
}

/// Empty where no tick has been waited for.
std::string wake_up_histogram(const HapticRun& run) {
  HistogramChart chart{"&micro;s", {}, std::nullopt, {}};
  const auto add = [&chart](const char* label, const char* style, const std::vector<TickSample>& ticks) {
    LogHistogram histogram(wake_up_times(ticks));
    if (!histogram.counts().empty()) chart.curves.push_back({label, style, std::move(histogram)});
  };
  add("this loop", "first", run.ticks);
  add("empty loop", "second", run.empty_ticks);
  return chart.curves.empty() ? std::string() : drawn(chart);
}

/// The largest value of every `group` that follow each other.
std::vector<double> largest_of_each(std::size_t group, const std::vector<double>& values) {
  std::vector<double> largest;
  for (std::size_t i = 0; i < values.size(); i += group) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(i);
    const auto count = static_cast<std::ptrdiff_t>(std::min(group, values.size() - i));
    largest.push_back(*std::max_element(begin, begin + count));
  }
  return largest;
}

std::string time_line(const HapticRun& run) {
  const std::size_t group = (run.ticks.size() + most_points - 1) / most_points;
  Chart chart;
  chart.unit = "&micro;s";
  chart.point_name = "s";
  chart.point_unit = static_cast<double>(group) / run.options.scene.rate_hz;
  chart.curves = {{"whole tick", "first", largest_of_each(group, times_of(run.ticks, whole_tick))},
                  {"query", "second", largest_of_each(group, times_of(run.ticks, query))}};
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    const bool is_new = chart.marked_points.empty() || chart.marked_points.back() != i / group;
    if (run.ticks[i].is_missed && is_new) chart.marked_points.push_back(i / group);
  }
  chart.mark_label = "missed";
  return chart_legend(chart) + chart_svg(chart, chart.curves.front().values.size());
}

std::string table_of_times(const HapticSummary& summary) {
  std::string html = "<div class=\"times\"><table>\n<tr><th>&micro;s</th>";
  for (const PercentileLevel& level : percentile_levels) html += fmt::format("<th>{}</th>", level.name);
  html += "<th>max</th></tr>\n";
  for (const auto& [name, percentiles] : time_rows(summary)) {
    html += fmt::format("<tr><th scope=\"row\">{}</th>", name);
    for (const std::optional<double>& at : percentiles->at) {
      html += at ? fmt::format("<td>{:.1f}</td>", *at) : "<td>-</td>";
    }
    html += fmt::format("<td>{:.1f}</td></tr>\n", percentiles->max);
  }
  return html + "</table></div>\n";
}

std::string introduction(const HapticRun& run) {
  return fmt::format(
      "<h1>A haptic loop at {:g} Hz</h1>\n"
      "<p>A tool of {} triangles comes down on tissue of {}, presses and is drawn along. Every tick moves the tool, "
      "dents the tissue and lets it come back, repairs its tree, asks for the distance within {}, and answers with a "
      "force, in {}&nbsp;&micro;s.</p>\n",
      run.options.scene.rate_hz, in_html(grouped(run.tool_triangles)), in_html(grouped(run.tissue_triangles)),
      fmt::format("{:g}&nbsp;%", 100 * run.options.scene.relative_error),
      static_cast<double>(run.options.scene.tick_budget.count()) / 1000);
}

std::string tiles(const HapticRun& run, const HapticSummary& summary) {
  const auto text = [](const std::optional<double>& us) { return us ? duration_text(*us) : std::string("-"); };
  const Percentiles& work = *summary.parts[0];
  return "<div class=\"tiles\">\n" + page_tile(text(work.at[0]), "median work of a tick") +
         page_tile(text(work.at[3]), "99.9th percentile") + page_tile(duration_text(work.max), "slowest tick") +
         page_tile(grouped(summary.missed), fmt::format("missed of {} ticks", in_html(grouped(run.ticks.size())))) +
         "</div>\n";
}

}  // namespace

std::string haptic_page(const HapticRun& run, const HapticSummary& summary) {
  std::string html = page_head("limber haptics", style_of_times) + introduction(run) + tiles(run, summary);
  html += page_section("work", "Work of a tick",
                       "How many ticks took how long. What lies to the right of the line takes longer than a period.",
                       work_histogram(run));
  html += page_section("wake_up", "Late wake-ups",
                       "How long after their time ticks have started, in this loop and in one that does nothing: what "
                       "both have in common comes from the machine.",
                       wake_up_histogram(run));
  html += page_section("time_line", "The slowest ticks",
                       "Over the time of the run: of ticks that lie side by side in this picture, the slowest.",
                       time_line(run));
  html += page_section("times", "Times", "Percentiles above which there is no value are left out.",
                       table_of_times(summary));
  html += page_section("summary", "Summary", "Lengths are in mm.", page_rows(summary_rows(run, summary)));
  return html + page_end();
}

}  // namespace limber::program
