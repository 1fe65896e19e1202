// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/histogram_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/plot_frame.h"

namespace limber::program {
namespace {

constexpr double lowest_count = 0.5;  // so that a bin with one value can be seen

/// Between powers of ten that hold everything drawn.
class LogScale {
 public:
  explicit LogScale(const HistogramChart& chart) {
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

  double x_share(double value) const { return (std::log10(value) - first_) / (last_ - first_); }
  double y(double count) const { return plot_height * (1 - y_share(count)); }

  std::vector<Tick> value_ticks() const {
    std::vector<Tick> ticks;
    for (int exponent = first_; exponent <= last_; ++exponent) {
      const double value = std::pow(10, exponent);
      ticks.push_back({x_share(value), value});
    }
    return ticks;
  }

  std::vector<Tick> count_ticks() const {
    std::vector<Tick> ticks;
    for (int exponent = 0; exponent <= top_; ++exponent) {
      const double count = std::pow(10, exponent);
      ticks.push_back({y_share(count), count});
    }
    return ticks;
  }

 private:
  static constexpr double slack = 1e-9;  // an edge that is a power of ten up to rounding needs no further one

  double y_share(double count) const {
    return std::log10(std::max(count, lowest_count) / lowest_count) / (top_ - std::log10(lowest_count));
  }

  int first_, last_, top_;  // exponents at the ends of the axes
};

/// The outline of the bars.
std::string outline(const LogHistogram& histogram, const LogScale& scale) {
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
  const LogScale scale(chart);
  std::string curves;
  if (chart.marked_value) {
    curves += fmt::format("<path class='mark' d='M{:.1f} {}V0'/>\n", plot_width * scale.x_share(*chart.marked_value),
                          plot_height);
  }
  for (const HistogramCurve& curve : chart.curves) {
    curves += "<polyline class='line " + curve.style + "' points='" + outline(curve.histogram, scale) + "'/>\n";
  }
  return plot_svg(scale.value_ticks(), scale.count_ticks(), chart.unit, curves);
}

}  // namespace limber::program
