// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/svg_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace limber::program {
namespace {

constexpr double plot_width = 1000;  // before it is stretched
constexpr double most_labels = 7;    // as many as fit side by side on a narrow screen

/// The smallest of 1, 2, 5 times a power of ten that is at least `value`.
double step_above(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  const double factor = value / power;
  return (factor <= 1 ? 1 : factor <= 2 ? 2 : factor <= 5 ? 5 : 10) * power;
}

/// A name in a legend, and its symbol of 22 by 10 pixels.
std::string legend_entry(const std::string& symbol, const std::string& label) {
  return "<span><svg class='symbol' width='22' height='10'>" + symbol + "</svg>" + label + "</span>\n";
}

std::string legend_of(const Chart& chart) {
  std::string html = "<p class='legend'><span class='unit'>" + chart.unit + ", logarithmic</span>\n";
  for (const Curve& curve : chart.curves) {
    html += legend_entry("<path class='line " + curve.style + "' d='M0 5h22'/>", curve.label);
  }
  if (!chart.marks.empty()) html += legend_entry("<path class='mark' d='M11 10v-10'/>", chart.mark_label);
  return html + "</p>\n";
}

std::string axes_of(const Chart& chart) {
  std::string svg;
  for (const double value : chart.y.labels) {
    const double y = plot_height * (1 - chart.y.share(value));
    svg += fmt::format("<line class='grid' x2='100%' y1='{0:.1f}' y2='{0:.1f}'/>", y);
    svg += fmt::format("<text class='value' x='-8' y='{:.1f}'>{:.12g}</text>\n", y + 4, value);
  }
  for (const double value : chart.x.labels) {
    const double percent = 100 * chart.x.share(value);
    svg += fmt::format("<line class='axis' x1='{0:.2f}%' x2='{0:.2f}%' y1='{1}' y2='{2}'/>", percent, plot_height,
                       plot_height + 5);
    svg += fmt::format("<text class='frame' x='{:.2f}%' y='{}'>{:.12g}</text>\n", percent, plot_height + 20, value);
  }
  svg += fmt::format("<line class='axis' x2='100%' y1='{0}' y2='{0}'/>\n", plot_height);
  return svg + fmt::format("<text class='name' x='100%' y='{}'>{}</text>\n", plot_height + 38, chart.name);
}

std::string curves_of(const Chart& chart) {
  std::string svg, marks;
  for (const double x : chart.marks) {
    marks += fmt::format("M{:.1f} {}v-{}", plot_width * chart.x.share(x), plot_height, chart.mark_height);
  }
  if (!marks.empty()) svg += "<path class='mark' d='" + marks + "'/>\n";
  for (const auto& [label, style, points] : chart.curves) {
    svg += "<polyline class='line " + style + "' points='";
    for (const auto& [x, y] : points) {
      svg += fmt::format("{:.1f},{:.1f} ", plot_width * chart.x.share(x), plot_height * (1 - chart.y.share(y)));
    }
    svg += "'/>\n";
  }
  return svg;
}

}  // namespace

double ChartAxis::share(double value) const {
  if (!is_logarithmic) return (value - low) / (high - low);
  return std::log(std::max(value, low) / low) / std::log(high / low);
}

ChartAxis linear_axis(double high, double least_step) {
  ChartAxis axis{0, high, false, {}};
  const double step = std::max(least_step, step_above(high / (most_labels - 1)));
  for (int i = 0; i * step <= high; ++i) axis.labels.push_back(i * step);
  return axis;
}

ChartAxis logarithmic_axis(double low, double high) {
  constexpr double slack = 1e-9;  // a power of ten up to rounding needs no further one
  const int first = static_cast<int>(std::floor(std::log10(low) + slack));
  const int last = std::max(first + 1, static_cast<int>(std::ceil(std::log10(high) - slack)));
  ChartAxis axis{std::pow(10, first), std::pow(10, last), true, {}};
  for (int exponent = first; exponent <= last; ++exponent) {
    const double power = std::pow(10, exponent);
    axis.labels.push_back(power);
    if (last - first <= 2 && exponent < last) axis.labels.insert(axis.labels.end(), {2 * power, 5 * power});
  }
  return axis;
}

std::string svg_of(const Chart& chart) {
  // The nested picture alone is stretched; lines keep their width by the style sheet.
  return legend_of(chart) + "<svg xmlns='http://www.w3.org/2000/svg' class='chart' role='img'>\n" + axes_of(chart) +
         fmt::format("<svg viewBox='0 0 {0} {1}' preserveAspectRatio='none' width='100%' height='{1}'>\n", plot_width,
                     plot_height) +
         curves_of(chart) + "</svg>\n</svg>\n";
}

}  // namespace limber::program
