// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

/// Curves over frames as inline SVG that fills the width of the page. Texts keep the size that the style sheet gives
/// them, whatever that width; only the curves are stretched. Colors come from classes that the style sheet defines.
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

enum class Axis {
  linear,       ///< from 0
  logarithmic,  ///< between powers of ten; values below 0.01 are drawn at 0.01
};

/// The vertical axis ends above the largest value, so that no peak is cut off.
struct Chart {
  std::string unit;  ///< along the vertical axis
  Axis axis = Axis::linear;
  std::vector<Area> areas;
  std::vector<Curve> curves;
  std::vector<std::size_t> marked_frames;  ///< ticks along the bottom
  std::string mark_label;
  std::string frame_name = "frame";  ///< what is counted along the horizontal axis,
  double frame_unit = 1;             ///< and how much of it a frame is
};

/// The line above a chart: the unit, and the names of everything drawn.
std::string chart_legend(const Chart& chart);

/// Pre: there is a curve; all curves and areas have `frame_count` >= 1 values, all finite and >= 0.
std::string chart_svg(const Chart& chart, std::size_t frame_count);

}  // namespace limber::program
