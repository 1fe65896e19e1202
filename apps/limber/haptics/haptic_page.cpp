// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "command/text.h"
#include "haptics/haptic_report.h"
#include "haptics/svg_chart.h"

namespace limber::program {
namespace {

constexpr const TickPart& whole_tick = tick_parts[0];
constexpr const TickPart& query = tick_parts[3];

/// The head of the page. It has no scripts, takes nothing from elsewhere, and is light or dark as the reader's screen
/// is.
constexpr const char* page_start = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>limber haptics</title>
<style>
:root {
  --page: #f6f5f2; --card: #ffffff; --ink: #23282d; --soft: #68707a; --rule: #dfe1e2; --axis: #9aa1a8;
  --first: #1f5f9e; --second: #c4622d; --mark: #c0273f; --halo: #ffffffc0;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #14171a; --card: #1d2125; --ink: #e4e7ea; --soft: #9aa3ac; --rule: #32383e; --axis: #6a727a;
    --first: #6cb0f0; --second: #ee9a62; --mark: #ff6b80; --halo: #000000a0;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0; padding: 40px 20px 60px; background: var(--page); color: var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif;
}
main { max-width: 1000px; margin: 0 auto; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 10px; letter-spacing: -0.01em; }
h2 { font-size: 17px; margin: 0 0 2px; }
p { margin: 0; max-width: 74ch; }
.soft { color: var(--soft); font-size: 14px; max-width: none; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 12px; margin: 26px 0 0; }
.tiles div, section { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; }
.tiles div { padding: 14px 18px; }
.tiles b { display: block; font-size: 24px; line-height: 1.3; font-weight: 600; font-variant-numeric: tabular-nums; }
section { margin-top: 20px; padding: 18px 20px 14px; }
section > svg { display: block; width: 100%; height: auto; margin-top: 10px; }
section > .chart { width: calc(100% - 68px); height: 230px; margin: 14px 10px 4px 58px; overflow: visible; }
.chart text, .legend { font-size: 13px; fill: var(--soft); color: var(--soft); }
.chart text { font-variant-numeric: tabular-nums; }
.chart .value, .chart .name { text-anchor: end; }
.chart .frame { text-anchor: middle; }
.legend { display: flex; flex-wrap: wrap; gap: 2px 18px; margin-top: 10px; max-width: none; }
.legend .unit { flex-grow: 1; }
.symbol { margin-right: 6px; }
.chart *, .symbol * { vector-effect: non-scaling-stroke; }
.grid { stroke: var(--rule); }
.axis { stroke: var(--axis); }
.line { fill: none; stroke-width: 1.6; stroke-linejoin: round; }
.first { stroke: var(--first); }
.second { stroke: var(--second); }
.mark { stroke: var(--mark); stroke-width: 1.6; fill: none; }
table { border-collapse: collapse; width: 100%; margin-top: 8px; font-variant-numeric: tabular-nums; font-size: 15px; }
th, td { text-align: left; padding: 7px 0; border-top: 1px solid var(--rule); vertical-align: top; }
tr:first-child > * { border-top: 0; }
th { font-weight: 400; color: var(--soft); width: 34%; max-width: 15em; padding-right: 12px; }
/* The table of percentiles: names stay on one line, numbers stand below each other. */
.times { overflow-x: auto; }
.times th, .times td { width: auto; max-width: none; white-space: pre; text-align: right; padding: 7px 0 7px 14px; }
.times th:first-child { text-align: left; padding-left: 0; }
@media (max-width: 640px) {
  body { padding: 24px 12px 40px; }
  h1 { font-size: 26px; }
  section { padding: 14px 14px 12px; }
  .tiles div { padding: 10px 14px; }
}
</style>
</head>
<body>
<main>
)";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "&micro;s" instead of the "us" of plain text; numbers and their units do not break.
std::string in_html(const std::string& text) {
  std::string html;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_after_digit = i > 0 && is_digit(text[i - 1]);
    if (is_after_digit && text.compare(i, 3, " us") == 0) {
      html += "&nbsp;&micro;s";
      i += 2;
    } else if (is_after_digit && text[i] == ' ' && i + 1 < text.size() && is_digit(text[i + 1])) {
      html += "&nbsp;";
    } else {
      html += text[i];
    }
  }
  return html;
}

std::string page_section(const std::string& id, const std::string& title, const std::string& caption,
                         const std::string& content) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n<p class=\"soft\">{}</p>\n{}</section>\n", id, title, caption,
                     content);
}

/// A number that stands out, and what it is.
std::string page_tile(const std::string& number, const std::string& name) {
  return fmt::format("<div><b>{}</b><span class=\"soft\">{}</span></div>\n", in_html(number), name);
}

