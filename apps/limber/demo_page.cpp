// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "demo_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "chart_svg.h"
#include "demo_table.h"
#include "landscape_svg.h"

namespace limber::program {
namespace {

constexpr const char* head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>limber demo</title>
<style>
:root {
  --page: #f6f5f2; --card: #ffffff; --ink: #23282d; --soft: #68707a; --rule: #dfe1e2; --axis: #9aa1a8;
  --first: #1f5f9e; --second: #c4622d; --area: #c4622d33; --mark: #c0273f; --halo: #ffffffc0;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #14171a; --card: #1d2125; --ink: #e4e7ea; --soft: #9aa3ac; --rule: #32383e; --axis: #6a727a;
    --first: #6cb0f0; --second: #ee9a62; --area: #ee9a6233; --mark: #ff6b80; --halo: #000000a0;
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
.chart *, .symbol *, .trail, .witness, .outline, .ball, .dots { vector-effect: non-scaling-stroke; }
.grid { stroke: var(--rule); }
.axis { stroke: var(--axis); }
.line { fill: none; stroke-width: 1.6; stroke-linejoin: round; }
.first { stroke: var(--first); }
.second { stroke: var(--second); }
.area { fill: var(--area); }
.mark { stroke: var(--mark); stroke-width: 1.6; fill: none; }
.sheet path { stroke-width: 0.7; stroke-linejoin: round; }
.close path { stroke: #00000030; stroke-width: 0.6; stroke-linejoin: round; }
.trail { fill: none; stroke: #20262c; stroke-width: 1.5; stroke-linejoin: round; }
.trail.under { stroke: #ffffff; stroke-opacity: 0.55; stroke-width: 4; }
.dots { fill: none; stroke: #d4213d; stroke-width: 4; stroke-linecap: round; }
.dots.under { stroke: #ffffff; stroke-width: 5.5; }
.ends { stroke-width: 9; }
.ends.under { stroke-width: 13; }
.ball { stroke: #20262c; stroke-width: 1.5; }
.witness { fill: none; stroke: #d4213d; stroke-width: 3; }
.witness.under { stroke: #ffffff; stroke-width: 7; stroke-opacity: 0.8; }
.outline { fill: none; stroke: #d4213d; stroke-width: 1.6; stroke-linejoin: round; }
table { border-collapse: collapse; width: 100%; margin-top: 8px; font-variant-numeric: tabular-nums; font-size: 15px; }
th, td { text-align: left; padding: 7px 0; border-top: 1px solid var(--rule); vertical-align: top; }
tr:first-child > * { border-top: 0; }
th { font-weight: 400; color: var(--soft); width: 34%; max-width: 15em; padding-right: 12px; }
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

std::string percent(double fraction) { return fmt::format("{:g}&nbsp;%", 100 * fraction); }

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

template <typename Value>
std::vector<double> values_of(const DemoRun& run, Value value) {
  std::vector<double> values;
  values.reserve(run.frames.size());
  for (const DemoFrame& frame : run.frames) values.push_back(value(frame));
  return values;
}

std::string answer_label(const DemoRun& run) {
  const double error = run.options.query.relative_error;
  return error == 0 ? std::string("exact") : "within " + percent(error);
}

Chart distance_chart(const DemoRun& run) {
  Chart chart;
  chart.unit = "units of length";
  chart.areas.push_back({"certified interval at " + percent(rough_error),
                         values_of(run, [](const DemoFrame& f) { return f.rough.lower; }),
                         values_of(run, [](const DemoFrame& f) { return f.rough.upper; })});
  chart.curves.push_back(
      {answer_label(run), "first", values_of(run, [](const DemoFrame& f) { return f.answer.upper; })});
  if (run.options.query.relative_error > 0) {
    chart.curves.push_back(
        {"lower bound", "second", values_of(run, [](const DemoFrame& f) { return f.answer.lower; })});
  }
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    if (run.frames[f].answer.status == Status::collision) chart.marked_frames.push_back(f);
  }
  chart.mark_label = "contact";
  return chart;
}

Chart time_chart() {
  Chart chart;
  chart.unit = "&micro;s";
  chart.axis = Axis::logarithmic;
  return chart;
}

/// What a curve is about, and the numbers that sum it up.
std::string time_label(const std::string& name, const Spread& spread) {
  return name + "<span class='numbers'>: " + in_html(spread_text(spread)) + "</span>";
}

Chart update_chart(const DemoRun& run, const DemoSummary& summary) {
  Chart chart = time_chart();
  chart.curves.push_back({time_label("update", summary.update_us), "first",
                          values_of(run, [](const DemoFrame& f) { return f.update_us; })});
  return chart;
}

Chart query_chart(const DemoRun& run, const DemoSummary& summary) {
  Chart chart = time_chart();
  chart.curves.push_back({time_label(answer_label(run), summary.answer_us), "first",
                          values_of(run, [](const DemoFrame& f) { return f.answer_us; })});
  chart.curves.push_back({time_label("within " + percent(rough_error), summary.rough_us), "second",
                          values_of(run, [](const DemoFrame& f) { return f.rough_us; })});
  return chart;
}

std::string with_legend(const Chart& chart, const DemoRun& run) {
  return chart_legend(chart) + chart_svg(chart, run.frames.size());
}

/// The id is for whoever takes a part of the page; see tools/demo_picture.py.
std::string section(const std::string& id, const std::string& title, const std::string& caption,
                    const std::string& content) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n<p class=\"soft\">{}</p>\n{}</section>\n", id, title, caption,
                     content);
}

std::string tile(const std::string& number, const std::string& name) {
  return fmt::format("<div><b>{}</b><span class=\"soft\">{}</span></div>\n", in_html(number), name);
}

std::string introduction(const DemoRun& run) {
  return fmt::format(
      "<h1>A ball over a deforming sheet</h1>\n"
      "<p>A sheet of {} triangles, {} units a side, is dented {} in each of {} frames, while a ball of {} triangles "
      "and a diameter of 2 units flies over it on a closed curve. In every frame the tree of the sheet is refitted "
      "where the sheet has changed and nowhere else. Then a query asks for the shortest distance between the two "
      "surfaces, with the pair of points that attains it.</p>\n",
      grouped(run.sheet.triangles().size()), 100,
      run.options.dents_per_frame == 1 ? "once" : fmt::format("{} times", run.options.dents_per_frame),
      grouped(run.frames.size()), run.ball.triangles().size());
}

std::string tiles(const DemoRun& run, const DemoSummary& summary) {
  return "<div class=\"tiles\">\n" + tile(duration_text(summary.update_us.median), "median update of the tree") +
         tile(duration_text(summary.update_us_per_vertex), "mean update per moved vertex") +
         tile(duration_text(summary.answer_us.median), run.options.query.relative_error == 0
                                                           ? std::string("median exact distance query")
                                                           : "median query " + answer_label(run)) +
         tile(duration_text(summary.rough_us.median), "median query within " + percent(rough_error)) + "</div>\n";
}

std::string table(const DemoRun& run) {
  std::string html = "<table>\n";
  for (const auto& [name, text] : summary_rows(run)) {
    html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", name, in_html(text));
  }
  return html + "</table>\n";
}

}  // namespace

std::string demo_page(const DemoRun& run) {
  const DemoSummary summary = summary_of(run.frames);
  const DistanceResult& last = run.frames.back().answer;
  std::string html = head + introduction(run) + tiles(run, summary);
  html += section(
      "sheet", "The sheet after the last frame",
      "True to scale; blue is low, orange is high. The line is the path of the ball, red dots are frames in contact.",
      sheet_svg(run));
  html += section("ball", "The ball in the last frame",
                  last.status == Status::collision
                      ? std::string("True to scale. The ball and the sheet meet at the red point.")
                      : fmt::format("True to scale. The red segment joins the closest points, {:.4f} units apart; "
                                    "their triangles are outlined.",
                                    last.upper),
                  close_up_svg(run));
  html += section("distance", "Distance",
                  fmt::format("The cheaper query at {} proves that the distance lies in the shaded interval.",
                              percent(rough_error)),
                  with_legend(distance_chart(run), run));
  html += section("update", "Time of an update", "Moving the vertices of the frame's dents and refitting the tree.",
                  with_legend(update_chart(run, summary), run));
  html += section("query", "Time of a distance query",
                  "Every query starts without a cache: no answer is reused in the next frame.",
                  with_legend(query_chart(run, summary), run));
  html += section("summary", "Summary", "One thread; times are per frame, lengths in the sheet's unit.", table(run));
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace limber::program
