// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "histogram_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "chart_svg.h"

namespace limber::program {
namespace {

constexpr double plot_height = 190;   // pixels of the page
constexpr double plot_width = 1000;   // stretched to the width of the chart
constexpr double lowest_count = 0.5;  // so that a bin with one value can be seen

/// Between powers of ten that hold everything drawn.
class Scale {
 public:
  explicit Scale(const HistogramChart& chart) {
    double low = chart.marked_value.value_or(chart.curves.front().histogram.edge(0)), high = low;
    std::uint64_t largest = 1;
    for (const HistogramCurve& curve : chart.curves) {
      const std::vector<std::uint64_t>& counts = curve.histogram.counts();
      low = std::min(low, curve.histogram.edge(0));
      high = std::max(high, curve.histogram.edge(counts.size()));
      largest = std::max(largest, *std::max_element(counts.begin(), counts.end()));
    }
    first_ = static_cast<int>(std::floor(std::log10(low) + slack));
    last_ = std::max(first_ + 1, static_cast<int>(std::ceil(std::log10(high) - slack)));
    top_ = std::max(1, static_cast<int>(std::ceil(std::log10(static_cast<double>(largest)))));
  }

  int first() const { return first_; }  // exponents at the ends of the axes
  int last() const { return last_; }
  int top() const { return top_; }
  double x_share(double value) const { return (std::log10(value) - first_) / (last_ - first_); }
  double y(double count) const {
    const double height = std::log10(std::max(count, lowest_count) / lowest_count);
    return plot_height * (1 - height / (top_ - std::log10(lowest_count)));
  }

 private:
  static constexpr double slack = 1e-9;  // an edge that is a power of ten up to rounding needs no further one

  int first_, last_, top_;
};

std::string axes(const Scale& scale, const std::string& unit) {
  std::string svg;
  for (int exponent = 0; exponent <= scale.top(); ++exponent) {
    const double count = std::pow(10, exponent), y = scale.y(count);
    svg += fmt::format("<line class='grid' x2='100%' y1='{0:.1f}' y2='{0:.1f}'/>", y);
    svg += fmt::format("<text class='value' x='-8' y='{:.1f}'>{:g}</text>\n", y + 4, count);
  }
  for (int exponent = scale.first(); exponent <= scale.last(); ++exponent) {
    const double value = std::pow(10, exponent), percent = 100 * scale.x_share(value);
    svg += fmt::format("<line class='axis' x1='{0:.2f}%' x2='{0:.2f}%' y1='{1}' y2='{2}'/>", percent, plot_height,
                       plot_height + 5);
    svg += fmt::format("<text class='frame' x='{:.2f}%' y='{}'>{:g}</text>\n", percent, plot_height + 20, value);
  }
  svg += fmt::format("<line class='axis' x2='100%' y1='{0}' y2='{0}'/>\n", plot_height);
  return svg + fmt::format("<text class='name' x='100%' y='{}'>{}</text>\n", plot_height + 38, unit);
}

/// The outline of the bars.
std::string outline(const LogHistogram& histogram, const Scale& scale) {
  const auto x = [&](std::size_t i) { return plot_width * scale.x_share(histogram.edge(i)); };
  std::string points = fmt::format("{:.1f},{:.1f} ", x(0), plot_height);
  const std::size_t count = histogram.counts().size();
  for (std::size_t i = 0; i < count; ++i) {
    const double y = scale.y(static_cast<double>(histogram.counts()[i]));
    points += fmt::format("{:.1f},{:.1f} {:.1f},{:.1f} ", x(i), y, x(i + 1), y);
  }
  return points + fmt::format("{:.1f},{:.1f} ", x(count), plot_height);
}

}  // namespace

std::string histogram_legend(const HistogramChart& chart) {
  std::string html = "<p class='legend'><span class='unit'>ticks, logarithmic</span>\n";
  for (const HistogramCurve& curve : chart.curves) {
    html += legend_entry("<path class='line " + curve.style + "' d='M0 5h22'/>", curve.label);
  }
  if (chart.marked_value) html += legend_entry("<path class='mark' d='M11 10v-10'/>", chart.mark_label);
  return html + "</p>\n";
}

std::string histogram_svg(const HistogramChart& chart) {
  const Scale scale(chart);
  std::string svg = "<svg xmlns='http://www.w3.org/2000/svg' class='chart' role='img'>\n" + axes(scale, chart.unit);
  svg += fmt::format("<svg viewBox='0 0 {0} {1}' preserveAspectRatio='none' width='100%' height='{1}'>\n", plot_width,
                     plot_height);
  if (chart.marked_value) {
    svg += fmt::format("<path class='mark' d='M{:.1f} {}V0'/>\n", plot_width * scale.x_share(*chart.marked_value),
                       plot_height);
  }
  for (const HistogramCurve& curve : chart.curves) {
    svg += "<polyline class='line " + curve.style + "' points='" + outline(curve.histogram, scale) + "'/>\n";
  }
  return svg + "</svg>\n</svg>\n";
}

}  // namespace limber::program
