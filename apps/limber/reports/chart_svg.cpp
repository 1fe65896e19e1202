// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/chart_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/plot_frame.h"

namespace limber::program {
namespace {

constexpr double least_logarithmic = 0.01;
constexpr double most_point_labels = 7;  // as many as fit side by side on a narrow screen

/// The smallest of 1, 2, 5 times a power of ten that is at least `value`.
double step_above(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  const double factor = value / power;
  return (factor <= 1 ? 1 : factor <= 2 ? 2 : factor <= 5 ? 5 : 10) * power;
}

struct Range {
  double low = 0, high = 0;
};

/// The smallest and the largest value of everything drawn.
Range range_of(const Chart& chart) {
  Range range{chart.curves.front().values.front(), 0};
  for (const Curve& curve : chart.curves) {
    const auto [low, high] = std::minmax_element(curve.values.begin(), curve.values.end());
    range = {std::min(range.low, *low), std::max(range.high, *high)};
  }
  return range;
}

/// A vertical axis: which values it labels, the first at its lower and the last at its upper end, and how high values
/// are above its lower end, from 0 to 1.
struct VerticalAxis {
  std::vector<double> labels;

  double height_of(double value) const {
    const double low = labels.front(), high = labels.back();
    return std::log(std::max(value, low) / low) / std::log(high / low);
  }
};

VerticalAxis vertical_axis(const Range& range) {
  const int first = static_cast<int>(std::floor(std::log10(std::max(range.low, least_logarithmic))));
  const int end = static_cast<int>(std::ceil(std::log10(std::max(range.high, least_logarithmic))));
  const int last = std::max(first + 1, end);
  VerticalAxis axis;
  for (int exponent = first; exponent <= last; ++exponent) {
    const double power = std::pow(10, exponent);
    axis.labels.push_back(power);
    if (last - first > 2 || exponent == last) continue;
    axis.labels.push_back(2 * power);
    axis.labels.push_back(5 * power);
  }
  return axis;
}

/// Where points and values lie in the picture.
class PointScale {
 public:
  PointScale(const Chart& chart, std::size_t point_count)
      : last_point_(chart.point_unit * static_cast<double>(std::max<std::size_t>(point_count, 2) - 1)),
        point_unit_(chart.point_unit),
        axis_(vertical_axis(range_of(chart))) {}

  double x_share(double value) const { return value / last_point_; }
  double point_share(std::size_t index) const { return x_share(point_unit_ * static_cast<double>(index)); }
  double y(double value) const { return plot_height * (1 - axis_.height_of(value)); }

  std::vector<Tick> point_ticks() const {
    std::vector<Tick> ticks;
    const double step = std::max(point_unit_, step_above(last_point_ / (most_point_labels - 1)));
    for (int i = 0; i * step <= last_point_; ++i) ticks.push_back({x_share(i * step), i * step});
    return ticks;
  }

  std::vector<Tick> value_ticks() const {
    std::vector<Tick> ticks;
    for (const double value : axis_.labels) ticks.push_back({axis_.height_of(value), value});
    return ticks;
  }

 private:
  double last_point_, point_unit_;
  VerticalAxis axis_;
};

std::string point(std::size_t index, double value, const PointScale& scale) {
  return fmt::format("{:.1f},{:.1f} ", plot_width * scale.point_share(index), scale.y(value));
}

std::string points(const std::vector<double>& values, const PointScale& scale) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) text += point(i, values[i], scale);
  return text;
}

std::string marks(const Chart& chart, const PointScale& scale) {
  std::string path;
  for (const std::size_t index : chart.marked_points) {
    path += fmt::format("M{:.1f} {}v-9", plot_width * scale.point_share(index), plot_height);
  }
  return path.empty() ? path : "<path class='mark' d='" + path + "'/>\n";
}

}  // namespace

std::string chart_legend(const Chart& chart) {
  std::string html = "<p class='legend'><span class='unit'>" + chart.unit + ", logarithmic</span>\n";
  for (const Curve& curve : chart.curves) {
    html += legend_entry("<path class='line " + curve.style + "' d='M0 5h22'/>", curve.label);
  }
  if (!chart.marked_points.empty()) html += legend_entry("<path class='mark' d='M11 10v-10'/>", chart.mark_label);
  return html + "</p>\n";
}

std::string chart_svg(const Chart& chart, std::size_t point_count) {
  const PointScale scale(chart, point_count);
  std::string curves = marks(chart, scale);
  for (const Curve& curve : chart.curves) {
    curves += "<polyline class='line " + curve.style + "' points='" + points(curve.values, scale) + "'/>\n";
  }
  return plot_svg(scale.point_ticks(), scale.value_ticks(), chart.point_name, curves);
}

}  // namespace limber::program
