// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

/// Curves over frames as inline SVG. Colors come from classes that the page's style sheet defines.
namespace limber::program {

struct Curve {
  std::string label;
  std::string style;  ///< class of the line: "first" or "second"
  std::vector<double> values;
};

/// An area between two curves of equal length.
struct Area {
  std::string label;
  std::vector<double> low, high;
};

struct Chart {
  std::string unit;  ///< along the vertical axis
  std::vector<Area> areas;
  std::vector<Curve> curves;
  std::vector<std::size_t> marked_frames;  ///< ticks along the bottom
  std::string mark_label;
  double top = 1;  ///< upper end of the vertical axis; curves above it are clipped
};

/// Pre: all curves and areas have `frame_count` >= 1 values, all finite and >= 0.
std::string chart_svg(const Chart& chart, std::size_t frame_count);

/// At least `value`, with little room above it, and a number that axes like to end at. 1 for 0.
double axis_end(double value);

}  // namespace limber::program
