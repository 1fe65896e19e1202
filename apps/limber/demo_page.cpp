// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "demo_page.h"

#include <fmt/format.h>

#include <vector>

#include "chart_svg.h"
#include "demo_table.h"
#include "html_page.h"
#include "landscape_svg.h"
#include "text.h"

namespace limber::program {
namespace {

constexpr const char* style_of_pictures =
    R"(.trail, .witness, .outline, .ball, .dots { vector-effect: non-scaling-stroke; }
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
)";

std::string percent(double fraction) { return fmt::format("{:g}&nbsp;%", 100 * fraction); }

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
  return "<div class=\"tiles\">\n" + page_tile(duration_text(summary.update_us.median), "median update of the tree") +
         page_tile(duration_text(summary.update_us_per_vertex), "mean update per moved vertex") +
         page_tile(duration_text(summary.answer_us.median), run.options.query.relative_error == 0
                                                                ? std::string("median exact distance query")
                                                                : "median query " + answer_label(run)) +
         page_tile(duration_text(summary.rough_us.median), "median query within " + percent(rough_error)) + "</div>\n";
}

}  // namespace

std::string demo_page(const DemoRun& run) {
  const DemoSummary summary = summary_of(run.frames);
  const DistanceResult& last = run.frames.back().answer;
  std::string html = page_head("limber demo", style_of_pictures) + introduction(run) + tiles(run, summary);
  html += page_section(
      "sheet", "The sheet after the last frame",
      "True to scale; blue is low, orange is high. The line is the path of the ball, red dots are frames in contact.",
      sheet_svg(run));
  html += page_section("ball", "The ball in the last frame",
                       last.status == Status::collision
                           ? std::string("True to scale. The ball and the sheet meet at the red point.")
                           : fmt::format("True to scale. The red segment joins the closest points, {:.4f} units apart; "
                                         "their triangles are outlined.",
                                         last.upper),
                       close_up_svg(run));
  html += page_section("distance", "Distance",
                       fmt::format("The cheaper query at {} proves that the distance lies in the shaded interval.",
                                   percent(rough_error)),
                       with_legend(distance_chart(run), run));
  html +=
      page_section("update", "Time of an update", "Moving the vertices of the frame's dents and refitting the tree.",
                   with_legend(update_chart(run, summary), run));
  html += page_section("query", "Time of a distance query",
                       "Every query starts without a cache: no answer is reused in the next frame.",
                       with_legend(query_chart(run, summary), run));
  html += page_section("summary", "Summary", "One thread; times are per frame, lengths in the sheet's unit.",
                       page_rows(summary_rows(run)));
  return html + page_end();
}

}  // namespace limber::program
