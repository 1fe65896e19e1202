// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "chart_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace limber::program {
namespace {

// All in the units of the picture's view box.
constexpr double width = 960, height = 250;
constexpr double left = 64, right = 16, above = 36, below = 44;
constexpr double plot_width = width - left - right;
constexpr double plot_height = height - above - below;

/// The largest of 1, 2, 5 times a power of ten that divides the range into at least `parts` parts.
double step_for(double range, double parts) {
  const double rough = range / parts;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  const double factor = rough / power;
  return (factor >= 5 ? 5 : factor >= 2 ? 2 : 1) * power;
}

/// Where frames and values lie in the picture.
class Scale {
 public:
  Scale(std::size_t frame_count, double top)
      : last_frame_(static_cast<double>(std::max<std::size_t>(frame_count, 2) - 1)), top_(top) {}

  double x(double frame) const { return left + plot_width * frame / last_frame_; }
  double y(double value) const {  // values far above the plot are clipped anyway
    return above + plot_height * (1 - std::min(value / top_, 4.0));
  }
  double last_frame() const { return last_frame_; }
  double top() const { return top_; }

 private:
  double last_frame_, top_;
};

std::string axes(const Chart& chart, const Scale& scale) {
  std::string svg;
  const double value_step = step_for(scale.top(), 4);
  for (int i = 0; i * value_step <= scale.top() * 1.0001; ++i) {
    const double y = scale.y(i * value_step);
    svg += fmt::format("<path class='grid' d='M{} {:.1f}H{}'/><text x='{}' y='{:.1f}' text-anchor='end'>{:g}</text>\n",
                       left, y, width - right, left - 8, y + 4, i * value_step);
  }
  const double frame_step = std::max(1.0, step_for(scale.last_frame(), 6));
  for (int i = 0; i * frame_step <= scale.last_frame(); ++i) {
    const double x = scale.x(i * frame_step);
    svg +=
        fmt::format("<path class='axis' d='M{:.1f} {}v5'/><text x='{:.1f}' y='{}' text-anchor='middle'>{:g}</text>\n",
                    x, height - below, x, height - below + 18, i * frame_step);
  }
  svg += fmt::format("<path class='axis' d='M{} {}H{}'/>\n", left, height - below, width - right);
  svg += fmt::format("<text class='name' x='{}' y='{}' text-anchor='end'>frame</text>\n", width - right, height - 6);
  svg += fmt::format("<text class='name' x='{}' y='18'>{}</text>\n", 4, chart.unit);
  return svg;
}

std::string points(const std::vector<double>& values, const Scale& scale) {
  std::string text;
  for (std::size_t f = 0; f < values.size(); ++f) {
    text += fmt::format("{:.1f},{:.1f} ", scale.x(static_cast<double>(f)), scale.y(values[f]));
  }
  return text;
}

std::string area(const Area& band, const Scale& scale) {
  std::string text = points(band.high, scale);
  for (std::size_t f = band.low.size(); f-- > 0;) {
    text += fmt::format("{:.1f},{:.1f} ", scale.x(static_cast<double>(f)), scale.y(band.low[f]));
  }
  return "<polygon class='area' points='" + text + "'/>\n";
}

std::string marks(const Chart& chart, const Scale& scale) {
  std::string path;
  for (const std::size_t frame : chart.marked_frames) {
    path += fmt::format("M{:.1f} {}v-9", scale.x(static_cast<double>(frame)), height - below);
  }
  return path.empty() ? path : "<path class='mark' d='" + path + "'/>\n";
}

/// Characters of a label as a reader sees it; an entity is one.
std::size_t shown_length(const std::string& label) {
  std::size_t count = 0;
  bool in_entity = false;
  for (const char c : label) {
    if (!in_entity) ++count;
    if (c == '&') in_entity = true;
    if (c == ';') in_entity = false;
  }
  return count;
}

/// Names of everything drawn, from the right end of the head line leftwards.
std::string legend(const Chart& chart) {
  struct Entry {
    std::string label, symbol;  // the symbol is drawn in a box of 22 by 10, whose left side is centered at the origin
  };
  std::vector<Entry> entries;
  for (const Curve& curve : chart.curves) {
    entries.push_back({curve.label, "<path class='line " + curve.style + "' d='M0 0h22'/>"});
  }
  for (const Area& band : chart.areas) {
    entries.push_back({band.label, "<rect class='area' y='-5' width='22' height='10'/>"});
  }
  if (!chart.marked_frames.empty()) entries.push_back({chart.mark_label, "<path class='mark' d='M11 5v-10'/>"});
  constexpr double character = 6.6, symbol_width = 28, gap = 22;
  double end = width - right;
  std::string svg;
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
    end -= character * static_cast<double>(shown_length(entry->label)) + symbol_width;
    svg += fmt::format("<g transform='translate({:.0f} 14)'>{}<text x='{}' y='4'>{}</text></g>\n", end, entry->symbol,
                       symbol_width, entry->label);
    end -= gap;
  }
  return svg;
}

}  // namespace

std::string chart_svg(const Chart& chart, std::size_t frame_count) {
  const Scale scale(frame_count, chart.top);
  std::string svg =
      fmt::format("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {} {}' role='img'>\n", width, height);
  svg += axes(chart, scale) + legend(chart);
  // A nested picture is clipped at its border; this one keeps the outer coordinates.
  svg += fmt::format("<svg x='{0}' y='{1}' width='{2}' height='{3}' viewBox='{0} {1} {2} {3}'>\n", left, above - 2,
                     plot_width, plot_height + 3);
  for (const Area& band : chart.areas) svg += area(band, scale);
  svg += marks(chart, scale);
  for (const Curve& curve : chart.curves) {
    svg += "<polyline class='line " + curve.style + "' points='" + points(curve.values, scale) + "'/>\n";
  }
  return svg + "</svg>\n</svg>\n";
}

double axis_end(double value) {
  if (!(value > 0)) return 1;
  const double step = step_for(value, 4);
  return step * std::ceil(value / step);
}

}  // namespace limber::program