/// A table of names and texts.
std::string page_rows(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string html = "<table>\n";
  for (const auto& [name, text] : rows) {
    html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", name, in_html(text));
  }
  return html + "</table>\n";
}

/// How many values lie in each bin, as the outline of bars.
Curve outline(const std::string& label, const std::string& style, const LogHistogram& histogram) {
  Curve curve{label, style, {{histogram.edge(0), 0}}};
  const std::size_t count = histogram.counts().size();
  for (std::size_t i = 0; i < count; ++i) {
    const auto ticks = static_cast<double>(histogram.counts()[i]);
    curve.points.insert(curve.points.end(), {{histogram.edge(i), ticks}, {histogram.edge(i + 1), ticks}});
  }
  curve.points.emplace_back(histogram.edge(count), 0);
  return curve;
}

/// Both axes are logarithmic. Empty where there is no curve.
std::string histogram_of(std::vector<Curve> curves, const std::optional<double>& marked_us) {
  if (curves.empty()) return {};
  double low = marked_us.value_or(curves.front().points.front().first), high = low, most = 1;
  for (const Curve& curve : curves) {
    low = std::min(low, curve.points.front().first);
    high = std::max(high, curve.points.back().first);
    for (const auto& [us, ticks] : curve.points) most = std::max(most, ticks);
  }
  Chart chart{"ticks", "&micro;s", logarithmic_axis(low, high), logarithmic_axis(1, most), std::move(curves), {}};
  chart.y.low = 0.5;  // so that a bin with one value can be seen
  if (marked_us) chart.marks = {*marked_us};
  chart.mark_height = plot_height;
  chart.mark_label = "period";
  return svg_of(chart);
}

std::string work_histogram(const HapticRun& run) {
  return histogram_of({outline("whole tick", "first", LogHistogram(times_of(run.ticks, whole_tick))),
                       outline("query", "second", LogHistogram(times_of(run.ticks, query)))},
                      1e6 / run.options.scene.rate_hz);
}

/// Without a loop of which no tick has been waited for.
std::string wake_up_histogram(const HapticRun& run) {
  std::vector<Curve> curves;
  const auto add = [&curves](const char* label, const char* style, const std::vector<TickSample>& ticks) {
    const LogHistogram histogram(wake_up_times(ticks));
    if (!histogram.counts().empty()) curves.push_back(outline(label, style, histogram));
  };
  add("this loop", "first", run.ticks);
  add("empty loop", "second", run.empty_ticks);
  return histogram_of(std::move(curves), std::nullopt);
}

/// The largest of every `group` consecutive values, as a curve; a group is `unit` wide along x.
Curve largest_of_each(std::size_t group, double unit, const std::string& label, const std::string& style,
                      const std::vector<double>& values) {
  Curve curve{label, style, {}};
  for (std::size_t i = 0; i < values.size(); i += group) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(i);
    const auto count = static_cast<std::ptrdiff_t>(std::min(group, values.size() - i));
    const std::size_t point = i / group;
    curve.points.emplace_back(unit * static_cast<double>(point), *std::max_element(begin, begin + count));
  }
  return curve;
}

std::string time_line(const HapticRun& run) {
  constexpr std::size_t most_points = 1000;  // of a curve; as many as a screen has columns
  const std::size_t group = (run.ticks.size() + most_points - 1) / most_points;
  const double unit = static_cast<double>(group) / run.options.scene.rate_hz;
  Chart chart{"&micro;s", "s", {}, {}, {}, {}};
  chart.curves = {largest_of_each(group, unit, "whole tick", "first", times_of(run.ticks, whole_tick)),
                  largest_of_each(group, unit, "query", "second", times_of(run.ticks, query))};
  constexpr double least_us = 0.01;
  double low = chart.curves.front().points.front().second, high = least_us;
  for (const Curve& curve : chart.curves) {
    for (const auto& [s, us] : curve.points) low = std::min(low, us), high = std::max(high, us);
  }
  chart.x = linear_axis(std::max(unit, chart.curves.front().points.back().first), unit);
  chart.y = logarithmic_axis(std::max(low, least_us), high);
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    const std::size_t point = i / group;
    const double s = unit * static_cast<double>(point);
    if (run.ticks[i].is_missed && (chart.marks.empty() || chart.marks.back() != s)) chart.marks.push_back(s);
  }
  chart.mark_label = "missed";
  return svg_of(chart);
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
  std::string html = page_start + introduction(run) + tiles(run, summary);
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
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace limber::program
