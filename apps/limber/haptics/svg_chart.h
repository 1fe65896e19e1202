// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

/// Curves as inline SVG that fills the width of the page. Texts keep the size that the style sheet gives them, whatever
/// that width; only the curves are stretched. Colors come from classes that the style sheet defines.
namespace limber::program {

/// The range of an axis and its labels. Values below `low` are drawn at `low`.
struct ChartAxis {
  double low = 0, high = 1;
  bool is_logarithmic = false;
  std::vector<double> labels;

  /// Where a value lies, from 0 to 1.
  double share(double value) const;
};

/// From 0, with some labels a round step apart, which is at least `least_step`.
ChartAxis linear_axis(double high, double least_step);

/// Between powers of ten that hold everything. Pre: 0 < low <= high.
ChartAxis logarithmic_axis(double low, double high);

struct Curve {
  std::string label;
  std::string style;  ///< class of the line: "first" or "second"
  std::vector<std::pair<double, double>> points;
};

struct Chart {
  std::string unit;  ///< along the vertical axis
  std::string name;  ///< of the horizontal axis
  ChartAxis x, y;
  std::vector<Curve> curves;
  std::vector<double> marks;  ///< values of x, told by lines that start at the bottom
  double mark_height = 9;     ///< in pixels
  std::string mark_label = {};
};
inline constexpr double plot_height = 190;  ///< in pixels

/// The names of everything drawn, and the chart. Pre: all values are finite.
std::string svg_of(const Chart& chart);

}  // namespace limber::program
