// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "chart_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plot_frame.h"

namespace limber::program {
namespace {

constexpr double least_logarithmic = 0.01;
constexpr double most_frame_labels = 7;  // as many as fit side by side on a narrow screen

/// The largest of 1, 2, 5 times a power of ten that is at most `value`.
double step_below(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  const double factor = value / power;
  return (factor >= 5 ? 5 : factor >= 2 ? 2 : 1) * power;
}

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
  const auto widen = [&range](const std::vector<double>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    range = {std::min(range.low, *low), std::max(range.high, *high)};
  };
  for (const Curve& curve : chart.curves) widen(curve.values);
  for (const Area& band : chart.areas) {
    widen(band.low);
    widen(band.high);
  }
  return range;
}

/// A vertical axis: which values it labels, the first at its lower and the last at its upper end, and how high values
/// are above its lower end, from 0 to 1.
struct VerticalAxis {
  std::vector<double> labels;
  bool is_logarithmic = false;

  double height_of(double value) const {
    const double low = labels.front(), high = labels.back();
    if (!is_logarithmic) return (value - low) / (high - low);
    return std::log(std::max(value, low) / low) / std::log(high / low);
  }
};

VerticalAxis linear_axis(double largest) {
  VerticalAxis axis{{0}, false};
  const double step = largest > 0 ? step_below(largest / 4) : 1;
  while (axis.labels.back() < largest || axis.labels.size() < 2) {
    axis.labels.push_back(step * static_cast<double>(axis.labels.size()));
  }
  return axis;
}

VerticalAxis logarithmic_axis(const Range& range) {
  const int first = static_cast<int>(std::floor(std::log10(std::max(range.low, least_logarithmic))));
  const int end = static_cast<int>(std::ceil(std::log10(std::max(range.high, least_logarithmic))));
  const int last = std::max(first + 1, end);
  VerticalAxis axis{{}, true};
  for (int exponent = first; exponent <= last; ++exponent) {
    const double power = std::pow(10, exponent);
    axis.labels.push_back(power);
    if (last - first > 2 || exponent == last) continue;
    axis.labels.push_back(2 * power);
    axis.labels.push_back(5 * power);
  }
  return axis;
}

/// Where frames and values lie in the picture.
class FrameScale {
 public:
  FrameScale(const Chart& chart, std::size_t frame_count)
      : last_frame_(chart.frame_unit * static_cast<double>(std::max<std::size_t>(frame_count, 2) - 1)),
        frame_unit_(chart.frame_unit),
        axis_(chart.axis == Axis::linear ? linear_axis(range_of(chart).high) : logarithmic_axis(range_of(chart))) {}

  double x_share(double value) const { return value / last_frame_; }
  double frame_share(std::size_t frame) const { return x_share(frame_unit_ * static_cast<double>(frame)); }
  double y(double value) const { return plot_height * (1 - axis_.height_of(value)); }

  std::vector<Tick> frame_ticks() const {
    std::vector<Tick> ticks;
    const double step = std::max(frame_unit_, step_above(last_frame_ / (most_frame_labels - 1)));
    for (int i = 0; i * step <= last_frame_; ++i) ticks.push_back({x_share(i * step), i * step});
    return ticks;
  }

  std::vector<Tick> value_ticks() const {
    std::vector<Tick> ticks;
    for (const double value : axis_.labels) ticks.push_back({axis_.height_of(value), value});
    return ticks;
  }

 private:
  double last_frame_, frame_unit_;
  VerticalAxis axis_;
};

std::string point(std::size_t frame, double value, const FrameScale& scale) {
  return fmt::format("{:.1f},{:.1f} ", plot_width * scale.frame_share(frame), scale.y(value));
}

std::string points(const std::vector<double>& values, const FrameScale& scale) {
  std::string text;
  for (std::size_t f = 0; f < values.size(); ++f) text += point(f, values[f], scale);
  return text;
}

std::string area(const Area& band, const FrameScale& scale) {
  std::string text = points(band.high, scale);
  for (std::size_t f = band.low.size(); f-- > 0;) text += point(f, band.low[f], scale);
  return "<polygon class='area' points='" + text + "'/>\n";
}

std::string marks(const Chart& chart, const FrameScale& scale) {
  std::string path;
  for (const std::size_t frame : chart.marked_frames) {
    path += fmt::format("M{:.1f} {}v-9", plot_width * scale.frame_share(frame), plot_height);
  }
  return path.empty() ? path : "<path class='mark' d='" + path + "'/>\n";
}

}  // namespace

std::string chart_legend(const Chart& chart) {
  std::string html = "<p class='legend'><span class='unit'>" + chart.unit +
                     (chart.axis == Axis::logarithmic ? ", logarithmic" : "") + "</span>\n";
  for (const Curve& curve : chart.curves) {
    html += legend_entry("<path class='line " + curve.style + "' d='M0 5h22'/>", curve.label);
  }
  for (const Area& band : chart.areas) {
    html += legend_entry("<rect class='area' width='22' height='10'/>", band.label);
  }
  if (!chart.marked_frames.empty()) html += legend_entry("<path class='mark' d='M11 10v-10'/>", chart.mark_label);
  return html + "</p>\n";
}

std::string chart_svg(const Chart& chart, std::size_t frame_count) {
  const FrameScale scale(chart, frame_count);
  std::string curves;
  for (const Area& band : chart.areas) curves += area(band, scale);
  curves += marks(chart, scale);
  for (const Curve& curve : chart.curves) {
    curves += "<polyline class='line " + curve.style + "' points='" + points(curve.values, scale) + "'/>\n";
  }
  return plot_svg(scale.frame_ticks(), scale.value_ticks(), chart.frame_name, curves);
}

}  // namespace limber::program
