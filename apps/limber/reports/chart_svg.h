// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

/// Curves over time as inline SVG that fills the width of the page. Texts keep the size that the style sheet gives
/// them, whatever that width; only the curves are stretched. Colors come from classes that the style sheet defines.
namespace limber::program {

struct Curve {
  std::string label;
  std::string style;  ///< class of the line: "first" or "second"
  std::vector<double> values;
};

/// The vertical axis is logarithmic, between powers of ten; values below 0.01 are drawn at 0.01. It ends above the
/// largest value, so that no peak is cut off.
struct Chart {
  std::string unit;  ///< along the vertical axis
  std::vector<Curve> curves;
  std::vector<std::size_t> marked_points;  ///< ticks along the bottom
  std::string mark_label;
  std::string point_name;  ///< what is counted along the horizontal axis,
  double point_unit = 1;   ///< and how much of it a point is
};

/// The line above a chart: the unit, and the names of everything drawn.
std::string chart_legend(const Chart& chart);

/// Pre: there is a curve; all curves have `point_count` >= 1 values, all finite and >= 0.
std::string chart_svg(const Chart& chart, std::size_t point_count);

}  // namespace limber::program
